// Deforming skins: position and unit normal of every vertex, by the kernel of
// the volumes at each level of the instruction set, as floats and quantised;
// beside them what must be beaten and what cannot be: linear blending with four
// influences written plainly with Eigen, and a copy of the same bytes. 10,000
// vertices fit the caches, 100,000 do not.
//
// items_per_second are vertices. Compare within one run only.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "gelenk/skin/control_net.h"
#include "gelenk/skin/layered_skin.h"
#include "gelenk/skin/mesh_around.h"
#include "gelenk/skin/vertex_stream.h"

namespace gelenk::benchmarks {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kLinks = 20;

// A chain of 20 links with a tube about it.
struct Worm {
  std::shared_ptr<const Skeleton> skeleton;
  std::shared_ptr<const LayeredSkin> skin;
  std::vector<Eigen::VectorXd> poses;

  explicit Worm(int vertex_count) {
    SkeletonBuilder builder;
    for (int i = 0; i < kLinks; ++i) {
      Joint joint;
      joint.id = absl::StrCat("j", i);
      joint.parent_id = i == 0 ? "" : absl::StrCat("j", i - 1);
      joint.type = i == 0 ? JointType::kFree : JointType::kSpherical;
      joint.parent_from_joint.translation.x() = i == 0 ? 0 : 0.1;
      joint.link_length_m = 0.1;
      builder.AddJoint(joint);
    }
    skeleton = builder.Build().value();
    SkinMuscles muscles;
    for (int i = 0; i < kLinks; ++i) {
      Muscle muscle;
      muscle.id = muscle.link_id = absl::StrCat("j", i);
      muscle.driver_joint_id = muscle.id;
      muscle.gain_s = muscle.gain_t = 0.2;
      muscles.muscles.push_back(muscle);
    }
    const auto rig = VolumeRig::Create(skeleton, {}, muscles).value();
    TubeShape tube;
    tube.length_m = 2;
    tube.radius_m = 0.03;
    tube.around = 50;
    tube.rings = vertex_count / tube.around - 1;
    skin = LayeredSkin::Bind(*rig, TubeMesh(tube).value()).value();
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> angle(-0.3, 0.3);
    for (int i = 0; i < 16; ++i) {
      Eigen::VectorXd velocity(skeleton->velocity_count());
      for (double& number : velocity) number = angle(random);
      Eigen::VectorXd& pose = poses.emplace_back(NeutralPositions(*skeleton));
      Integrate(*skeleton, NeutralPositions(*skeleton), velocity, pose);
    }
  }
};

void Count(benchmark::State& state, int vertices) {
  state.SetItemsProcessed(state.iterations() * vertices);
}

// Volumes that are there already: the kernel by itself.
void Kernel(benchmark::State& state, const Worm& worm, InstructionSet level,
            bool quantised) {
  SkinWorkspace workspace;
  VertexBlocks blocks;
  worm.skin->Deform(worm.poses[0], {}, workspace, blocks);
  QuantizedBlocks quantized;
  quantized.Resize(blocks.block_count());
  quantized.box = worm.skin->BoxAt(worm.poses[0], {});
  const kernel::DeformFunctions& functions = DeformFunctionsFor(level);
  const kernel::DeformLayout layout = worm.skin->LayoutIn(workspace);
  for (auto _ : state) {
    if (quantised) {
      functions.deform_quantized(layout, GridOf(quantized.box),
                                 quantized.data());
    } else {
      functions.deform(layout, blocks.data());
    }
    benchmark::ClobberMemory();
  }
  Count(state, worm.skin->vertex_count());
}

// A pose in, vertices out.
void Frame(benchmark::State& state, const Worm& worm) {
  SkinWorkspace workspace;
  VertexBlocks blocks;
  size_t at = 0;
  for (auto _ : state) {
    at = (at + 1) % worm.poses.size();
    worm.skin->Deform(worm.poses[at], {}, workspace, blocks);
    benchmark::ClobberMemory();
  }
  Count(state, worm.skin->vertex_count());
}

// A second of swinging at 60 Hz, quantised.
std::vector<QuantizedBlocks> SwingingFrames(const Worm& worm) {
  constexpr int kFrames = 60;
  const Eigen::VectorXd neutral = NeutralPositions(*worm.skeleton);
  Eigen::VectorXd velocity(worm.skeleton->velocity_count());
  Eigen::VectorXd pose = neutral;
  SkinWorkspace workspace;
  std::vector<QuantizedBlocks> frames(kFrames);
  for (int frame = 0; frame < kFrames; ++frame) {
    for (int i = 0; i < velocity.size(); ++i) {
      velocity[i] = 0.05 * std::sin(2 * M_PI * frame / kFrames + i);
    }
    Integrate(*worm.skeleton, neutral, velocity, pose);
    worm.skin->DeformQuantized(pose, {}, workspace, frames[frame]);
  }
  return frames;
}

// Of frames that are deformed and quantised already.
void EncodeDifferences(benchmark::State& state, const Worm& worm) {
  const std::vector<QuantizedBlocks> frames = SwingingFrames(worm);
  DeltaEncoder encoder(static_cast<int>(frames.size()));
  std::string bytes;
  size_t at = 0;
  double size = 0;
  for (auto _ : state) {
    encoder.Encode(frames[at++ % frames.size()], bytes);
    size += static_cast<double>(bytes.size());
  }
  Count(state, worm.skin->vertex_count());
  state.counters["bytes_per_vertex"] = size /
                                       static_cast<double>(state.iterations()) /
                                       worm.skin->vertex_count();
}

void DecodeDifferences(benchmark::State& state, const Worm& worm) {
  const std::vector<QuantizedBlocks> frames = SwingingFrames(worm);
  DeltaEncoder encoder(static_cast<int>(frames.size()));
  std::vector<std::string> encoded(frames.size());
  for (size_t i = 0; i < frames.size(); ++i) {
    encoder.Encode(frames[i], encoded[i]);
  }
  DeltaDecoder decoder;
  QuantizedBlocks blocks;
  size_t at = 0;
  for (auto _ : state) {
    if (!decoder.Decode(encoded[at++ % encoded.size()], blocks).ok()) {
      state.SkipWithError("no frame");
    }
  }
  Count(state, worm.skin->vertex_count());
}

// Forward kinematics, planes and volumes of all links.
void Volumes(benchmark::State& state, const Worm& worm) {
  VolumeFrame frame;
  size_t at = 0;
  for (auto _ : state) {
    at = (at + 1) % worm.poses.size();
    worm.skin->rig().Evaluate(worm.poses[at], {}, frame);
    benchmark::ClobberMemory();
  }
}

void Folds(benchmark::State& state, const Worm& worm) {
  VolumeFrame frame;
  worm.skin->rig().Evaluate(worm.poses[0], {}, frame);
  for (auto _ : state) {
    benchmark::DoNotOptimize(worm.skin->rig().FindFolds(frame));
  }
}

void Copy(benchmark::State& state, int vertex_count) {
  const size_t size = static_cast<size_t>(vertex_count) * 6 * sizeof(float);
  std::vector<char> from(size, 1), to(size);
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), size);
    benchmark::ClobberMemory();
  }
  Count(state, vertex_count);
}

// As one writes it first.
void NaiveLinearBlend(benchmark::State& state, int vertex_count) {
  struct Vertex {
    Vector3f position, normal;
    int bones[4];
    float weights[4];
  };
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Vertex> vertices(vertex_count);
  for (int v = 0; v < vertex_count; ++v) {
    Vertex& vertex = vertices[v];
    vertex.position.setRandom();
    vertex.normal.setRandom();
    float sum = 0;
    for (int k = 0; k < 4; ++k) {
      vertex.bones[k] = (v * kLinks / vertex_count + k) % kLinks;
      sum += vertex.weights[k] = unit(random);
    }
    for (float& weight : vertex.weights) weight /= sum;
  }
  std::vector<Eigen::Matrix4f> bones(kLinks, Eigen::Matrix4f::Identity());
  std::vector<Vector3f> positions(vertex_count), normals(vertex_count);
  for (auto _ : state) {
    for (int v = 0; v < vertex_count; ++v) {
      const Vertex& vertex = vertices[v];
      Eigen::Matrix4f blended = Eigen::Matrix4f::Zero();
      for (int k = 0; k < 4; ++k) {
        blended += vertex.weights[k] * bones[vertex.bones[k]];
      }
      positions[v] =
          (blended * vertex.position.homogeneous()).template head<3>();
      normals[v] = (blended.topLeftCorner<3, 3>() * vertex.normal).normalized();
    }
    benchmark::ClobberMemory();
  }
  Count(state, vertex_count);
}

// The definition, for scale: positions only, in double precision.
void ControlPoints(benchmark::State& state, const Worm& worm) {
  VolumeFrame frame;
  worm.skin->rig().Evaluate(worm.poses[0], {}, frame);
  const Eigen::Vector2d half_extents(0.05, 0.05);
  std::vector<ControlNet> nets;
  for (const ControlPlane& plane : frame.all_planes()) {
    nets.push_back(UniformNet(plane, half_extents));
  }
  const SkinBinding& binding = worm.skin->binding();
  std::vector<Vector3d> positions(binding.vertices.size());
  for (auto _ : state) {
    for (size_t v = 0; v < positions.size(); ++v) {
      const VertexBinding& vertex = binding.vertices[v];
      const VolumePart part = worm.skin->rig().volume_part(vertex.volume);
      const int first = kPlanesPerLink * vertex.link +
                        (part == VolumePart::kSecondHalf ? 3 : 0);
      positions[v] = SumOfControlPoints(
          absl::MakeConstSpan(nets).subspan(first, 4), half_extents, vertex.at);
    }
    benchmark::ClobberMemory();
  }
  Count(state, worm.skin->vertex_count());
}

int Register() {
  const auto add = [](const std::string& name, auto function) {
    benchmark::RegisterBenchmark(name.c_str(), function);
  };
  for (int count : {10000, 100000}) {
    const auto worm = std::make_shared<const Worm>(count);
    const std::string size = absl::StrCat("/", count);
    add("copy" + size, [=](benchmark::State& s) { Copy(s, count); });
    add("linear_blend_eigen" + size,
        [=](benchmark::State& s) { NaiveLinearBlend(s, count); });
    for (InstructionSet level : SupportedInstructionSets()) {
      const std::string name = absl::StrCat(InstructionSetName(level), size);
      add("kernel/" + name,
          [=](benchmark::State& s) { Kernel(s, *worm, level, false); });
      add("quantised/" + name,
          [=](benchmark::State& s) { Kernel(s, *worm, level, true); });
    }
    add("frame" + size, [=](benchmark::State& s) { Frame(s, *worm); });
    if (count > 10000) continue;
    add("volumes/20_links", [=](benchmark::State& s) { Volumes(s, *worm); });
    add("folds/20_links", [=](benchmark::State& s) { Folds(s, *worm); });
    add("differences/encode" + size,
        [=](benchmark::State& s) { EncodeDifferences(s, *worm); });
    add("differences/decode" + size,
        [=](benchmark::State& s) { DecodeDifferences(s, *worm); });
    add("control_points" + size,
        [=](benchmark::State& s) { ControlPoints(s, *worm); });
  }
  return 0;
}

[[maybe_unused]] const int registered = Register();

}  // namespace
}  // namespace gelenk::benchmarks

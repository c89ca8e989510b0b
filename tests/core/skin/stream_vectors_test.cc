// Frames of every encoding with what they hold, in
// tests/golden/skin_stream.json: decoders in other languages are tested against
// the same file. To write it anew after the format has changed:
// GELENK_WRITE_GOLDEN=1 with this test.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/strings/escaping.h"
#include "gelenk/skin/control_plane_mesh.h"
#include "gelenk/skin/control_plane_stream.h"
#include "gelenk/skin/example_shapes.h"
#include "gelenk/skin/layered_skin.h"
#include "gelenk/skin/mesh_around.h"
#include "gelenk/skin/vertex_stream.h"
#include "tests/core/skin/skin_chains.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using nlohmann::json;

constexpr char kPath[] = GELENK_SOURCE_DIR "/tests/golden/skin_stream.json";
// Of coordinates up to 2 m, as floats.
constexpr double kFloatTolerance = 2e-6;
// Of unit vectors from floats that partly cancel.
constexpr double kNormalTolerance = 1e-4;
constexpr int kKeyframeInterval = 4;
constexpr int kFrames = 7;
// Of the humanoid's vertices one in so many is in the file, and some more.
constexpr int kVertexStep = 8;

std::string Base64(absl::string_view bytes) {
  return absl::Base64Escape(bytes);
}

std::string BytesOf(const json& base64) {
  std::string bytes;
  EXPECT_TRUE(absl::Base64Unescape(base64.get<std::string>(), &bytes));
  return bytes;
}

std::string BytesOf(const QuantizedBlocks& blocks) {
  return {
      reinterpret_cast<const char*>(blocks.data()),
      static_cast<size_t>(blocks.block_count()) * kernel::kQuantizedBlockBytes};
}

void AddVector(const Vector3d& vector, json& list) {
  for (double number : vector) list.push_back(static_cast<float>(number));
}

// A tube on two links, whose elbow bends from frame to frame.
class Arm {
 public:
  Arm() : skeleton_(testing::TwoLinkArm(Vector3d::UnitY())) {
    TubeShape tube;
    tube.length_m = 2;
    tube.radius_m = 0.2;
    tube.rings = 4;
    tube.around = 7;
    skin_ = LayeredSkin::Bind(*VolumeRig::Create(skeleton_).value(),
                              TubeMesh(tube).value())
                .value();
  }

  const LayeredSkin& skin() const { return *skin_; }

  VertexBlocks FloatsAt(int frame) {
    VertexBlocks blocks;
    skin_->Deform(PoseAt(frame), {}, workspace_, blocks);
    return blocks;
  }
  QuantizedBlocks QuantizedAt(int frame) {
    QuantizedBlocks blocks;
    skin_->DeformQuantized(PoseAt(frame), {}, workspace_, blocks);
    return blocks;
  }

 private:
  Eigen::VectorXd PoseAt(int frame) const {
    return testing::ElbowAt(*skeleton_, 0.3 + 0.05 * frame * frame);
  }

  std::shared_ptr<const Skeleton> skeleton_;
  std::shared_ptr<const LayeredSkin> skin_;
  SkinWorkspace workspace_;
};

template <class Blocks>
json VerticesOf(const Skin& skin, const Blocks& blocks,
                const std::string& bytes) {
  json positions = json::array(), normals = json::array();
  for (int slot : skin.slots()) {
    AddVector(blocks.position(slot).template cast<double>(), positions);
    AddVector(blocks.normal(slot).template cast<double>(), normals);
  }
  return {
      {"bytes", Base64(bytes)}, {"positions", positions}, {"normals", normals}};
}

struct Body {
  SkinShape shape = MakeSkinShape("humanoid", 500).value();
  std::shared_ptr<const LayeredSkin> skin =
      LayeredSkin::Bind(*VolumeRig::Create(shape.skeleton).value(), shape.mesh)
          .value();
};

// Every eighth vertex, and all that several volumes share.
std::vector<int> ChosenVertices(const LayeredSkin& skin) {
  std::vector<int> chosen;
  for (int v = 0; v < skin.vertex_count(); ++v) {
    const bool is_shared = skin.binding().vertices[v].share_count > 0;
    if (is_shared || v % kVertexStep == 0) chosen.push_back(v);
  }
  return chosen;
}

// The layout of the chosen vertices.
ControlPlaneLayout ChosenLayout(const LayeredSkin& skin) {
  const ControlPlaneLayout whole = LayoutOf(skin);
  ControlPlaneLayout layout = whole;
  layout.vertex_volumes.clear();
  layout.coordinates.clear();
  layout.normal_components.clear();
  std::vector<int> numbers(skin.vertex_count(), -1);
  for (int v : ChosenVertices(skin)) {
    numbers[v] = static_cast<int>(layout.vertex_volumes.size());
    layout.vertex_volumes.push_back(whole.vertex_volumes[v]);
    for (int k = 0; k < 3; ++k) {
      layout.coordinates.push_back(whole.coordinates[3 * v + k]);
      layout.normal_components.push_back(whole.normal_components[3 * v + k]);
    }
  }
  for (int& vertex : layout.part_vertices) vertex = numbers[vertex];
  return layout;
}

json JsonOf(const ControlPlaneLayout& layout) {
  json out = {{"vertexVolumes", layout.vertex_volumes},
              {"coordinates", layout.coordinates},
              {"normalComponents", layout.normal_components},
              {"partVertices", layout.part_vertices},
              {"partVolumes", layout.part_volumes},
              {"partCoordinates", layout.part_coordinates},
              {"partShares", layout.part_shares},
              {"partSlopes", layout.part_slopes},
              {"partShareSlopes", layout.part_share_slopes},
              {"ownSlopes", layout.own_slopes}};
  for (const PlaneLink& link : layout.links) {
    out["links"].push_back({{"parent", link.parent},
                            {"continuation", link.continuation},
                            {"lengthM", link.length_m},
                            {"startSpacingM", link.start_spacing_m},
                            {"endSpacingM", link.end_spacing_m},
                            {"isBranch", link.is_branch}});
  }
  return out;
}

ControlPlaneLayout LayoutFrom(const json& in) {
  ControlPlaneLayout layout{.vertex_volumes = in["vertexVolumes"],
                            .coordinates = in["coordinates"],
                            .normal_components = in["normalComponents"],
                            .part_vertices = in["partVertices"],
                            .part_volumes = in["partVolumes"],
                            .part_coordinates = in["partCoordinates"],
                            .part_shares = in["partShares"],
                            .part_slopes = in["partSlopes"],
                            .part_share_slopes = in["partShareSlopes"],
                            .own_slopes = in["ownSlopes"]};
  for (const json& link : in["links"]) {
    layout.links.push_back({link["parent"], link["continuation"],
                            link["lengthM"], link["startSpacingM"],
                            link["endSpacingM"], link["isBranch"]});
  }
  return layout;
}

json ControlPlaneFrame(const Body& body, int number) {
  const VolumeRig& rig = body.skin->rig();
  Eigen::VectorXd velocity =
      Eigen::VectorXd::Zero(body.shape.skeleton->velocity_count());
  for (int i = 0; i < velocity.size(); ++i) {
    velocity[i] = 0.3 * number * std::sin(1.0 + i);
  }
  Eigen::VectorXd pose = rig.rest_positions();
  Integrate(*body.shape.skeleton, rig.rest_positions(), velocity, pose);
  VolumeFrame frame;
  rig.Evaluate(pose, {}, frame);
  std::string bytes;
  EncodeControlPlanes(rig, frame, number, bytes);
  std::vector<Vector3d> positions, normals;
  body.skin->DeformExactly(frame, positions, &normals);
  json result = {{"bytes", Base64(bytes)},
                 {"positions", json::array()},
                 {"normals", json::array()}};
  for (int v : ChosenVertices(*body.skin)) {
    AddVector(positions[v], result["positions"]);
    AddVector(normals[v], result["normals"]);
  }
  return result;
}

json Vectors() {
  Arm arm;
  json vectors;
  vectors["slots"] = arm.skin().slots();
  std::string bytes;
  EncodeFloats(arm.FloatsAt(0), 0, bytes);
  vectors["float32"] = VerticesOf(arm.skin(), arm.FloatsAt(0), bytes);
  EncodeQuantized(arm.QuantizedAt(0), 0, bytes);
  vectors["quantized"] = VerticesOf(arm.skin(), arm.QuantizedAt(0), bytes);
  DeltaEncoder encoder(kKeyframeInterval);
  for (int frame = 0; frame < kFrames; ++frame) {
    const QuantizedBlocks blocks = arm.QuantizedAt(frame);
    encoder.Encode(blocks, bytes);
    vectors["delta"].push_back({{"bytes", Base64(bytes)},
                                {"isKeyframe", frame % kKeyframeInterval == 0},
                                {"blocks", Base64(BytesOf(blocks))}});
  }
  const Body body;
  vectors["controlPlanes"] = {
      {"layout", JsonOf(ChosenLayout(*body.skin))},
      {"frames", {ControlPlaneFrame(body, 0), ControlPlaneFrame(body, 1)}}};
  return vectors;
}

json ReadVectors() {
  std::ifstream file(kPath);
  return json::parse(file);
}

template <class Blocks>
void ExpectVertices(const json& vectors, const json& want,
                    const Blocks& blocks) {
  const std::vector<int> slots = vectors["slots"];
  const std::vector<double> positions = want["positions"];
  const std::vector<double> normals = want["normals"];
  ASSERT_EQ(positions.size(), 3 * slots.size());
  for (size_t v = 0; v < slots.size(); ++v) {
    const Vector3d position = blocks.position(slots[v]).template cast<double>();
    const Vector3d normal = blocks.normal(slots[v]).template cast<double>();
    EXPECT_LT((position - Vector3d(&positions[3 * v])).norm(), kFloatTolerance);
    EXPECT_LT((normal - Vector3d(&normals[3 * v])).norm(), kFloatTolerance);
  }
}

TEST(StreamVectorsTest, FloatsAndQuantizedDecodeToWhatIsWritten) {
  if (std::getenv("GELENK_WRITE_GOLDEN") != nullptr) {
    std::ofstream(kPath) << Vectors().dump() << "\n";
  }
  const json vectors = ReadVectors();
  VertexBlocks floats;
  ASSERT_TRUE(DecodeFloats(BytesOf(vectors["float32"]["bytes"]), floats).ok());
  ExpectVertices(vectors, vectors["float32"], floats);
  QuantizedBlocks quantized;
  ASSERT_TRUE(
      DecodeQuantized(BytesOf(vectors["quantized"]["bytes"]), quantized).ok());
  ExpectVertices(vectors, vectors["quantized"], quantized);
}

TEST(StreamVectorsTest, DifferencesDecodeToWhatIsWritten) {
  const json vectors = ReadVectors();
  DeltaDecoder decoder;
  QuantizedBlocks blocks;
  ASSERT_EQ(vectors["delta"].size(), static_cast<size_t>(kFrames));
  for (const json& frame : vectors["delta"]) {
    const std::string bytes = BytesOf(frame["bytes"]);
    EXPECT_EQ(ReadHeader(bytes)->is_keyframe, frame["isKeyframe"]);
    ASSERT_TRUE(decoder.Decode(bytes, blocks).ok());
    EXPECT_EQ(BytesOf(blocks), BytesOf(frame["blocks"]));
    // And that is still how they are encoded.
    std::string key;
    DeltaEncoder(1).Encode(blocks, key);
    if (frame["isKeyframe"]) {
      EXPECT_EQ(key.substr(kVertexStreamHeaderBytes),
                bytes.substr(kVertexStreamHeaderBytes));
    }
  }
}

TEST(StreamVectorsTest, ControlPlanesDecodeToWhatIsWritten) {
  const json vectors = ReadVectors()["controlPlanes"];
  auto mesh = *ControlPlaneMesh::Create(LayoutFrom(vectors["layout"]));
  EXPECT_GT(vectors["layout"]["ownSlopes"].size(), 6 * 20u);
  std::vector<Vector3d> positions, normals;
  for (const json& frame : vectors["frames"]) {
    ASSERT_TRUE(mesh.Deform(BytesOf(frame["bytes"]), positions, normals).ok());
    const std::vector<double> want_positions = frame["positions"];
    const std::vector<double> want_normals = frame["normals"];
    ASSERT_EQ(want_positions.size(), 3 * positions.size());
    for (size_t v = 0; v < positions.size(); ++v) {
      EXPECT_LT((positions[v] - Vector3d(&want_positions[3 * v])).norm(),
                kFloatTolerance)
          << v;
      EXPECT_LT((normals[v] - Vector3d(&want_normals[3 * v])).norm(),
                kNormalTolerance)
          << v;
    }
  }
}

TEST(StreamVectorsTest, LayoutsOfControlPlanesAreChecked) {
  const ControlPlaneLayout good =
      LayoutFrom(ReadVectors()["controlPlanes"]["layout"]);
  const auto refuses = [&good](const auto& change, const char* words) {
    ControlPlaneLayout bad = good;
    change(bad);
    EXPECT_THAT(ControlPlaneMesh::Create(std::move(bad)).status(),
                testing::Fails(absl::StatusCode::kInvalidArgument, words));
  };
  using Layout = ControlPlaneLayout;
  refuses([](Layout& l) { l.coordinates.pop_back(); }, "coordinates: want");
  refuses([](Layout& l) { l.normal_components.pop_back(); },
          "normal_components: want");
  refuses([](Layout& l) { l.part_volumes.pop_back(); }, "part_volumes: want");
  refuses([](Layout& l) { l.part_coordinates.pop_back(); },
          "part_coordinates: want");
  refuses([](Layout& l) { l.part_shares.pop_back(); }, "part_shares: want");
  refuses([](Layout& l) { l.part_slopes.pop_back(); }, "part_slopes: want");
  refuses([](Layout& l) { l.part_share_slopes.pop_back(); },
          "part_share_slopes: want");
  refuses([](Layout& l) { l.own_slopes.pop_back(); }, "own_slopes: want");
  refuses([](Layout& l) { l.vertex_volumes[3] = 9999; },
          "vertex_volumes[3]: want 0 to");
  refuses([](Layout& l) { l.part_vertices[0] = -1; },
          "part_vertices[0]: want 0 to");
  refuses(
      [](Layout& l) {
        std::swap(l.part_vertices.front(), l.part_vertices.back());
      },
      "part_vertices: want them rising");
  refuses([](Layout& l) { l.links[2].parent = 2; }, "links[2].parent: want");
  refuses([](Layout& l) { l.links[0].continuation = 999; },
          "links[0].continuation: want");
  refuses([](Layout& l) { l.links[1].length_m = NAN; },
          "links[1].length_m: want more than 0");
  refuses([](Layout& l) { l.links[1].end_spacing_m = 0; },
          "links[1].end_spacing_m: want more than 0");
}

TEST(StreamVectorsTest, PlanesOfAnotherSkinAreRefused) {
  const json vectors = ReadVectors()["controlPlanes"];
  auto mesh = *ControlPlaneMesh::Create(LayoutFrom(vectors["layout"]));
  const std::string bytes = BytesOf(vectors["frames"][0]["bytes"]);
  std::vector<Vector3d> positions, normals;
  for (size_t size = 0; size < bytes.size(); size += 7) {
    EXPECT_FALSE(mesh.Deform(bytes.substr(0, size), positions, normals).ok());
  }
  EXPECT_TRUE(mesh.Deform(bytes, positions, normals).ok());
}

}  // namespace
}  // namespace gelenk

// The file deformed as the format says, against the skin itself.
#include "gelenk/import/gltf_skin_writer.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "gelenk/import/glb_container.h"
#include "gelenk/import/gltf_reader.h"
#include "gelenk/skin/example_shapes.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using nlohmann::json;

// Sums of four products of numbers with 24 bits.
constexpr double kSingleM = 2e-6;

// A viewer of our own: nothing of the writer is asked.
class File {
 public:
  explicit File(const std::string& glb)
      : glb_(glb),
        root_(json::parse(JsonOfGltf(glb_).value())),
        binary_(BinaryOfGltf(glb_)) {}

  const json& root() const { return root_; }
  int vertex_count() const {
    return root_["accessors"][Attribute("POSITION")]["count"];
  }

  // Vertex `v` at key `key` of the animation; -1: as the nodes stand.
  Vector3d Position(int v, int key) const {
    const Vector3d at(Number<float>(Attribute("POSITION"), 3 * v),
                      Number<float>(Attribute("POSITION"), 3 * v + 1),
                      Number<float>(Attribute("POSITION"), 3 * v + 2));
    Vector3d sum = Vector3d::Zero();
    double weights = 0;
    for (int k = 0; k < 4; ++k) {
      const double weight = Number<float>(Attribute("WEIGHTS_0"), 4 * v + k);
      const int joint = Number<uint16_t>(Attribute("JOINTS_0"), 4 * v + k);
      sum += weight * (NodeAt(root_["skins"][0]["joints"][joint], key) * at);
      weights += weight;
    }
    EXPECT_NEAR(weights, 1, 1e-6);
    return sum;
  }

 private:
  int Attribute(const char* name) const {
    return root_["meshes"][0]["primitives"][0]["attributes"][name];
  }

  template <class T>
  T Number(int accessor, int index) const {
    const json& view =
        root_["bufferViews"]
             [root_["accessors"][accessor]["bufferView"].get<int>()];
    T number;
    std::memcpy(
        &number,
        binary_.data() + view["byteOffset"].get<size_t>() + index * sizeof(T),
        sizeof(T));
    return number;
  }

  Eigen::VectorXd Property(int node, const char* path, int size,
                           int key) const {
    Eigen::VectorXd value(size);
    for (int i = 0; i < size; ++i) value[i] = root_["nodes"][node][path][i];
    if (key < 0) return value;
    const json& animation = root_["animations"][0];
    for (const json& channel : animation["channels"]) {
      if (channel["target"]["node"] != node ||
          channel["target"]["path"] != path) {
        continue;
      }
      const int output =
          animation["samplers"][channel["sampler"].get<int>()]["output"];
      for (int i = 0; i < size; ++i) {
        value[i] = Number<float>(output, size * key + i);
      }
    }
    return value;
  }

  Eigen::Affine3d NodeAt(int node, int key) const {
    const Eigen::VectorXd rotation = Property(node, "rotation", 4, key);
    return Eigen::Translation3d(Property(node, "translation", 3, key)) *
           Eigen::Quaterniond(rotation[3], rotation[0], rotation[1],
                              rotation[2]) *
           Eigen::Scaling(Vector3d(Property(node, "scale", 3, key)));
  }

  const std::string glb_;
  const json root_;
  const absl::string_view binary_;
};

class GltfSkinWriterTest : public ::testing::Test {
 protected:
  static std::shared_ptr<const LayeredSkin> Skin(const std::string& name) {
    const SkinShape shape = MakeSkinShape(name, 600).value();
    return LayeredSkin::Bind(
               *VolumeRig::Create(shape.skeleton, shape.links, shape.muscles)
                    .value(),
               shape.mesh)
        .value();
  }

  // The last turning joint bent by 0, 45 and 90 degrees.
  static std::vector<SkinKey> Bends(const Skeleton& skeleton,
                                    const std::string& joint) {
    std::vector<SkinKey> keys;
    const int at = skeleton.span(skeleton.FindJoint(joint)).position_offset;
    for (int i = 0; i < 3; ++i) {
      SkinKey& key = keys.emplace_back();
      key.positions = skeleton.rest_positions();
      key.positions[at] = i * std::numbers::pi / 4;
      key.world_from_skeleton.translation.y() = 0.1 * i;
    }
    return keys;
  }
};

TEST_F(GltfSkinWriterTest, ViewersSeeTheSkinWithItsMuscles) {
  const auto skin = Skin("arm");
  const auto keys = Bends(skin->skeleton(), "forearm");
  const GltfSkinFile written =
      WriteGltfSkin(*skin, keys, 0.5, GltfForm::kBinary);
  EXPECT_EQ(written.inexact_vertex_count, 0);
  const File file(written.bytes);
  ASSERT_EQ(file.vertex_count(), skin->vertex_count());
  for (size_t i = 0; i < keys.size(); ++i) {
    VolumeFrame frame;
    skin->rig().Evaluate(keys[i].positions, keys[i].world_from_skeleton, frame);
    std::vector<Vector3d> want;
    skin->DeformExactly(frame, want, nullptr);
    for (int v = 0; v < skin->vertex_count(); ++v) {
      ASSERT_LE((file.Position(v, static_cast<int>(i)) - want[v]).norm(),
                kSingleM)
          << v << " at key " << i;
    }
  }
}

TEST_F(GltfSkinWriterTest, StandsAtTheBindPose) {
  const auto skin = Skin("humanoid");
  const GltfSkinFile written = WriteGltfSkin(*skin, {}, 1, GltfForm::kBinary);
  const File file(written.bytes);
  EXPECT_FALSE(file.root().contains("animations"));
  EXPECT_GT(written.inexact_vertex_count, 0) << "limbs branch off";
  for (int v = 0; v < skin->vertex_count(); ++v) {
    ASSERT_LE((file.Position(v, -1) - skin->mesh().positions[v]).norm(),
              kSingleM)
        << v;
  }
}

TEST_F(GltfSkinWriterTest, WhatDoesNotMoveHasNoTrack) {
  const auto skin = Skin("arm");
  const auto keys = Bends(skin->skeleton(), "hand");
  std::vector<SkinKey> still(3, keys[0]);
  EXPECT_FALSE(File(WriteGltfSkin(*skin, still, 1, GltfForm::kBinary).bytes)
                   .root()
                   .contains("animations"));
}

TEST_F(GltfSkinWriterTest, OtherReadersTakeIt) {
  const auto skin = Skin("cylinder");
  for (GltfForm form : {GltfForm::kJson, GltfForm::kBinary}) {
    const std::string bytes = WriteGltfSkin(*skin, {}, 1, form).bytes;
    EXPECT_EQ(ReadGltf(bytes).status(), absl::OkStatus());
  }
}

}  // namespace
}  // namespace gelenk

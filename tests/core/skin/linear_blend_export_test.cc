#include "gelenk/skin/linear_blend_export.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "gelenk/skin/example_shapes.h"
#include "tests/testing/random.h"
#include "tests/testing/random_pose.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

TEST(LinearBlendExportTest, BonesAndWeightsAreTheSkin) {
  testing::Random random(1);
  for (absl::string_view name : SkinShapeNames()) {
    const SkinShape shape = MakeSkinShape(name, 2000).value();
    const auto skin =
        LayeredSkin::Bind(
            *VolumeRig::Create(shape.skeleton, shape.links, shape.muscles)
                 .value(),
            shape.mesh)
            .value();
    const LinearBlendExport exported = ExportLinearBlend(*skin);
    ASSERT_EQ(static_cast<int>(exported.vertices.size()), skin->vertex_count());
    EXPECT_EQ(
        std::set<std::string>(exported.bones.begin(), exported.bones.end())
            .size(),
        exported.bones.size());
    VolumeFrame frame;
    skin->rig().Evaluate(
        testing::RandomPoseWithinLimits(random, *shape.skeleton), {}, frame);
    const std::vector<BoneMatrix> bones = BoneMatrices(skin->rig(), frame);
    ASSERT_EQ(bones.size(), exported.bones.size());
    std::vector<Vector3d> want;
    skin->DeformExactly(frame, want, nullptr);
    int exact = 0;
    for (int v = 0; v < skin->vertex_count(); ++v) {
      const LinearBlendExport::Vertex& vertex = exported.vertices[v];
      EXPECT_NEAR(
          std::accumulate(vertex.weights.begin(), vertex.weights.end(), 0.0), 1,
          1e-12);
      EXPECT_GE(*std::min_element(vertex.weights.begin(), vertex.weights.end()),
                -1e-12);
      if (std::binary_search(exported.inexact.begin(), exported.inexact.end(),
                             v)) {
        EXPECT_GT(skin->binding().vertices[v].share_count, 0);
        continue;
      }
      ++exact;
      Vector3d got = Vector3d::Zero();
      for (int k = 0; k < 4; ++k) {
        got += vertex.weights[k] *
               (bones[vertex.bones[k]] * vertex.position.homogeneous());
      }
      EXPECT_LE((got - want[v]).norm(), 1e-12);
    }
    EXPECT_GT(exact, 0.85 * skin->vertex_count());
    // Regular, so that a format that wants scale and rotation can have them.
    for (const BoneMatrix& bone : bones) {
      EXPECT_GT(bone.leftCols<3>().determinant(), 0.01);
    }
  }
}

}  // namespace
}  // namespace gelenk

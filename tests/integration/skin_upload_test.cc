// SkinService.UploadSkin: skins that are larger than a message.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "convert/skeleton.h"
#include "gelenk/client/status.h"
#include "gelenk/skin/layered_skin.h"
#include "gelenk/skin/vertex_stream.h"
#include "tests/integration/skin_service_test.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using testing::Fails;
constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

using Pieces = std::vector<v1::UploadSkinRequest>;

// `numbers` in pieces of so many at most, where `field(piece)` has them.
template <class Numbers, class Field>
void Cut(const Numbers& numbers, int piece_size, Field field, Pieces& pieces) {
  for (int at = 0; at < numbers.size(); at += piece_size) {
    const int count = std::min(piece_size, numbers.size() - at);
    field(pieces.emplace_back())
        ->Add(numbers.begin() + at, numbers.begin() + at + count);
  }
}

// `request` with its mesh in pieces; triangles come before their vertices.
Pieces CutMesh(v1::CreateSkinRequest request, int piece_size) {
  v1::TriangleMesh mesh;
  mesh.Swap(request.mutable_skin()->mutable_mesh());
  Pieces pieces(1);
  *pieces[0].mutable_header() = std::move(request);
  Cut(
      mesh.triangles(), piece_size,
      [](auto& piece) { return piece.mutable_mesh()->mutable_triangles(); },
      pieces);
  Cut(
      mesh.positions(), piece_size,
      [](auto& piece) { return piece.mutable_mesh()->mutable_positions(); },
      pieces);
  Cut(
      mesh.normals(), piece_size,
      [](auto& piece) { return piece.mutable_mesh()->mutable_normals(); },
      pieces);
  return pieces;
}

class SkinUploadTest : public SkinServiceTest {
 protected:
  static absl::StatusOr<v1::Skin> Upload(const Pieces& pieces) {
    grpc::ClientContext context;
    Prepare(context);
    v1::Skin skin;
    const auto writer = skins().UploadSkin(&context, &skin);
    for (const v1::UploadSkinRequest& piece : pieces) {
      // A server that has heard enough ends the call.
      if (!writer->Write(piece)) break;
    }
    writer->WritesDone();
    const grpc::Status status = writer->Finish();
    if (!status.ok()) return client::FromGrpc(status);
    return skin;
  }

  // The arm bent, in single precision.
  static std::string Bent(const std::string& skin) {
    v1::DeformSkinRequest request;
    request.set_name(skin);
    request.set_encoding(v1::VERTEX_ENCODING_FLOAT32);
    v1::Pose& pose = *request.add_poses()->mutable_pose();
    for (double angle_rad : {0.4, 0.7, -0.5}) pose.add_positions(angle_rad);
    grpc::ClientContext context;
    Prepare(context);
    const auto reader = skins().DeformSkin(&context, request);
    std::string data;
    v1::DeformSkinResponse message;
    while (reader->Read(&message)) data = message.frame().data();
    EXPECT_TRUE(reader->Finish().ok());
    return data;
  }

  static int SkinCount() {
    v1::ListSkinsRequest request;
    request.set_page_size(1000);
    return Call(&Stub::ListSkins, request).value().skins_size();
  }
};

TEST_F(SkinUploadTest, PiecesMakeTheSkinThatOneMessageMakes) {
  const v1::Skin whole = Create(TubeRequest());
  // No vertex nor triangle is in one piece.
  for (int piece_size : {7, 1000, 1000000}) {
    const auto skin = Upload(CutMesh(TubeRequest(), piece_size));
    ASSERT_TRUE(skin.ok()) << skin.status();
    EXPECT_EQ(skin->vertex_count(), whole.vertex_count());
    EXPECT_EQ(skin->triangle_count(), whole.triangle_count());
    EXPECT_EQ(Bent(skin->name()), Bent(whole.name())) << piece_size;
  }
}

// A frame of it is larger than what gRPC takes by default, too.
TEST_F(SkinUploadTest, AMeshOfAQuarterMillionVertices) {
  const TriangleMesh mesh = TubeMesh({1.5, 0.08, 500, 500}).value();
  v1::CreateSkinRequest request;
  request.set_skin_id("large-tube");
  request.mutable_skin()->set_skeleton("skeletons/planar-arm");
  convert::ToProto(mesh, request.mutable_skin()->mutable_mesh());
  ASSERT_GT(request.ByteSizeLong(), size_t{6} << 20);
  EXPECT_THAT(Call(&Stub::CreateSkin, request).status(),
              Fails(absl::StatusCode::kResourceExhausted, "message"));
  const auto skin = Upload(CutMesh(request, 200000));
  ASSERT_TRUE(skin.ok()) << skin.status();
  EXPECT_EQ(skin->vertex_count(), static_cast<int>(mesh.positions.size()));

  const std::shared_ptr<const Skeleton> skeleton =
      convert::FromProto(testing::ArmSkeletonRequest().skeleton()).value();
  const auto local =
      LayeredSkin::Bind(*VolumeRig::Create(skeleton).value(), mesh).value();
  SkinWorkspace workspace;
  VertexBlocks want;
  local->Deform(Eigen::Vector3d(0.4, 0.7, -0.5), RigidTransform(), workspace,
                want);
  VertexBlocks got;
  ASSERT_EQ(DecodeFloats(Bent(skin->name()), got), absl::OkStatus());
  ASSERT_EQ(got.block_count(), want.block_count());
  float worst_m = 0;
  for (int slot : local->slots()) {
    worst_m =
        std::max(worst_m, (got.position(slot) - want.position(slot)).norm());
  }
  EXPECT_LE(worst_m, 1e-5f);
}

TEST_F(SkinUploadTest, WeightsComeInPiecesToo) {
  v1::CreateSkinRequest request = TubeRequest();
  v1::VertexWeights& weights = *request.mutable_skin()->mutable_linear_blend();
  const auto skeleton =
      convert::FromProto(testing::ArmSkeletonRequest().skeleton()).value();
  weights.add_joint_ids(skeleton->joint(0).id);
  weights.add_joint_ids(skeleton->joint(1).id);
  weights.set_influences_per_vertex(2);
  const int vertices = request.skin().mesh().positions_size() / 3;
  for (int i = 0; i < vertices; ++i) {
    weights.add_joints(0);
    weights.add_joints(1);
    weights.add_weights(0.001f * static_cast<float>(i % 1000));
    weights.add_weights(1);
  }
  const v1::Skin whole = Create(request);
  v1::VertexWeights numbers;
  numbers.mutable_joints()->Swap(weights.mutable_joints());
  numbers.mutable_weights()->Swap(weights.mutable_weights());
  Pieces pieces = CutMesh(request, 500);
  Cut(
      numbers.weights(), 333,
      [](auto& piece) { return piece.mutable_weights()->mutable_weights(); },
      pieces);
  Cut(
      numbers.joints(), 333,
      [](auto& piece) { return piece.mutable_weights()->mutable_joints(); },
      pieces);
  const auto skin = Upload(pieces);
  ASSERT_TRUE(skin.ok()) << skin.status();
  EXPECT_EQ(Bent(skin->name()), Bent(whole.name()));
  // One piece too few is told as it would be of a message.
  pieces.pop_back();
  EXPECT_THAT(Upload(pieces).status(), Fails(kInvalid, "skin.linear_blend"));
}

TEST_F(SkinUploadTest, AssignmentsComeInPiecesToo) {
  v1::CreateSkinRequest request = TubeRequest();
  request.mutable_skin()->mutable_layered_volumes();
  Pieces pieces = CutMesh(request, 5000);
  const v1::Skin whole = Create(request);
  v1::VertexAssignment& assignment = *pieces.emplace_back().add_assignments();
  assignment.set_link_id(whole.links(2).link_id());
  assignment.set_scope(v1::ASSIGNMENT_SCOPE_LINK);
  assignment.mutable_vertices()->add_starts(0);
  assignment.mutable_vertices()->add_lengths(10);
  const auto skin = Upload(pieces);
  ASSERT_TRUE(skin.ok()) << skin.status();
  EXPECT_NE(Bent(skin->name()), Bent(whole.name()));
}

TEST_F(SkinUploadTest, PiecesThatDoNotFitAreRefused) {
  const int before = SkinCount();
  EXPECT_THAT(Upload({}).status(), Fails(kInvalid, "header"));
  const Pieces whole = CutMesh(TubeRequest(), 5000);
  EXPECT_THAT(Upload({whole.begin() + 1, whole.end()}).status(),
              Fails(kInvalid, "header: the first message must hold it"));
  EXPECT_THAT(Upload({whole[0], whole[0]}).status(),
              Fails(kInvalid, "header: the first message must hold it"));
  EXPECT_THAT(Upload({whole[0], v1::UploadSkinRequest()}).status(),
              Fails(kInvalid, "mesh: a piece holds nothing"));
  // A mesh without its end names vertices that it has not.
  EXPECT_THAT(Upload({whole.begin(), whole.end() - 1}).status(),
              Fails(kInvalid, "skin.mesh"));

  v1::UploadSkinRequest weights;
  weights.mutable_weights()->add_joints(0);
  EXPECT_THAT(Upload({whole[0], weights}).status(),
              Fails(kInvalid, "header.skin.linear_blend: unset"));
  v1::UploadSkinRequest blended = whole[0];
  blended.mutable_header()->mutable_skin()->mutable_linear_blend();
  weights.mutable_weights()->add_joint_ids("j0");
  EXPECT_THAT(Upload({blended, weights}).status(),
              Fails(kInvalid, "weights: want joints and weights only"));
  v1::UploadSkinRequest assignment;
  assignment.add_assignments();
  EXPECT_THAT(Upload({whole[0], assignment}).status(),
              Fails(kInvalid, "header.skin.layered_volumes: unset"));
  v1::UploadSkinRequest shape;
  shape.mutable_header()->mutable_skin()->mutable_shape()->set_shape_id("arm");
  EXPECT_THAT(Upload({shape, whole[1]}).status(),
              Fails(kInvalid, "header.skin.mesh: unset"));
  EXPECT_EQ(SkinCount(), before);
}

TEST_F(SkinUploadTest, ARepeatAnswersTheFirstResult) {
  v1::CreateSkinRequest request = TubeRequest("tube-again");
  request.set_request_id("once");
  const auto first = Upload(CutMesh(request, 5000));
  const auto second = Upload(CutMesh(request, 3000));
  ASSERT_TRUE(first.ok() && second.ok()) << first.status() << second.status();
  EXPECT_EQ(second->name(), first->name());
  request.set_request_id("twice");
  EXPECT_THAT(Upload(CutMesh(request, 5000)).status(),
              Fails(absl::StatusCode::kAlreadyExists, "tube-again"));
}

TEST_F(SkinUploadTest, OfAnUploadThatIsBrokenOffNothingStays) {
  const int before = SkinCount();
  const Pieces pieces = CutMesh(TubeRequest("tube-gone"), 500);
  {
    grpc::ClientContext context;
    Prepare(context);
    v1::Skin skin;
    const auto writer = skins().UploadSkin(&context, &skin);
    for (const v1::UploadSkinRequest& piece : pieces) {
      ASSERT_TRUE(writer->Write(piece));
    }
    context.TryCancel();
    EXPECT_EQ(writer->Finish().error_code(), grpc::StatusCode::CANCELLED);
  }
  EXPECT_EQ(SkinCount(), before);
  // Its name is free.
  EXPECT_TRUE(Upload(pieces).ok());
}

class SmallUploadTest : public SkinUploadTest {
 protected:
  static void SetUpTestSuite() {
    StartServer({"--max-skin-vertices", "900", "--max-skin-triangles", "1700",
                 "--max-import-bytes", "20000"});
  }
};

TEST_F(SmallUploadTest, NoMoreThanTheServerWants) {
  Pieces pieces(2);
  pieces[0].mutable_header()->mutable_skin()->mutable_mesh();
  auto& mesh = *pieces[1].mutable_mesh();
  mesh.mutable_positions()->Resize(3 * 901, 0);
  EXPECT_THAT(Upload(pieces).status(),
              Fails(kInvalid, "mesh.positions: want at most 900 vertices"));
  mesh.mutable_positions()->Resize(3 * 900, 0);
  mesh.mutable_triangles()->Resize(3 * 1701, 0);
  EXPECT_THAT(Upload(pieces).status(),
              Fails(kInvalid, "mesh.triangles: want at most 1700 triangles"));
  pieces[1].mutable_mesh()->mutable_triangles()->Resize(3, 0);
  pieces.push_back(pieces[1]);
  EXPECT_THAT(Upload(pieces).status(),
              Fails(kInvalid, "mesh: want at most 20000 bytes"));
}

}  // namespace
}  // namespace gelenk

// DeformSkin and WatchSkin over the wire: every encoding gives the vertices
// that the library gives, and what is lost heals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "convert/pose.h"
#include "convert/skeleton.h"
#include "convert/skin_layout.h"
#include "gelenk/skin/control_plane_mesh.h"
#include "gelenk/skin/layered_skin.h"
#include "gelenk/skin/vertex_stream.h"
#include "tests/integration/skin_service_test.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using ::testing::ElementsAre;
using testing::Fails;

// Of positions in single precision.
constexpr double kFloatM = 1e-6;
// Of 16 bits in a cube that no pose of the arm leaves: some 4 m.
constexpr double kQuantizedM = 1e-4;

v1::SkinPose PoseOf(int frame) {
  v1::SkinPose pose;
  for (double angle_rad : {0.4, 0.7, -0.5}) {
    pose.mutable_pose()->add_positions(angle_rad * std::sin(0.1 * frame));
  }
  pose.mutable_world_from_skeleton()->mutable_translation()->set_z(0.25);
  return pose;
}

class SkinStreamTest : public SkinServiceTest {
 protected:
  void SetUp() override {
    skin_ = Create(TubeRequest());
    skeleton_ =
        convert::FromProto(testing::ArmSkeletonRequest().skeleton()).value();
    local_ = LayeredSkin::Bind(*VolumeRig::Create(skeleton_).value(), Tube())
                 .value();
  }

  v1::DeformSkinRequest Request(v1::VertexEncoding encoding, int frames) const {
    v1::DeformSkinRequest request;
    request.set_name(skin_.name());
    request.set_encoding(encoding);
    for (int i = 0; i < frames; ++i) *request.add_poses() = PoseOf(i);
    return request;
  }

  // All messages, and how the call ended.
  static std::vector<v1::DeformSkinResponse> Deform(
      const v1::DeformSkinRequest& request, absl::Status* status = nullptr) {
    grpc::ClientContext context;
    Prepare(context);
    const auto reader = skins().DeformSkin(&context, request);
    std::vector<v1::DeformSkinResponse> messages;
    v1::DeformSkinResponse message;
    while (reader->Read(&message)) messages.push_back(message);
    const absl::Status end = client::FromGrpc(reader->Finish());
    if (status == nullptr) {
      EXPECT_EQ(end, absl::OkStatus());
    } else {
      *status = end;
    }
    return messages;
  }

  // As the library deforms the same skin.
  VertexBlocks Expected(int frame) const {
    const v1::SkinPose pose = PoseOf(frame);
    const Eigen::VectorXd positions = Eigen::Map<const Eigen::VectorXd>(
        pose.pose().positions().data(), pose.pose().positions_size());
    RigidTransform base;
    base.translation.z() = 0.25;
    SkinWorkspace workspace;
    VertexBlocks blocks;
    local_->Deform(positions, base, workspace, blocks);
    return blocks;
  }

  template <class Blocks>
  void ExpectFrame(int frame, const Blocks& got, double tolerance_m) const {
    const VertexBlocks want = Expected(frame);
    ASSERT_EQ(got.block_count(), want.block_count());
    double worst_m = 0;
    for (int slot : local_->slots()) {
      worst_m = std::max(worst_m, (got.position(slot).template cast<double>() -
                                   want.position(slot).template cast<double>())
                                      .norm());
    }
    EXPECT_LE(worst_m, tolerance_m) << frame;
  }

  v1::Skin skin_;
  std::shared_ptr<const Skeleton> skeleton_;
  std::shared_ptr<const LayeredSkin> local_;
};

TEST_F(SkinStreamTest, FloatsAreWhatTheLibraryGives) {
  v1::DeformSkinRequest request = Request(v1::VERTEX_ENCODING_FLOAT32, 5);
  request.set_include_layout(true);
  const auto messages = Deform(request);
  ASSERT_EQ(messages.size(), 6u);
  const v1::SkinLayout& layout = messages[0].layout();
  EXPECT_FALSE(messages[0].has_frame());
  EXPECT_EQ(layout.name(), skin_.name() + "@1");
  EXPECT_EQ(std::vector<int>(layout.slots().begin(), layout.slots().end()),
            std::vector<int>(local_->slots().begin(), local_->slots().end()));
  EXPECT_EQ(layout.triangles_size(), 3 * skin_.triangle_count());
  for (int i = 0; i < 5; ++i) {
    const v1::SkinFrame& frame = messages[i + 1].frame();
    EXPECT_EQ(frame.sequence_number(), i);
    EXPECT_TRUE(frame.is_keyframe());
    VertexBlocks blocks;
    ASSERT_EQ(DecodeFloats(frame.data(), blocks), absl::OkStatus());
    ExpectFrame(i, blocks, kFloatM);
  }
}

TEST_F(SkinStreamTest, QuantizedIsTheDefaultAndAThirdOfFloats) {
  const auto floats = Deform(Request(v1::VERTEX_ENCODING_FLOAT32, 1));
  const auto messages = Deform(Request(v1::VERTEX_ENCODING_UNSPECIFIED, 3));
  ASSERT_EQ(messages.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(messages[i].frame().encoding(),
              v1::VERTEX_ENCODING_QUANTIZED_16_OCT_8);
    QuantizedBlocks blocks;
    ASSERT_EQ(DecodeQuantized(messages[i].frame().data(), blocks),
              absl::OkStatus());
    ExpectFrame(i, blocks, kQuantizedM);
  }
  EXPECT_NEAR(static_cast<double>(messages[0].frame().data().size()) /
                  static_cast<double>(floats[0].frame().data().size()),
              1. / 3, 0.01);
}

TEST_F(SkinStreamTest, DifferencesComeWithKeyframes) {
  v1::DeformSkinRequest request = Request(v1::VERTEX_ENCODING_DELTA, 20);
  request.set_keyframe_interval(8);
  const auto messages = Deform(request);
  ASSERT_EQ(messages.size(), 20u);
  DeltaDecoder decoder;
  QuantizedBlocks blocks;
  for (int i = 0; i < 20; ++i) {
    const v1::SkinFrame& frame = messages[i].frame();
    EXPECT_EQ(frame.is_keyframe(), i % 8 == 0) << i;
    ASSERT_EQ(decoder.Decode(frame.data(), blocks), absl::OkStatus()) << i;
    ExpectFrame(i, blocks, kQuantizedM);
  }
}

TEST_F(SkinStreamTest, ALostFrameHealsAtTheNextKeyframe) {
  v1::DeformSkinRequest request = Request(v1::VERTEX_ENCODING_DELTA, 20);
  request.set_keyframe_interval(8);
  const auto messages = Deform(request);
  DeltaDecoder decoder;
  QuantizedBlocks blocks;
  // The second keyframe is lost.
  for (int i = 0; i < 20; ++i) {
    if (i == 8) continue;
    const absl::Status status =
        decoder.Decode(messages[i].frame().data(), blocks);
    if (i > 8 && i < 16) {
      EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition) << i;
    } else {
      EXPECT_EQ(status, absl::OkStatus()) << i;
      ExpectFrame(i, blocks, kQuantizedM);
    }
  }
}

// What a client does with them, of a body that branches.
TEST_F(SkinStreamTest, ClientsDeformByControlPlanes) {
  v1::CreateSkinRequest create;
  create.mutable_skin()->mutable_shape()->set_shape_id("humanoid");
  create.mutable_skin()->mutable_shape()->set_vertex_count(1500);
  const v1::Skin body = Create(create);
  v1::DeformSkinRequest request;
  request.set_name(body.name());
  request.set_include_layout(true);
  v1::GetSkeletonRequest get;
  get.set_name(body.skeleton());
  const auto skeleton =
      convert::FromProto(
          Call(&v1::KinematicsService::Stub::GetSkeleton, get).value())
          .value();
  Eigen::VectorXd bend = Eigen::VectorXd::Zero(skeleton->velocity_count());
  for (int i = 0; i < bend.size(); ++i) bend[i] = 0.3 * std::sin(1 + i);
  Eigen::VectorXd pose = skeleton->rest_positions();
  Integrate(*skeleton, skeleton->rest_positions(), bend, pose);
  convert::ToProto(pose, request.add_poses()->mutable_pose());
  request.set_encoding(v1::VERTEX_ENCODING_CONTROL_PLANES);
  const auto planes = Deform(request);
  request.set_encoding(v1::VERTEX_ENCODING_FLOAT32);
  const auto floats = Deform(request);
  ASSERT_EQ(planes.size(), 2u);
  ASSERT_EQ(floats.size(), 2u);

  const v1::VolumeLayout& layout = planes[0].layout().volumes();
  ASSERT_GT(layout.part_vertices_size(), 0);
  auto mesh = ControlPlaneMesh::Create(convert::FromProto(layout));
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  std::vector<Eigen::Vector3d> positions, normals;
  ASSERT_EQ(mesh->Deform(planes[1].frame().data(), positions, normals),
            absl::OkStatus());
  VertexBlocks want;
  ASSERT_EQ(DecodeFloats(floats[1].frame().data(), want), absl::OkStatus());
  const auto& slots = floats[0].layout().slots();
  ASSERT_EQ(static_cast<int>(positions.size()), slots.size());
  for (int v = 0; v < slots.size(); ++v) {
    EXPECT_LT((positions[v] - want.position(slots[v]).cast<double>()).norm(),
              5 * kFloatM)
        << v;
    EXPECT_LT((normals[v] - want.normal(slots[v]).cast<double>()).norm(), 1e-3)
        << v;
  }
}

TEST_F(SkinStreamTest, FoldsAreToldWhenAsked) {
  v1::DeformSkinRequest request = Request(v1::VERTEX_ENCODING_UNSPECIFIED, 0);
  v1::Pose& pose = *request.add_poses()->mutable_pose();
  for (double angle_rad : {0., 3., 0.}) pose.add_positions(angle_rad);
  EXPECT_EQ(Deform(request)[0].frame().folds_size(), 0);
  request.set_include_warnings(true);
  const auto messages = Deform(request);
  ASSERT_GT(messages[0].frame().folds_size(), 0);
  EXPECT_LE(messages[0].frame().folds(0).least_jacobian(), 0);
}

TEST_F(SkinStreamTest, MusclesThatAreClampedAreToldWhenAsked) {
  v1::UpdateMusclesRequest muscles;
  muscles.set_name(skin_.name());
  v1::Muscle& swollen = *muscles.add_muscles();
  swollen.set_muscle_id("swollen");
  swollen.set_link_id(skin_.links(0).link_id());
  swollen.mutable_explicit_scales()->set_scale_s_p2(2);
  swollen.mutable_explicit_scales()->set_scale_t_p2(2);
  swollen.mutable_explicit_scales()->set_scale_s_p4(2);
  swollen.mutable_explicit_scales()->set_scale_t_p4(2);
  v1::Muscle& keeper = *muscles.add_muscles();
  keeper.set_muscle_id("keeper");
  keeper.set_link_id(skin_.links(0).link_id());
  keeper.mutable_preserve_volume();
  ASSERT_EQ(Call(&Stub::UpdateMuscles, muscles).status(), absl::OkStatus());
  v1::DeformSkinRequest request = Request(v1::VERTEX_ENCODING_UNSPECIFIED, 1);
  EXPECT_EQ(Deform(request)[0].frame().clamped_volumes_size(), 0);
  request.set_include_warnings(true);
  const v1::SkinFrame frame = Deform(request)[0].frame();
  ASSERT_EQ(frame.clamped_volumes_size(), 1);
  const v1::ClampedVolume& clamped = frame.clamped_volumes(0);
  EXPECT_EQ(clamped.link_id(), skin_.links(0).link_id());
  EXPECT_EQ(clamped.scale(), 0.8);
  // What would have been needed undoes the swelling.
  EXPECT_NEAR(clamped.wanted_scale(), 0.5, 0.05);
}

TEST_F(SkinStreamTest, ASessionsPoseIsDeformed) {
  const std::string session = CreateSession();
  v1::DeformSkinRequest request = Request(v1::VERTEX_ENCODING_FLOAT32, 0);
  request.set_session(session);
  const auto of_session = Deform(request);
  ASSERT_EQ(of_session.size(), 1u);
  v1::DeformSkinRequest of_pose = Request(v1::VERTEX_ENCODING_FLOAT32, 0);
  *of_pose.add_poses()->mutable_pose() =
      testing::ArmSessionRequest().session().pose();
  EXPECT_EQ(of_session[0].frame().data(), Deform(of_pose)[0].frame().data());
}

TEST_F(SkinStreamTest, BadRequestsAreRefusedByField) {
  const auto fails =
      [](const v1::DeformSkinRequest& request, const std::string& words,
         absl::StatusCode code = absl::StatusCode::kInvalidArgument) {
        absl::Status status;
        EXPECT_TRUE(Deform(request, &status).empty());
        EXPECT_THAT(status, Fails(code, words));
      };
  v1::DeformSkinRequest request = Request(v1::VERTEX_ENCODING_UNSPECIFIED, 2);
  request.set_name("skins/nobody");
  fails(request, "skins/nobody", absl::StatusCode::kNotFound);
  request.set_name(skin_.name() + "@9");
  fails(request, "@9", absl::StatusCode::kNotFound);
  request.set_name(skin_.name());
  request.mutable_poses(1)->mutable_pose()->add_positions(1);
  fails(request, "poses[1].pose");
  request = Request(v1::VERTEX_ENCODING_UNSPECIFIED, 1);
  request.mutable_poses(0)
      ->mutable_world_from_skeleton()
      ->mutable_translation()
      ->set_x(NAN);
  fails(request, "poses[0].world_from_skeleton");
  fails(Request(v1::VERTEX_ENCODING_UNSPECIFIED, 0),
        "poses: want some, or a session, got neither");
  fails(Request(v1::VERTEX_ENCODING_UNSPECIFIED, 1025), "got 1025");
  fails(Request(static_cast<v1::VertexEncoding>(77), 1), "encoding");
  request = Request(v1::VERTEX_ENCODING_DELTA, 1);
  request.set_keyframe_interval(-1);
  fails(request, "keyframe_interval");
  request = Request(v1::VERTEX_ENCODING_DELTA, 1);
  request.set_session("sessions/somebody");
  fails(request, "want some, or a session, got both");
  request.clear_poses();
  fails(request, "sessions/somebody", absl::StatusCode::kNotFound);
}

// A WatchSkin, bounded in time.
class Viewer {
 public:
  Viewer(v1::SkinService::Stub& stub,
         const v1::WatchSkinRequest::Start& start) {
    context_.set_deadline(std::chrono::system_clock::now() +
                          absl::ToChronoSeconds(testing::kPatience));
    stream_ = stub.WatchSkin(&context_);
    v1::WatchSkinRequest request;
    *request.mutable_start() = start;
    stream_->Write(request);
  }
  ~Viewer() {
    if (ended_) return;
    context_.TryCancel();
    End().IgnoreError();
  }

  v1::WatchSkinResponse Next() {
    v1::WatchSkinResponse response;
    EXPECT_TRUE(stream_->Read(&response));
    return response;
  }
  void Send(const v1::WatchSkinRequest& request) { stream_->Write(request); }
  void AskForKeyframe() {
    v1::WatchSkinRequest request;
    request.set_request_keyframe(true);
    Send(request);
  }
  void HalfClose() { stream_->WritesDone(); }
  // Reads what is left.
  absl::Status End() {
    ended_ = true;
    v1::WatchSkinResponse rest;
    while (stream_->Read(&rest)) {
    }
    return client::FromGrpc(stream_->Finish());
  }

 private:
  bool ended_ = false;
  grpc::ClientContext context_;
  std::unique_ptr<
      grpc::ClientReaderWriter<v1::WatchSkinRequest, v1::WatchSkinResponse>>
      stream_;
};

class WatchSkinTest : public SkinStreamTest {
 protected:
  void SetUp() override {
    SkinStreamTest::SetUp();
    session_ = CreateSession();
    start_.set_name(skin_.name());
    start_.set_session(session_);
    start_.set_encoding(v1::VERTEX_ENCODING_DELTA);
    start_.set_keyframe_interval(1000);
  }

  void Solve(double x_m) {
    v1::SolveSessionRequest request;
    request.set_name(session_);
    v1::Goal& goal = *request.mutable_goal_patch()->add_goals();
    goal.set_goal_id("reach");
    goal.mutable_position()->set_end_effector_id("tip");
    goal.mutable_position()->mutable_world_position()->set_x(x_m);
    ASSERT_EQ(Call(&v1::SessionService::Stub::SolveSession, request).status(),
              absl::OkStatus());
  }

  std::string session_;
  v1::WatchSkinRequest::Start start_;
};

TEST_F(WatchSkinTest, FollowsASessionByDifferences) {
  Viewer viewer(skins(), start_);
  EXPECT_EQ(viewer.Next().layout().name(), skin_.name() + "@1");
  DeltaDecoder decoder;
  QuantizedBlocks first;
  const v1::WatchSkinResponse keyframe = viewer.Next();
  EXPECT_TRUE(keyframe.frame().is_keyframe());
  ASSERT_EQ(decoder.Decode(keyframe.frame().data(), first), absl::OkStatus());
  Solve(1.2);
  const v1::WatchSkinResponse next = viewer.Next();
  EXPECT_FALSE(next.frame().is_keyframe());
  QuantizedBlocks second;
  ASSERT_EQ(decoder.Decode(next.frame().data(), second), absl::OkStatus());
  const int slot = local_->slots()[local_->vertex_count() - 1];
  EXPECT_GT((first.position(slot) - second.position(slot)).norm(), 0.05);
}

TEST_F(WatchSkinTest, AKeyframeComesWhenAskedForThoughNothingMoves) {
  Viewer viewer(skins(), start_);
  viewer.Next();
  const v1::SkinFrame first = viewer.Next().frame();
  viewer.AskForKeyframe();
  const v1::SkinFrame again = viewer.Next().frame();
  EXPECT_TRUE(again.is_keyframe());
  // A decoder that has seen nothing else understands it.
  DeltaDecoder decoder;
  QuantizedBlocks blocks;
  EXPECT_EQ(decoder.Decode(again.data(), blocks), absl::OkStatus());
  EXPECT_EQ(again.sequence_number(), first.sequence_number());
}

TEST_F(WatchSkinTest, ANewRevisionTakesOverWithItsLayout) {
  Viewer viewer(skins(), start_);
  viewer.Next();
  viewer.Next();
  start_.set_name(skin_.name() + "@1");
  Viewer pinned(skins(), start_);
  pinned.Next();
  pinned.Next();
  v1::RebindVerticesRequest edit;
  edit.set_name(skin_.name());
  edit.set_link_id("j2");
  edit.mutable_selector()->mutable_vertices()->add_starts(0);
  edit.mutable_selector()->mutable_vertices()->add_lengths(20);
  edit.set_scope(v1::ASSIGNMENT_SCOPE_LINK);
  ASSERT_EQ(Call(&Stub::RebindVertices, edit).status(), absl::OkStatus());
  EXPECT_EQ(viewer.Next().layout().name(), skin_.name() + "@2");
  EXPECT_TRUE(viewer.Next().frame().is_keyframe());
  Solve(1.1);
  EXPECT_FALSE(pinned.Next().frame().is_keyframe()) << "stays with its own";
}

TEST_F(WatchSkinTest, SaysThatTheSkinHasGone) {
  Viewer viewer(skins(), start_);
  viewer.Next();
  viewer.Next();
  v1::DeleteSkinRequest request;
  request.set_name(skin_.name());
  ASSERT_EQ(Call(&Stub::DeleteSkin, request).status(), absl::OkStatus());
  const v1::StreamEvent event = viewer.Next().event();
  EXPECT_EQ(event.kind(), v1::StreamEvent::KIND_DETACHED);
  EXPECT_EQ(event.status().code(),
            static_cast<int>(absl::StatusCode::kNotFound));
  EXPECT_THAT(viewer.End(), Fails(absl::StatusCode::kNotFound, skin_.name()));
}

TEST_F(WatchSkinTest, SaysThatTheSessionHasGone) {
  Viewer viewer(skins(), start_);
  viewer.Next();
  viewer.Next();
  v1::DeleteSessionRequest request;
  request.set_name(session_);
  ASSERT_EQ(Call(&v1::SessionService::Stub::DeleteSession, request).status(),
            absl::OkStatus());
  EXPECT_EQ(viewer.Next().event().kind(), v1::StreamEvent::KIND_DETACHED);
  EXPECT_FALSE(viewer.End().ok());
}

TEST_F(WatchSkinTest, AViewerLeavesByHalfClosing) {
  Viewer viewer(skins(), start_);
  viewer.Next();
  viewer.HalfClose();
  EXPECT_EQ(viewer.End(), absl::OkStatus());
}

TEST_F(WatchSkinTest, BadRequestsAreRefusedByField) {
  const auto end_of = [this](const v1::WatchSkinRequest::Start& start) {
    return Viewer(skins(), start).End();
  };
  v1::WatchSkinRequest::Start start = start_;
  start.set_name("skins/nobody");
  EXPECT_EQ(end_of(start).code(), absl::StatusCode::kNotFound);
  start.set_name("nobody");
  EXPECT_THAT(end_of(start),
              Fails(absl::StatusCode::kInvalidArgument, "start.name"));
  start = start_;
  start.set_session("nobody");
  EXPECT_THAT(end_of(start),
              Fails(absl::StatusCode::kInvalidArgument, "start.session"));
  start = start_;
  start.set_keyframe_interval(-1);
  EXPECT_THAT(end_of(start), Fails(absl::StatusCode::kInvalidArgument,
                                   "start.keyframe_interval"));
  Viewer twice(skins(), start_);
  v1::WatchSkinRequest again;
  *again.mutable_start() = start_;
  twice.Send(again);
  EXPECT_THAT(twice.End(),
              Fails(absl::StatusCode::kInvalidArgument, "start: the first"));
}

TEST_F(WatchSkinTest, ASessionOnAnotherSkeletonIsRefused) {
  v1::CreateSkinRequest shape;
  shape.mutable_skin()->mutable_shape()->set_shape_id("cylinder");
  shape.mutable_skin()->mutable_shape()->set_vertex_count(200);
  start_.set_name(Create(shape).name());
  EXPECT_THAT(Viewer(skins(), start_).End(),
              Fails(absl::StatusCode::kInvalidArgument, "planar-arm"));
}

}  // namespace
}  // namespace gelenk

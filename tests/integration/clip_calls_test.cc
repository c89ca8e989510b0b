// Clips over the wire: files and keyframes in and out, edits, revisions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/integration/clip_service_test.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using ::testing::ElementsAre;
using testing::Fails;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class ClipCallsTest : public ClipServiceTest {
 protected:
  static v1::EditKeyframesRequest Edit(const std::string& name) {
    v1::EditKeyframesRequest request;
    request.set_name(name);
    return request;
  }

  // "j0" of the arm gets a key.
  static void AddKey(double time_s, double angle_rad,
                     v1::EditKeyframesRequest* request) {
    v1::InsertKey* key = request->add_edits()->mutable_insert_key();
    key->set_joint_id("j0");
    key->set_time_s(time_s);
    key->add_values(angle_rad);
  }

  // The keys of the arm's "j0".
  static std::vector<double> Values(const std::string& name) {
    const Exported exported = Export(name, v1::CLIP_FORMAT_UNSPECIFIED);
    EXPECT_EQ(exported.status, absl::OkStatus());
    for (const v1::JointTrack& track : exported.clip.tracks()) {
      if (track.joint_id() == "j0") {
        return {track.values().begin(), track.values().end()};
      }
    }
    return {};
  }
};

TEST_F(ClipCallsTest, ABvhFileComesBackAsItWas) {
  const auto clip = CreateWalk(100);
  ASSERT_TRUE(clip.ok()) << clip.status();
  EXPECT_THAT(clip->name(), StartsWith("clips/"));
  EXPECT_EQ(clip->revision(), 1);
  EXPECT_EQ(clip->frame_time_s(), 0.02);
  EXPECT_NEAR(clip->duration_s(), 99 * 0.02, 1e-12);
  EXPECT_EQ(clip->unit_m(), 0.01);
  EXPECT_THAT(clip->tracks(), IsEmpty());
  EXPECT_GT(clip->key_count(), 100);
  const Exported bvh = Export(clip->name(), v1::CLIP_FORMAT_BVH);
  ASSERT_EQ(bvh.status, absl::OkStatus());
  EXPECT_EQ(bvh.clip.name(), clip->name());
  // The form is the file's own; angles are within rounding of degrees.
  const std::string source = testing::WalkingBvh(100);
  const size_t motion = source.find("MOTION");
  EXPECT_EQ(bvh.data.substr(0, motion).find("ROOT Hips"),
            source.find("ROOT Hips"));
  EXPECT_THAT(bvh.data, HasSubstr("Frames: 100"));
}

TEST_F(ClipCallsTest, ItsSkeletonIsMadeAndKept) {
  const auto clip = CreateWalk();
  ASSERT_TRUE(clip.ok()) << clip.status();
  v1::GetSkeletonRequest get;
  get.set_name(clip->skeleton());
  const auto skeleton = Call(&v1::KinematicsService::Stub::GetSkeleton, get);
  ASSERT_TRUE(skeleton.ok()) << skeleton.status();
  EXPECT_EQ(skeleton->joints_size(), testing::kWalkingJointCount);
  v1::DeleteSkeletonRequest remove;
  remove.set_name(clip->skeleton());
  EXPECT_THAT(
      Call(&v1::KinematicsService::Stub::DeleteSkeleton, remove).status(),
      Fails(absl::StatusCode::kFailedPrecondition, clip->name()));
  v1::DeleteClipRequest drop;
  drop.set_name(clip->name());
  ASSERT_TRUE(Call(&Stub::DeleteClip, drop).ok());
  EXPECT_TRUE(Call(&v1::KinematicsService::Stub::DeleteSkeleton, remove).ok());
}

TEST_F(ClipCallsTest, ASecondFileGoesOnTheSameSkeleton) {
  const auto first = CreateWalk(20);
  ASSERT_TRUE(first.ok()) << first.status();
  const auto second = CreateWalk(30, first->skeleton());
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_EQ(second->skeleton(), first->skeleton());
  EXPECT_THAT(CreateWalk(30, "skeletons/planar-arm").status(),
              Fails(absl::StatusCode::kInvalidArgument, "clip.skeleton"));
}

TEST_F(ClipCallsTest, TracksComeRoundThroughTheOwnMessage) {
  const auto walk = CreateWalk(700);
  ASSERT_TRUE(walk.ok()) << walk.status();
  const Exported out = Export(walk->name(), v1::CLIP_FORMAT_UNSPECIFIED);
  ASSERT_EQ(out.status, absl::OkStatus());
  EXPECT_GT(out.message_count, 2) << "a long clip comes in pieces";
  v1::UploadClipRequest header;
  v1::Clip& clip = *header.mutable_header()->mutable_clip();
  clip.set_skeleton(walk->skeleton());
  clip.set_frame_time_s(walk->frame_time_s());
  std::vector<v1::UploadClipRequest> messages = {header};
  // Each track in two.
  for (const v1::JointTrack& track : out.clip.tracks()) {
    const int rows = track.values_size() / 700;
    for (int half : {0, 1}) {
      v1::JointTrack& part = *messages.emplace_back().add_tracks();
      part.set_joint_id(track.joint_id());
      part.set_part(track.part());
      part.set_interpolation(track.interpolation());
      for (int i = half * 350 * rows; i < (half + 1) * 350 * rows; ++i) {
        part.add_values(track.values(i));
      }
    }
  }
  const auto again = Upload(messages);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->duration_s(), walk->duration_s());
  const Exported back = Export(again->name(), v1::CLIP_FORMAT_UNSPECIFIED);
  ASSERT_EQ(back.clip.tracks_size(), out.clip.tracks_size());
  for (int i = 0; i < out.clip.tracks_size(); ++i) {
    EXPECT_EQ(back.clip.tracks(i).SerializeAsString(),
              out.clip.tracks(i).SerializeAsString());
  }
}

TEST_F(ClipCallsTest, AGlbComesRound) {
  const auto walk = CreateWalk(40);
  ASSERT_TRUE(walk.ok()) << walk.status();
  const Exported glb = Export(walk->name(), v1::CLIP_FORMAT_GLB);
  ASSERT_EQ(glb.status, absl::OkStatus());
  ASSERT_THAT(glb.data, StartsWith("glTF"));
  v1::UploadClipRequest piece;
  piece.mutable_header()->mutable_file()->set_format(v1::CLIP_FORMAT_GLTF);
  std::vector<v1::UploadClipRequest> pieces;
  constexpr size_t kPieceBytes = 4096;
  for (size_t at = 0; at < glb.data.size(); at += kPieceBytes) {
    piece.set_data(glb.data.substr(at, kPieceBytes));
    pieces.push_back(piece);
    piece.clear_header();
  }
  const auto again = Upload(pieces);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_NEAR(again->duration_s(), walk->duration_s(), 1e-6);
  pieces[0].mutable_header()->mutable_file()->set_animation_index(1);
  EXPECT_THAT(Upload(pieces).status(),
              Fails(absl::StatusCode::kInvalidArgument,
                    "file.animation_index: want 0 to 0, got 1"));
}

TEST_F(ClipCallsTest, EditsMakeRevisionsAndUndoIsAnOlderOne) {
  const auto clip = CreateStill();
  ASSERT_TRUE(clip.ok()) << clip.status();
  v1::EditKeyframesRequest request = Edit(clip->name());
  AddKey(0, 0.5, &request);
  AddKey(1, 1.5, &request);
  const auto second = Call(&Stub::EditKeyframes, request);
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_EQ(second->revision(), 2);
  EXPECT_EQ(second->duration_s(), 1);
  request = Edit(clip->name());
  v1::MoveKey* move = request.add_edits()->mutable_move_key();
  move->set_joint_id("j0");
  move->set_from_s(1);
  move->set_to_s(3);
  v1::DeleteKey* drop = request.add_edits()->mutable_delete_key();
  drop->set_joint_id("j0");
  drop->set_time_s(0);
  const auto third = Call(&Stub::EditKeyframes, request);
  ASSERT_TRUE(third.ok()) << third.status();
  EXPECT_EQ(third->duration_s(), 3);
  EXPECT_THAT(Values(clip->name()), ElementsAre(1.5));
  EXPECT_THAT(Values(clip->name() + "@2"), ElementsAre(0.5, 1.5));
  const auto undone = Call(&Stub::EditKeyframes, Edit(clip->name() + "@2"));
  ASSERT_TRUE(undone.ok()) << undone.status();
  EXPECT_EQ(undone->revision(), 4);
  EXPECT_EQ(undone->oldest_revision(), 1);
  EXPECT_THAT(Values(clip->name()), ElementsAre(0.5, 1.5));
}

TEST_F(ClipCallsTest, ABadEditChangesNothing) {
  const auto clip = CreateStill();
  ASSERT_TRUE(clip.ok()) << clip.status();
  v1::EditKeyframesRequest request = Edit(clip->name());
  AddKey(0, 0.5, &request);
  request.add_edits()->mutable_delete_key()->set_joint_id("tail");
  EXPECT_THAT(Call(&Stub::EditKeyframes, request).status(),
              Fails(absl::StatusCode::kInvalidArgument,
                    "edits[1].delete_key.joint_id: no joint \"tail\""));
  EXPECT_EQ(Get(clip->name())->revision(), 1);
  request = Edit(clip->name());
  AddKey(-1, 0.5, &request);
  EXPECT_THAT(
      Call(&Stub::EditKeyframes, request).status(),
      Fails(absl::StatusCode::kInvalidArgument, "edits[0].insert_key: time_s"));
  request.clear_edits();
  request.add_edits();
  EXPECT_THAT(Call(&Stub::EditKeyframes, request).status(),
              Fails(absl::StatusCode::kInvalidArgument, "edits[0]"));
  for (int i = 0; i < 128; ++i) request.add_edits();
  EXPECT_THAT(Call(&Stub::EditKeyframes, request).status(),
              Fails(absl::StatusCode::kInvalidArgument, "at most 128"));
  EXPECT_EQ(Get(clip->name())->revision(), 1);
}

TEST_F(ClipCallsTest, StopMotionCapturesASessionFrameByFrame) {
  const auto clip = CreateStill();
  ASSERT_TRUE(clip.ok()) << clip.status();
  const std::string session = CreateSession();
  for (int i = 0; i < 3; ++i) {
    v1::UpdateSessionRequest pose;
    pose.mutable_session()->set_name(session);
    for (double angle : {0.1 * i, 0.2, 0.3}) {
      pose.mutable_session()->mutable_pose()->add_positions(angle);
    }
    ASSERT_TRUE(Call(&v1::SessionService::Stub::UpdateSession, pose).ok());
    v1::EditKeyframesRequest request = Edit(clip->name());
    v1::CapturePose* capture = request.add_edits()->mutable_capture_pose();
    capture->set_time_s(i / 12.0);
    capture->set_session(session);
    capture->set_interpolation(v1::INTERPOLATION_STEP);
    const auto revised = Call(&Stub::EditKeyframes, request);
    ASSERT_TRUE(revised.ok()) << revised.status();
    EXPECT_EQ(revised->track_count(), 3);
  }
  EXPECT_THAT(Values(clip->name()), ElementsAre(0, 0.1, 0.2));
  const auto walk = CreateWalk(10);
  v1::EditKeyframesRequest request = Edit(walk->name());
  request.add_edits()->mutable_capture_pose()->set_session(session);
  EXPECT_THAT(Call(&Stub::EditKeyframes, request).status(),
              Fails(absl::StatusCode::kFailedPrecondition,
                    "another skeleton than the clip's"));
}

TEST_F(ClipCallsTest, RepeatedRequestsAnswerTheFirstResult) {
  v1::CreateClipRequest create;
  create.set_request_id("once");
  create.mutable_file()->set_format(v1::CLIP_FORMAT_BVH);
  create.mutable_file()->set_data(testing::WalkingBvh(10));
  const auto first = Call(&Stub::CreateClip, create);
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_EQ(Call(&Stub::CreateClip, create)->name(), first->name());
  v1::EditKeyframesRequest edit = Edit(first->name());
  edit.set_request_id("once more");
  EXPECT_EQ(Call(&Stub::EditKeyframes, edit)->revision(), 2);
  EXPECT_EQ(Call(&Stub::EditKeyframes, edit)->revision(), 2);
  EXPECT_EQ(Get(first->name())->newest_revision(), 2);
}

TEST_F(ClipCallsTest, ListsInPages) {
  std::vector<std::string> names;
  for (const char* id : {"aaaa-1", "aaaa-2", "aaaa-3"}) {
    ASSERT_TRUE(CreateWalk(5, "", id).ok());
  }
  v1::ListClipsRequest request;
  request.set_page_size(2);
  request.set_page_token("clips/aaaa");
  const auto page = Call(&Stub::ListClips, request);
  ASSERT_TRUE(page.ok()) << page.status();
  for (const v1::Clip& clip : page->clips()) names.push_back(clip.name());
  EXPECT_THAT(names, ElementsAre("clips/aaaa-1", "clips/aaaa-2"));
  request.set_page_token(page->next_page_token());
  EXPECT_EQ(Call(&Stub::ListClips, request)->clips(0).name(), "clips/aaaa-3");
}

TEST_F(ClipCallsTest, BadRequestsAreNamed) {
  v1::CreateClipRequest create;
  create.set_clip_id("X");
  EXPECT_THAT(Call(&Stub::CreateClip, create).status(),
              Fails(absl::StatusCode::kInvalidArgument, "clip_id"));
  create.set_clip_id("");
  EXPECT_THAT(Call(&Stub::CreateClip, create).status(),
              Fails(absl::StatusCode::kInvalidArgument, "clip.skeleton"));
  create.mutable_clip()->set_skeleton("skeletons/planar-arm");
  create.mutable_clip()->add_tracks()->set_joint_id("j9");
  EXPECT_THAT(Call(&Stub::CreateClip, create).status(),
              Fails(absl::StatusCode::kInvalidArgument,
                    "clip.tracks[0].joint_id: no joint \"j9\""));
  v1::JointTrack* track = create.mutable_clip()->mutable_tracks(0);
  track->set_joint_id("j0");
  for (double time_s : {0., 1., 1.}) track->add_times_s(time_s);
  for (int i = 0; i < 3; ++i) track->add_values(0);
  EXPECT_THAT(
      Call(&Stub::CreateClip, create).status(),
      Fails(absl::StatusCode::kInvalidArgument, "clip.tracks[0].times_s[2]"));
  create.mutable_file()->set_format(v1::CLIP_FORMAT_BVH);
  EXPECT_THAT(Call(&Stub::CreateClip, create).status(),
              Fails(absl::StatusCode::kInvalidArgument, "clip.tracks"));
  create.mutable_clip()->clear_tracks();
  create.mutable_file()->set_data("HIERARCHY\nROOT");
  EXPECT_THAT(Call(&Stub::CreateClip, create).status(),
              Fails(absl::StatusCode::kInvalidArgument, "line 2"));
  create.mutable_file()->set_format(v1::CLIP_FORMAT_UNSPECIFIED);
  EXPECT_THAT(Call(&Stub::CreateClip, create).status(),
              Fails(absl::StatusCode::kInvalidArgument, "file.format"));
  EXPECT_THAT(Get("clips/nobody").status(),
              Fails(absl::StatusCode::kNotFound, "clips/nobody"));
  EXPECT_THAT(Get("clips/some@one").status(),
              Fails(absl::StatusCode::kInvalidArgument, "name"));
  EXPECT_THAT(Export("clips/nobody", v1::CLIP_FORMAT_BVH).status,
              Fails(absl::StatusCode::kNotFound, "clips/nobody"));
  const auto still = CreateStill();
  EXPECT_THAT(
      Export(still->name(), static_cast<v1::ClipFormat>(9)).status,
      Fails(absl::StatusCode::kInvalidArgument, "format: no such format: 9"));
}

TEST_F(ClipCallsTest, UploadsWantAHeaderFirst) {
  EXPECT_THAT(Upload({}).status(),
              Fails(absl::StatusCode::kInvalidArgument, "header"));
  v1::UploadClipRequest data;
  data.set_data("HIERARCHY");
  EXPECT_THAT(Upload({data}).status(),
              Fails(absl::StatusCode::kInvalidArgument, "header"));
  v1::UploadClipRequest header;
  header.mutable_header();
  EXPECT_THAT(Upload({header, data}).status(),
              Fails(absl::StatusCode::kInvalidArgument, "header.file"));
  EXPECT_THAT(Upload({header, header}).status(),
              Fails(absl::StatusCode::kInvalidArgument, "header"));
}

class ClipLimitsTest : public ClipServiceTest {
 protected:
  static void SetUpTestSuite() {
    StartServer({"--max-clips", "2", "--max-clip-numbers", "5000",
                 "--max-clip-revisions", "2"});
  }
};

TEST_F(ClipLimitsTest, NoMoreThanTheServerWants) {
  EXPECT_THAT(CreateWalk(200).status(),
              Fails(absl::StatusCode::kInvalidArgument, ""));
  const auto first = CreateWalk(5);
  ASSERT_TRUE(first.ok()) << first.status();
  ASSERT_TRUE(CreateWalk(5).ok());
  EXPECT_THAT(CreateWalk(5).status(),
              Fails(absl::StatusCode::kResourceExhausted, "2 clips are held"));
  v1::EditKeyframesRequest edit;
  edit.set_name(first->name());
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(Call(&Stub::EditKeyframes, edit).ok());
  }
  EXPECT_THAT(Get(first->name() + "@1").status(),
              Fails(absl::StatusCode::kNotFound, "2 to 3 are kept"));
}

TEST_F(ClipLimitsTest, ASparseClipIsNotSampledBeyondThem) {
  v1::DeleteClipRequest drop;
  const auto list = Call(&Stub::ListClips, v1::ListClipsRequest());
  ASSERT_TRUE(list.ok()) << list.status();
  for (const v1::Clip& clip : list->clips()) {
    drop.set_name(clip.name());
    ASSERT_TRUE(Call(&Stub::DeleteClip, drop).ok());
  }
  const auto still = CreateStill();
  ASSERT_TRUE(still.ok()) << still.status();
  v1::EditKeyframesRequest edit;
  edit.set_name(still->name());
  v1::InsertKey* key = edit.add_edits()->mutable_insert_key();
  key->set_joint_id("j0");
  key->set_time_s(1e6);
  key->add_values(1);
  ASSERT_TRUE(Call(&Stub::EditKeyframes, edit).ok());
  EXPECT_THAT(Export(still->name(), v1::CLIP_FORMAT_BVH).status,
              Fails(absl::StatusCode::kInvalidArgument,
                    "are more than the 5000 that a clip may have"));
}

}  // namespace
}  // namespace gelenk

// A real gelenkd for tests about clips.
#ifndef GELENK_TESTS_INTEGRATION_CLIP_SERVICE_TEST_H_
#define GELENK_TESTS_INTEGRATION_CLIP_SERVICE_TEST_H_

#include <string>
#include <utility>
#include <vector>

#include "gelenk/client/status.h"
#include "tests/integration/service_test.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk {

class ClipServiceTest : public ServiceTest {
 protected:
  using Stub = v1::MotionService::Stub;

  // All that ExportClip sends.
  struct Exported {
    v1::Clip clip;
    std::string data;
    int message_count = 0;
    absl::Status status;
  };

  // A walk from BVH, on a skeleton of its own or on one that is there.
  static absl::StatusOr<v1::Clip> CreateWalk(int frames = 100,
                                             const std::string& skeleton = "",
                                             const std::string& id = "") {
    v1::CreateClipRequest request;
    request.set_clip_id(id);
    request.mutable_clip()->set_display_name("walk");
    request.mutable_clip()->set_skeleton(skeleton);
    request.mutable_file()->set_format(v1::CLIP_FORMAT_BVH);
    request.mutable_file()->set_data(testing::WalkingBvh(frames));
    return Call(&Stub::CreateClip, request);
  }

  // A walk behind a T-pose that is no part of it.
  static absl::StatusOr<v1::Clip> CreateWalkBehindATPose(int frames) {
    v1::CreateClipRequest request;
    request.mutable_file()->set_format(v1::CLIP_FORMAT_BVH);
    request.mutable_file()->set_data(testing::WalkingBvhBehindATPose(frames));
    return Call(&Stub::CreateClip, request);
  }

  // An empty clip of the planar arm.
  static absl::StatusOr<v1::Clip> CreateStill() {
    v1::CreateClipRequest request;
    request.mutable_clip()->set_skeleton("skeletons/planar-arm");
    return Call(&Stub::CreateClip, request);
  }

  static absl::StatusOr<v1::Clip> Get(const std::string& name) {
    v1::GetClipRequest request;
    request.set_name(name);
    return Call(&Stub::GetClip, request);
  }

  // Pieces of tracks are put together again.
  static Exported Export(const std::string& name, v1::ClipFormat format) {
    grpc::ClientContext context;
    client::CallOptions options;
    options.timeout = testing::kPatience;
    connection().Prepare(options, context);
    v1::ExportClipRequest request;
    request.set_name(name);
    request.set_format(format);
    const auto reader = connection().motion().ExportClip(&context, request);
    Exported exported;
    v1::ExportClipResponse response;
    while (reader->Read(&response)) {
      if (exported.message_count++ == 0) exported.clip = response.clip();
      exported.data += response.data();
      for (const v1::JointTrack& track : response.tracks()) {
        AppendTrack(track, &exported.clip);
      }
    }
    exported.status = client::FromGrpc(reader->Finish());
    return exported;
  }

  // Sends `messages` and takes the answer.
  static absl::StatusOr<v1::Clip> Upload(
      const std::vector<v1::UploadClipRequest>& messages) {
    grpc::ClientContext context;
    client::CallOptions options;
    options.timeout = testing::kPatience;
    connection().Prepare(options, context);
    v1::Clip clip;
    const auto writer = connection().motion().UploadClip(&context, &clip);
    for (const v1::UploadClipRequest& message : messages) {
      // A server that has heard enough ends the call.
      if (!writer->Write(message)) break;
    }
    writer->WritesDone();
    const grpc::Status status = writer->Finish();
    if (!status.ok()) return client::FromGrpc(status);
    return clip;
  }

 private:
  static void AppendTrack(const v1::JointTrack& track, v1::Clip* clip) {
    auto* tracks = clip->mutable_tracks();
    if (!tracks->empty()) {
      v1::JointTrack* last = tracks->Mutable(tracks->size() - 1);
      if (last->joint_id() == track.joint_id() &&
          last->part() == track.part()) {
        last->mutable_times_s()->MergeFrom(track.times_s());
        last->mutable_values()->MergeFrom(track.values());
        return;
      }
    }
    *tracks->Add() = track;
  }
};

}  // namespace gelenk

#endif  // GELENK_TESTS_INTEGRATION_CLIP_SERVICE_TEST_H_

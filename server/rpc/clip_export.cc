#include "server/rpc/clip_export.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "convert/joint_track.h"
#include "gelenk/base/violations.h"
#include "gelenk/formats/bvh_clip.h"
#include "gelenk/formats/bvh_writer.h"
#include "gelenk/import/gltf_writer.h"
#include "server/rpc/clip_message.h"
#include "server/rpc/production_call.h"

namespace gelenk::server {
namespace {

using ClipProduction = Production<v1::ExportClipResponse>;

// Of one message: far below any limit, far above what a message costs.
constexpr size_t kPieceBytes = size_t{256} << 10;

absl::StatusOr<std::string> BvhText(const StoredClip& stored) {
  constexpr double kCentimetre = 0.01;
  const absl::StatusOr<BvhDocument> document =
      stored.form != nullptr
          ? BvhFromClip(stored.form->document, stored.form->import, stored.clip)
          : BvhFromClip(stored.clip, kCentimetre);
  if (!document.ok()) return document.status();
  return WriteBvh(*document);
}

absl::StatusOr<std::string> FileOf(const StoredClip& stored,
                                   v1::ClipFormat format,
                                   const Limits& limits) {
  // Formats that sample the clip.
  if (absl::Status status = CheckFrameCount("name", stored.clip, limits);
      !status.ok()) {
    return status;
  }
  switch (format) {
    case v1::CLIP_FORMAT_BVH:
      return BvhText(stored);
    case v1::CLIP_FORMAT_GLTF:
      return WriteGltf(stored.clip, GltfForm::kJson);
    case v1::CLIP_FORMAT_GLB:
      return WriteGltf(stored.clip, GltfForm::kBinary);
    default:
      break;
  }
  Violations violations;
  violations.Add("format",
                 absl::StrCat("no such format: ", static_cast<int>(format)));
  return violations.ToStatus();
}

class FileProduction final : public ClipProduction {
 public:
  FileProduction(const StoredClip& stored, std::string file)
      : file_(std::move(file)) {
    ToProto(stored, &clip_);
  }

  absl::StatusOr<bool> Next(IkSolver&,
                            v1::ExportClipResponse* response) override {
    if (sent_ == file_.size()) return false;
    if (sent_ == 0) response->mutable_clip()->Swap(&clip_);
    response->set_data(file_.substr(sent_, kPieceBytes));
    sent_ += response->data().size();
    return true;
  }

 private:
  v1::Clip clip_;
  const std::string file_;
  size_t sent_ = 0;
};

class TrackProduction final : public ClipProduction {
 public:
  explicit TrackProduction(StoredClip stored) : stored_(std::move(stored)) {}

  absl::StatusOr<bool> Next(IkSolver&,
                            v1::ExportClipResponse* response) override {
    if (!said_clip_) {
      said_clip_ = true;
      ToProto(stored_, response->mutable_clip());
      return true;
    }
    const MotionClip& clip = stored_.clip;
    if (track_ == clip.track_count()) return false;
    size_t left = kPieceBytes;
    while (track_ < clip.track_count() && left > 0) {
      const JointTrack& track = clip.track(track_);
      const size_t key_bytes =
          sizeof(double) * (1 + track.values.rows() + track.in_tangents.rows() +
                            track.out_tangents.rows());
      const int fitting =
          static_cast<int>(std::max<size_t>(1, left / key_bytes));
      const int count = std::min(track.key_count() - key_, fitting);
      convert::ToProto(*clip.skeleton(), clip.properties().frame_time_s, track,
                       key_, count, response->add_tracks());
      left -= std::min(left, count * key_bytes);
      key_ += count;
      if (key_ < track.key_count()) continue;
      key_ = 0;
      ++track_;
    }
    return true;
  }

 private:
  const StoredClip stored_;
  bool said_clip_ = false;
  // Where the next piece begins.
  int track_ = 0;
  int key_ = 0;
};

}  // namespace

void ServeClipExports(v1::MotionService::AsyncService* service,
                      ServiceState* state, IoThread* thread) {
  using Opened = absl::StatusOr<std::unique_ptr<ClipProduction>>;
  ServeProduction(
      service, &v1::MotionService::AsyncService::RequestExportClip,
      [state](const v1::ExportClipRequest& request) -> Opened {
        absl::StatusOr<StoredClip> stored =
            FindClip(*state, "name", request.name());
        if (!stored.ok()) return stored.status();
        if (request.format() == v1::CLIP_FORMAT_UNSPECIFIED) {
          return std::make_unique<TrackProduction>(*std::move(stored));
        }
        absl::StatusOr<std::string> file =
            FileOf(*stored, request.format(), state->options.limits);
        if (!file.ok()) return file.status();
        return std::make_unique<FileProduction>(*stored, *std::move(file));
      },
      state, thread);
}

}  // namespace gelenk::server

#include "server/rpc/clip_upload.h"

#include <memory>
#include <utility>

#include "server/rpc/clip_creation.h"
#include "server/rpc/clip_message.h"
#include "server/rpc/piece_check.h"
#include "server/rpc/upload_call.h"

namespace gelenk::server {
namespace {

using Numbers = google::protobuf::RepeatedField<double>;

// `track` goes on with the keys of `more`, which is of the same part.
void Continue(const v1::JointTrack& more, v1::JointTrack* track) {
  const auto append = [](const Numbers& from, Numbers* to) {
    to->MergeFrom(from);
  };
  append(more.times_s(), track->mutable_times_s());
  append(more.values(), track->mutable_values());
  append(more.in_tangents(), track->mutable_in_tangents());
  append(more.out_tangents(), track->mutable_out_tangents());
}

class ClipUpload final : public Upload<v1::UploadClipRequest, v1::Clip> {
 public:
  explicit ClipUpload(ServiceState* state) : state_(state) {}

  absl::Status Take(v1::UploadClipRequest& piece) override {
    if (absl::Status status =
            CheckHeaderComesFirst(piece.has_header(), !has_header_);
        !status.ok()) {
      return status;
    }
    if (piece.has_header()) {
      has_header_ = true;
      request_.Swap(piece.mutable_header());
    } else if (piece.data().empty() && piece.tracks_size() == 0) {
      return MalformedPiece("data", "a piece holds nothing");
    }
    if (!piece.data().empty() && !request_.has_file()) {
      return MalformedPiece("header.file", "unset, but data came");
    }
    bytes_ += static_cast<int64_t>(piece.ByteSizeLong());
    if (absl::Status status = CheckUploadSize(
            "data", bytes_, state_->options.limits.max_import_bytes);
        !status.ok()) {
      return status;
    }
    if (!piece.data().empty()) {
      request_.mutable_file()->mutable_data()->append(piece.data());
    }
    for (v1::JointTrack& track : *piece.mutable_tracks()) Append(track);
    return absl::OkStatus();
  }

  absl::Status Complete(const std::function<bool()>& is_cancelled,
                        v1::Clip* response) override {
    if (!has_header_) {
      return MalformedPiece("header", "the first message must hold it");
    }
    const absl::StatusOr<StoredClip> stored =
        CreateClip(*state_, request_, is_cancelled);
    if (!stored.ok()) return stored.status();
    ToProto(*stored, response);
    return absl::OkStatus();
  }

 private:
  void Append(v1::JointTrack& track) {
    auto* tracks = request_.mutable_clip()->mutable_tracks();
    v1::JointTrack* last =
        tracks->empty() ? nullptr : tracks->Mutable(tracks->size() - 1);
    if (last != nullptr && last->joint_id() == track.joint_id() &&
        last->part() == track.part()) {
      Continue(track, last);
    } else {
      tracks->Add()->Swap(&track);
    }
  }

  ServiceState* const state_;
  bool has_header_ = false;
  // Grows with the pieces; `bytes_` counts them.
  v1::CreateClipRequest request_;
  int64_t bytes_ = 0;
};

}  // namespace

void ServeClipUploads(v1::MotionService::AsyncService* service,
                      ServiceState* state, IoThread* thread) {
  ServeUpload(
      service, &v1::MotionService::AsyncService::RequestUploadClip,
      [state] { return std::make_unique<ClipUpload>(state); }, state, thread);
}

}  // namespace gelenk::server

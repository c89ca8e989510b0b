#include "server/rpc/deform_skin_method.h"

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "server/rpc/production_call.h"
#include "server/rpc/skin_frames.h"
#include "server/rpc/skin_message.h"
#include "server/rpc/skin_poses.h"

namespace gelenk::server {
namespace {

using Service = v1::SkinService::AsyncService;

struct Frames {
  std::vector<PosedActor> actors;
  // Of the first.
  int64_t sequence_number = 0;
};

absl::StatusOr<Frames> ReadFrames(const ServiceState& state,
                                  const StoredSkin& skin,
                                  const v1::DeformSkinRequest& request) {
  const bool has_session = !request.session().empty();
  if (has_session == (request.poses_size() > 0)) {
    Violations violations;
    violations.Add("poses", absl::StrCat("want some, or a session, got ",
                                         has_session ? "both" : "neither"));
    return violations.ToStatus();
  }
  Frames frames;
  if (!has_session) {
    absl::StatusOr<std::vector<PosedActor>> actors =
        ReadPoses(skin.revision.skin->skeleton(), request.poses(),
                  state.options.limits.max_poses_per_call);
    if (!actors.ok()) return actors.status();
    frames.actors = *std::move(actors);
    return frames;
  }
  absl::StatusOr<std::shared_ptr<Session>> session =
      FindSessionOf(state, skin, "session", request.session());
  if (!session.ok()) return session.status();
  PosedActor& actor = frames.actors.emplace_back();
  uint64_t version = ~uint64_t{0};
  (*session)->CopyIfNewer(version, actor.positions, actor.world_from_skeleton,
                          frames.sequence_number);
  return frames;
}

class DeformSkin final : public Production<v1::DeformSkinResponse> {
 public:
  DeformSkin(std::unique_ptr<SkinFrames> encoder, Frames frames,
             bool include_layout)
      : encoder_(std::move(encoder)),
        frames_(std::move(frames)),
        layout_due_(include_layout) {}

  absl::StatusOr<bool> Next(IkSolver&,
                            v1::DeformSkinResponse* response) override {
    if (layout_due_) {
      layout_due_ = false;
      encoder_->FillLayout(response->mutable_layout());
      return true;
    }
    if (next_ == frames_.actors.size()) return false;
    v1::SkinFrame* frame = response->mutable_frame();
    frame->set_sequence_number(frames_.sequence_number +
                               static_cast<int64_t>(next_));
    const PosedActor& actor = frames_.actors[next_++];
    encoder_->Deform(actor.positions, actor.world_from_skeleton, frame);
    return true;
  }

 private:
  const std::unique_ptr<SkinFrames> encoder_;
  const Frames frames_;
  size_t next_ = 0;
  bool layout_due_;
};

absl::StatusOr<std::unique_ptr<Production<v1::DeformSkinResponse>>> Open(
    ServiceState& state, const v1::DeformSkinRequest& request) {
  absl::StatusOr<StoredSkin> stored = FindSkin(state, "name", request.name());
  if (!stored.ok()) return stored.status();
  absl::StatusOr<Frames> frames = ReadFrames(state, *stored, request);
  if (!frames.ok()) return frames.status();
  absl::StatusOr<std::unique_ptr<SkinFrames>> encoder =
      SkinFrames::Create(*std::move(stored),
                         {request.encoding(), request.keyframe_interval(),
                          request.include_warnings()},
                         state.PartRunner());
  if (!encoder.ok()) return encoder.status();
  return std::make_unique<DeformSkin>(*std::move(encoder), *std::move(frames),
                                      request.include_layout());
}

}  // namespace

void ServeDeformSkin(Service* service, ServiceState* state, IoThread* thread) {
  ServeProduction(
      service, &Service::RequestDeformSkin,
      [state](const v1::DeformSkinRequest& request) {
        return Open(*state, request);
      },
      state, thread);
}

}  // namespace gelenk::server

#include "server/rpc/export_skin_method.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "convert/duration.h"
#include "gelenk/base/violations.h"
#include "gelenk/import/gltf_skin_writer.h"
#include "server/rpc/production_call.h"
#include "server/rpc/skin_building.h"
#include "server/rpc/skin_message.h"
#include "server/rpc/skin_poses.h"

namespace gelenk::server {
namespace {

using Service = v1::SkinService::AsyncService;

// Bytes of one message.
constexpr size_t kPieceBytes = size_t{256} << 10;
constexpr double kDefaultFrameTimeS = 1.0 / 30;

class ExportSkin final : public Production<v1::ExportSkinResponse> {
 public:
  explicit ExportSkin(GltfSkinFile file) : file_(std::move(file)) {}

  absl::StatusOr<bool> Next(IkSolver&,
                            v1::ExportSkinResponse* response) override {
    if (next_ >= file_.bytes.size()) return false;
    if (next_ == 0) {
      response->set_inexact_vertex_count(file_.inexact_vertex_count);
    }
    response->set_data(file_.bytes.substr(next_, kPieceBytes));
    next_ += kPieceBytes;
    return true;
  }

 private:
  const GltfSkinFile file_;
  size_t next_ = 0;
};

absl::StatusOr<double> FrameTime(const v1::ExportSkinRequest& request) {
  if (!request.has_frame_time()) return kDefaultFrameTimeS;
  const absl::Duration time = convert::FromProto(request.frame_time());
  if (time > absl::ZeroDuration()) return absl::ToDoubleSeconds(time);
  Violations violations;
  violations.Add("frame_time", absl::StrCat("want more than 0, got ",
                                            absl::FormatDuration(time)));
  return violations.ToStatus();
}

absl::StatusOr<std::unique_ptr<Production<v1::ExportSkinResponse>>> Open(
    const ServiceState& state, const v1::ExportSkinRequest& request) {
  absl::StatusOr<StoredSkin> stored = FindSkin(state, "name", request.name());
  if (!stored.ok()) return stored.status();
  const LayeredSkin* layered = AsLayered(*stored->revision.skin);
  if (layered == nullptr) {
    return absl::FailedPreconditionError(
        absl::StrCat("name: ", stored->name, " is no mesh in layered volumes"));
  }
  absl::StatusOr<std::vector<PosedActor>> actors =
      ReadPoses(layered->skeleton(), request.poses(),
                state.options.limits.max_poses_per_call);
  if (!actors.ok()) return actors.status();
  const absl::StatusOr<double> frame_time_s = FrameTime(request);
  if (!frame_time_s.ok()) return frame_time_s.status();
  std::vector<SkinKey> keys;
  for (PosedActor& actor : *actors) {
    keys.push_back({std::move(actor.positions), actor.world_from_skeleton});
  }
  return std::make_unique<ExportSkin>(
      WriteGltfSkin(*layered, keys, *frame_time_s, GltfForm::kBinary));
}

}  // namespace

void ServeExportSkin(Service* service, ServiceState* state, IoThread* thread) {
  ServeProduction(
      service, &Service::RequestExportSkin,
      [state](const v1::ExportSkinRequest& request) {
        return Open(*state, request);
      },
      state, thread);
}

}  // namespace gelenk::server

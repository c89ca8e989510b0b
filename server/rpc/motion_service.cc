#include "server/rpc/motion_service.h"

#include <string>
#include <utility>
#include <vector>

#include "gelenk/base/violations.h"
#include "server/rpc/body_methods.h"
#include "server/rpc/clip_creation.h"
#include "server/rpc/clip_export.h"
#include "server/rpc/clip_message.h"
#include "server/rpc/clip_upload.h"
#include "server/rpc/keyframe_method.h"
#include "server/rpc/page.h"
#include "server/rpc/play_method.h"
#include "server/rpc/process_method.h"
#include "server/rpc/recording_methods.h"
#include "server/rpc/unary_call.h"

namespace gelenk::server {
namespace {

using Service = v1::MotionService::AsyncService;

absl::Status CreateClip(ServiceState& state,
                        const v1::CreateClipRequest& request,
                        v1::Clip* response) {
  const absl::StatusOr<StoredClip> stored =
      CreateClip(state, request, [] { return false; });
  if (!stored.ok()) return stored.status();
  ToProto(*stored, response);
  return absl::OkStatus();
}

absl::Status GetClip(const ServiceState& state,
                     const v1::GetClipRequest& request, v1::Clip* response) {
  const absl::StatusOr<StoredClip> stored =
      FindClip(state, "name", request.name());
  if (!stored.ok()) return stored.status();
  ToProto(*stored, response);
  return absl::OkStatus();
}

absl::Status ListClips(const ServiceState& state,
                       const v1::ListClipsRequest& request,
                       v1::ListClipsResponse* response) {
  const absl::StatusOr<size_t> size = PageSize(request.page_size());
  if (!size.ok()) return size.status();
  std::vector<StoredClip> page =
      state.clips.List(kDefaultTenant, request.page_token(), *size + 1);
  response->set_next_page_token(TakeNextPageToken(
      *size, page, [](const StoredClip& stored) { return stored.name; }));
  for (const StoredClip& stored : page) ToProto(stored, response->add_clips());
  return absl::OkStatus();
}

absl::Status DeleteClip(ServiceState& state,
                        const v1::DeleteClipRequest& request) {
  absl::Status status = CheckResourceName("name", kClips, request.name());
  if (!status.ok()) return status;
  status = state.clips.Delete(kDefaultTenant, request.name());
  if (request.allow_missing() && absl::IsNotFound(status)) {
    return absl::OkStatus();
  }
  return status;
}

}  // namespace

void ServeMotion(Service* service, ServiceState* state, IoThread* thread) {
  ServeUnary(
      service, &Service::RequestCreateClip,
      [state](IkSolver&, const v1::CreateClipRequest& request,
              v1::Clip* response) {
        return CreateClip(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestGetClip,
      [state](IkSolver&, const v1::GetClipRequest& request,
              v1::Clip* response) {
        return GetClip(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestListClips,
      [state](IkSolver&, const v1::ListClipsRequest& request,
              v1::ListClipsResponse* response) {
        return ListClips(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestDeleteClip,
      [state](IkSolver&, const v1::DeleteClipRequest& request,
              google::protobuf::Empty*) { return DeleteClip(*state, request); },
      state, thread);
  ServeUnary(
      service, &Service::RequestEditKeyframes,
      [state](IkSolver&, const v1::EditKeyframesRequest& request,
              v1::Clip* response) {
        return EditKeyframes(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestProcessClip,
      [state](IkSolver&, const v1::ProcessClipRequest& request,
              v1::Clip* response) {
        return ProcessClip(*state, request, response);
      },
      state, thread);
  ServeBodies(service, state, thread);
  ServePlayClips(service, state, thread);
  ServeRecordings(service, state, thread);
  ServeClipUploads(service, state, thread);
  ServeClipExports(service, state, thread);
}

}  // namespace gelenk::server

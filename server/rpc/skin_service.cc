#include "server/rpc/skin_service.h"

#include <vector>

#include "server/rpc/deform_skin_method.h"
#include "server/rpc/export_skin_method.h"
#include "server/rpc/page.h"
#include "server/rpc/skin_creation.h"
#include "server/rpc/skin_edit_methods.h"
#include "server/rpc/skin_message.h"
#include "server/rpc/skin_upload.h"
#include "server/rpc/unary_call.h"
#include "server/rpc/watch_skin_call.h"

namespace gelenk::server {
namespace {

using Service = v1::SkinService::AsyncService;

absl::Status GetSkin(const ServiceState& state,
                     const v1::GetSkinRequest& request, v1::Skin* response) {
  absl::StatusOr<StoredSkin> stored = FindSkin(state, "name", request.name());
  if (!stored.ok()) return stored.status();
  ToProto(*stored, response);
  return absl::OkStatus();
}

absl::Status ListSkins(const ServiceState& state,
                       const v1::ListSkinsRequest& request,
                       v1::ListSkinsResponse* response) {
  absl::StatusOr<size_t> size = PageSize(request.page_size());
  if (!size.ok()) return size.status();
  std::vector<StoredSkin> page =
      state.skins.List(kDefaultTenant, request.page_token(), *size + 1);
  response->set_next_page_token(TakeNextPageToken(
      *size, page, [](const StoredSkin& stored) { return stored.name; }));
  for (const StoredSkin& stored : page) {
    ToProto(stored, response->add_skins());
  }
  return absl::OkStatus();
}

absl::Status DeleteSkin(ServiceState& state,
                        const v1::DeleteSkinRequest& request) {
  absl::Status status = CheckResourceName("name", kSkins, request.name());
  if (!status.ok()) return status;
  status = state.skins.Delete(kDefaultTenant, request.name());
  if (request.allow_missing() && absl::IsNotFound(status)) {
    return absl::OkStatus();
  }
  return status;
}

}  // namespace

void ServeSkins(Service* service, ServiceState* state, IoThread* thread) {
  ServeUnary(
      service, &Service::RequestCreateSkin,
      [state](IkSolver&, const v1::CreateSkinRequest& request,
              v1::Skin* response) {
        return CreateSkin(
            *state, request, [] { return false; }, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestGetSkin,
      [state](IkSolver&, const v1::GetSkinRequest& request,
              v1::Skin* response) {
        return GetSkin(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestListSkins,
      [state](IkSolver&, const v1::ListSkinsRequest& request,
              v1::ListSkinsResponse* response) {
        return ListSkins(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestDeleteSkin,
      [state](IkSolver&, const v1::DeleteSkinRequest& request,
              google::protobuf::Empty*) { return DeleteSkin(*state, request); },
      state, thread);
  ServeSkinUploads(service, state, thread);
  ServeSkinEdits(service, state, thread);
  ServeDeformSkin(service, state, thread);
  ServeExportSkin(service, state, thread);
  WatchSkinCall::Start(service, state, thread);
}

}  // namespace gelenk::server

// The skeleton that a request names.
#ifndef GELENK_SERVER_RPC_FIND_SKELETON_H_
#define GELENK_SERVER_RPC_FIND_SKELETON_H_

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "server/rpc/service_state.h"
#include "server/session/resource_name.h"

namespace gelenk::server {

// INVALID_ARGUMENT naming `field` when `name` is malformed, NOT_FOUND when
// there is none of that name.
inline absl::StatusOr<StoredSkeleton> FindSkeleton(const ServiceState& state,
                                                   absl::string_view field,
                                                   const std::string& name) {
  absl::Status status = CheckResourceName(field, kSkeletons, name);
  if (!status.ok()) return status;
  return state.skeletons.Find(kDefaultTenant, name);
}

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_FIND_SKELETON_H_

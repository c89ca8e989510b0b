// Names of resources: "skeletons/{id}", "sessions/{id}", "clips/{id}",
// "skins/{id}", unique in a tenant.
#ifndef GELENK_SERVER_SESSION_RESOURCE_NAME_H_
#define GELENK_SERVER_SESSION_RESOURCE_NAME_H_

#include <cstdint>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace gelenk::server {

// Owner of resources; there is one until there is authentication.
inline constexpr absl::string_view kDefaultTenant = "default";

// What registries and stores are keyed by: (tenant, name).
using ResourceKey = std::pair<std::string, std::string>;

inline constexpr absl::string_view kSkeletons = "skeletons";
inline constexpr absl::string_view kSessions = "sessions";
inline constexpr absl::string_view kClips = "clips";
inline constexpr absl::string_view kSkins = "skins";

// INVALID_ARGUMENT naming `field` unless `id` is [a-z][a-z0-9-]{3,62}.
absl::Status CheckResourceId(absl::string_view field, absl::string_view id);

// INVALID_ARGUMENT naming `field` unless `name` is "{collection}/{some id}".
absl::Status CheckResourceName(absl::string_view field,
                               absl::string_view collection,
                               absl::string_view name);

std::string ResourceName(absl::string_view collection, absl::string_view id);

// A fresh id from 64 random bits, for who did not choose one.
std::string MakeResourceId(absl::string_view prefix, uint64_t random);

// NOT_FOUND for `name`, the same for what never was, has expired, or belongs to
// another tenant.
absl::Status NoSuchResource(absl::string_view name);

// At most this many bytes of a request_id.
inline constexpr int kMaxRequestIdBytes = 64;
absl::Status CheckRequestId(absl::string_view request_id);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_RESOURCE_NAME_H_

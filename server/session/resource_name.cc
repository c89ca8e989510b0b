#include "server/session/resource_name.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"

namespace gelenk::server {
namespace {

constexpr size_t kMinIdBytes = 4;
constexpr size_t kMaxIdBytes = 63;

bool IsId(absl::string_view id) {
  if (id.size() < kMinIdBytes || id.size() > kMaxIdBytes) return false;
  if (!absl::ascii_islower(id[0])) return false;
  return std::all_of(id.begin(), id.end(), [](unsigned char c) {
    return absl::ascii_islower(c) || absl::ascii_isdigit(c) || c == '-';
  });
}

// What a client sent, short and printable.
std::string Shown(absl::string_view text) {
  return absl::StrCat("\"", absl::CHexEscape(text.substr(0, 80)), "\"");
}

absl::Status Malformed(absl::string_view field, absl::string_view description) {
  Violations violations;
  violations.Add(field, description);
  return violations.ToStatus();
}

}  // namespace

absl::Status CheckResourceId(absl::string_view field, absl::string_view id) {
  if (IsId(id)) return absl::OkStatus();
  return Malformed(field,
                   absl::StrCat("want [a-z][a-z0-9-]{3,62}, got ", Shown(id)));
}

absl::Status CheckResourceName(absl::string_view field,
                               absl::string_view collection,
                               absl::string_view name) {
  const bool has_prefix = absl::StartsWith(name, collection) &&
                          name.size() > collection.size() &&
                          name[collection.size()] == '/';
  if (has_prefix && IsId(name.substr(collection.size() + 1))) {
    return absl::OkStatus();
  }
  return Malformed(
      field, absl::StrCat("want ", collection, "/{id}, got ", Shown(name)));
}

std::string ResourceName(absl::string_view collection, absl::string_view id) {
  return absl::StrCat(collection, "/", id);
}

std::string MakeResourceId(absl::string_view prefix, uint64_t random) {
  return absl::StrFormat("%s-%016x", prefix, random);
}

absl::Status NoSuchResource(absl::string_view name) {
  return absl::NotFoundError(absl::StrCat("name: no ", Shown(name)));
}

absl::Status CheckRequestId(absl::string_view request_id) {
  if (request_id.size() <= kMaxRequestIdBytes) return absl::OkStatus();
  return Malformed("request_id",
                   absl::StrFormat("want at most %d bytes, got %d",
                                   kMaxRequestIdBytes, request_id.size()));
}

}  // namespace gelenk::server

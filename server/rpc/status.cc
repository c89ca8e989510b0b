#include "server/rpc/status.h"

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/internal/v1/error_details.pb.h"

namespace gelenk::server {
namespace {

constexpr char kBadRequestUrl[] = "type.googleapis.com/google.rpc.BadRequest";
// A status travels in the trailers, and clients refuse trailers of more than
// 8 KB altogether. On the way the message may grow threefold, the details by a
// third.
constexpr size_t kMaxMessageBytes = 800;
constexpr size_t kMaxViolationBytes = 2400;

// At most `most` bytes of `text`, no character cut in two.
std::string Shortened(absl::string_view text, size_t most) {
  if (text.size() <= most) return std::string(text);
  constexpr absl::string_view kMore = " ...";
  size_t end = most - kMore.size();
  const auto goes_on = [&] { return (text[end] & 0xC0) == 0x80; };
  while (end > 0 && goes_on()) --end;
  return absl::StrCat(text.substr(0, end), kMore);
}

internal::v1::BadRequest ToBadRequest(const std::vector<Violation>& list) {
  internal::v1::BadRequest bad_request;
  size_t left = kMaxViolationBytes;
  for (const Violation& violation : list) {
    const std::string field =
        Shortened(violation.field, kMaxViolationBytes / 2);
    const std::string description =
        Shortened(violation.description, kMaxViolationBytes / 2);
    const size_t bytes = field.size() + description.size();
    if (bytes > left) break;
    left -= bytes;
    auto* out = bad_request.add_field_violations();
    out->set_field(field);
    out->set_description(description);
  }
  return bad_request;
}

std::string Details(const absl::Status& status, const std::string& message,
                    const std::vector<Violation>& violations) {
  const internal::v1::BadRequest bad_request = ToBadRequest(violations);
  internal::v1::RpcStatus details;
  details.set_code(static_cast<int>(status.code()));
  details.set_message(message);
  google::protobuf::Any* any = details.add_details();
  any->set_type_url(kBadRequestUrl);
  any->set_value(bad_request.SerializeAsString());
  return details.SerializeAsString();
}

}  // namespace

grpc::Status ToGrpc(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  const auto code = static_cast<grpc::StatusCode>(status.code());
  const std::vector<Violation> violations = Violations::FromStatus(status);
  const std::string message = Shortened(status.message(), kMaxMessageBytes);
  if (violations.empty()) return grpc::Status(code, message);
  return grpc::Status(code, message, Details(status, message, violations));
}

void ToProto(const absl::Status& status, v1::FrameStatus* proto) {
  proto->set_code(static_cast<int>(status.code()));
  proto->set_message(std::string(status.message()));
}

}  // namespace gelenk::server

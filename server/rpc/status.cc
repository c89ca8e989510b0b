#include "server/rpc/status.h"

#include <string>
#include <vector>

#include "gelenk/base/violations.h"
#include "gelenk/internal/v1/error_details.pb.h"

namespace gelenk::server {
namespace {

constexpr char kBadRequestUrl[] = "type.googleapis.com/google.rpc.BadRequest";

std::string Details(const absl::Status& status,
                    const std::vector<Violation>& violations) {
  internal::v1::BadRequest bad_request;
  for (const Violation& violation : violations) {
    auto* out = bad_request.add_field_violations();
    out->set_field(violation.field);
    out->set_description(violation.description);
  }
  internal::v1::RpcStatus details;
  details.set_code(static_cast<int>(status.code()));
  details.set_message(std::string(status.message()));
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
  const std::string message(status.message());
  if (violations.empty()) return grpc::Status(code, message);
  return grpc::Status(code, message, Details(status, violations));
}

void ToProto(const absl::Status& status, v1::FrameStatus* proto) {
  proto->set_code(static_cast<int>(status.code()));
  proto->set_message(std::string(status.message()));
}

}  // namespace gelenk::server

#include "gelenk/client/status.h"

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/string_view.h"

namespace gelenk::client {
namespace {

// Codes beyond the canonical ones come from no server of ours.
absl::StatusCode CanonicalCode(int code) {
  constexpr int kLastCode =
      static_cast<int>(absl::StatusCode::kUnauthenticated);
  if (code < 0 || code > kLastCode) return absl::StatusCode::kUnknown;
  return static_cast<absl::StatusCode>(code);
}

bool Names(absl::string_view message, absl::string_view lower_case_words) {
  return absl::StrContains(absl::AsciiStrToLower(message), lower_case_words);
}

bool NamesReset(absl::string_view message) {
  return Names(message, "rst_stream") || Names(message, "goaway") ||
         Names(message, "connection reset");
}

}  // namespace

absl::Status FromGrpc(const grpc::Status& status) {
  return absl::Status(CanonicalCode(status.error_code()),
                      status.error_message());
}

absl::Status FromProto(const v1::FrameStatus& status) {
  return absl::Status(CanonicalCode(status.code()), status.message());
}

bool IsTransportLoss(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kCancelled:
      return true;
    case absl::StatusCode::kInternal:
      return NamesReset(status.message());
    case absl::StatusCode::kUnknown:
      return NamesReset(status.message()) ||
             Names(status.message(), "stream removed");
    default:
      return false;
  }
}

}  // namespace gelenk::client

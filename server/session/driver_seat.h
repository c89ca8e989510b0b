// Who drives a session, how far it has come, and whether it still lives.
#ifndef GELENK_SERVER_SESSION_DRIVER_SEAT_H_
#define GELENK_SERVER_SESSION_DRIVER_SEAT_H_

#include <cstdint>
#include <optional>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace gelenk::server {

// Who drives a session: a stream's slot. 0 is a unary call.
using DriverId = uint64_t;
inline constexpr DriverId kUnaryDriver = 0;

// One seat, for one stream at a time; unary calls drive while it is free. Not
// thread-safe. `session` is the name that errors tell.
class DriverSeat {
 public:
  // FAILED_PRECONDITION when another one sits there and `take_over` is not set.
  absl::Status Claim(DriverId driver, bool take_over,
                     absl::string_view session);
  void Release(DriverId driver);

  // OK while `driver` drives; ABORTED after it was taken over,
  // FAILED_PRECONDITION for a unary call beside a stream; the reason after End.
  absl::Status Check(DriverId driver, absl::string_view session) const;

  // Uses up the number of a frame. INVALID_ARGUMENT when there was one as
  // large; a frame without a number has any.
  absl::Status TakeNumber(std::optional<int64_t> number);
  // Goes on from a driver's last frame.
  void SetNumber(int64_t number) { sequence_number_ = number; }
  // Newest sequence number; 0 before the first.
  int64_t sequence_number() const { return sequence_number_; }

  // For good; the first reason counts.
  void End(absl::Status why);
  const absl::Status& ended() const { return ended_; }

 private:
  absl::Status ended_;
  std::optional<DriverId> driver_;
  int64_t sequence_number_ = 0;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_DRIVER_SEAT_H_

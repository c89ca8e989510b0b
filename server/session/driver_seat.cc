#include "server/session/driver_seat.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"

namespace gelenk::server {

absl::Status DriverSeat::Claim(DriverId driver, bool take_over,
                               absl::string_view session) {
  if (!ended_.ok()) return ended_;
  if (driver_ && *driver_ != driver && !take_over) {
    return absl::FailedPreconditionError(
        absl::StrCat("session: ", session,
                     " has a driver; attach with take_over to take it"));
  }
  driver_ = driver;
  return absl::OkStatus();
}

void DriverSeat::Release(DriverId driver) {
  if (driver_ == driver) driver_.reset();
}

absl::Status DriverSeat::Check(DriverId driver,
                               absl::string_view session) const {
  if (!ended_.ok()) return ended_;
  if (driver == kUnaryDriver) {
    if (!driver_) return absl::OkStatus();
    return absl::FailedPreconditionError(
        absl::StrCat("name: ", session, " is driven by a stream"));
  }
  if (driver_ == driver) return absl::OkStatus();
  return absl::AbortedError(
      absl::StrCat("session: ", session, " was taken over by another driver"));
}

absl::Status DriverSeat::TakeNumber(std::optional<int64_t> number) {
  if (!number) return absl::OkStatus();
  if (*number <= sequence_number_) {
    Violations violations;
    violations.Add(
        "sequence_number",
        absl::StrCat("want more than ", sequence_number_, ", got ", *number));
    return violations.ToStatus();
  }
  sequence_number_ = *number;
  return absl::OkStatus();
}

void DriverSeat::End(absl::Status why) {
  if (ended_.ok()) ended_ = std::move(why);
}

}  // namespace gelenk::server

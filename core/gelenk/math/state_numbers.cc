#include "gelenk/math/state_numbers.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/math/rotation.h"

namespace gelenk {

void StateNumbers::Time(std::optional<absl::Duration>& value) {
  bool is_known = value.has_value();
  Flag(is_known);
  if (!is_known) {
    value.reset();
    return;
  }
  absl::Duration rest = value.value_or(absl::ZeroDuration());
  auto seconds =
      static_cast<double>(absl::IDivDuration(rest, absl::Seconds(1), &rest));
  double nanos = absl::ToDoubleNanoseconds(rest);
  Number(seconds);
  Number(nanos);
  if (!is_reading() || !ok()) return;
  value = absl::Seconds(static_cast<int64_t>(seconds)) +
          absl::Nanoseconds(static_cast<int64_t>(nanos));
}

void StateNumbers::Refuse(absl::string_view why) {
  if (!status_.ok()) return;
  status_ = absl::InvalidArgumentError(
      absl::StrCat("state[", next_ == 0 ? 0 : next_ - 1, "]: ", why));
}

bool StateNumbers::Take(double& value) {
  if (!status_.ok()) return false;
  if (next_ == read_.size()) {
    status_ = absl::InvalidArgumentError(
        absl::StrFormat("state: want more than %d numbers", read_.size()));
    return false;
  }
  const double number = read_[next_++];
  if (!(std::abs(number) <= kMost)) {
    Refuse(absl::StrFormat("want a number up to %g, got %g", kMost, number));
    return false;
  }
  value = number;
  return true;
}

void StateNumbers::Number(double& value) {
  if (is_reading()) {
    Take(value);
  } else {
    written_->push_back(value);
  }
}

void StateNumbers::Count(int& value, int least, int most) {
  double number = value;
  Number(number);
  if (!is_reading() || !ok()) return;
  if (number < least || number > most || number != std::floor(number)) {
    Refuse(absl::StrFormat("want a whole number from %d to %d, got %g", least,
                           most, number));
    return;
  }
  value = static_cast<int>(number);
}

void StateNumbers::Flag(bool& value) {
  int number = value ? 1 : 0;
  Count(number, 0, 1);
  value = number == 1;
}

void StateNumbers::Vector(Eigen::Vector3d& value) {
  for (double& number : value) Number(number);
}

void StateNumbers::Numbers(Eigen::Ref<Eigen::VectorXd> values) {
  for (double& number : values) Number(number);
}

void StateNumbers::Rotation(Eigen::Quaterniond& value) {
  Eigen::Quaterniond rotation = value;
  for (double& number : rotation.coeffs()) Number(number);
  if (!is_reading() || !ok()) return;
  if (std::abs(rotation.norm() - 1) > kUnitTolerance) {
    Refuse(absl::StrFormat("want a unit quaternion, got one of norm %g",
                           rotation.norm()));
    return;
  }
  value = rotation;
}

void StateNumbers::Place(RigidTransform& value) {
  Rotation(value.rotation);
  Vector(value.translation);
}

absl::Status StateNumbers::Finish() const {
  if (!status_.ok() || !is_reading() || next_ == read_.size()) return status_;
  return absl::InvalidArgumentError(
      absl::StrFormat("state: want %d numbers, got %d", next_, read_.size()));
}

}  // namespace gelenk

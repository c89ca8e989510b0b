// What an object remembers from frame to frame, as a row of numbers: written
// by one, read by another of the same making, which then goes on bit by bit as
// the first would have.
//
// A class says once, for both ways, what it remembers:
//   void Exchange(StateNumbers& state) {
//     state.Flag(is_on_);
//     if (is_on_) state.Number(age_s_);
//   }
// What is read is checked like any input; from the first number that is wrong
// on nothing is read any more, and Finish says which.
#ifndef GELENK_MATH_STATE_NUMBERS_H_
#define GELENK_MATH_STATE_NUMBERS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "absl/types/span.h"
#include "gelenk/math/rigid_transform.h"

namespace gelenk {

class StateNumbers {
 public:
  // No length of a body, no angle, and no time since 1970 is larger, m, rad, s.
  static constexpr double kMost = 1e12;

  // Appends to `numbers`, which must outlive it.
  static StateNumbers Writer(std::vector<double>& numbers) {
    return StateNumbers(&numbers, {});
  }
  static StateNumbers Reader(absl::Span<const double> numbers) {
    return StateNumbers(nullptr, numbers);
  }

  bool is_reading() const { return written_ == nullptr; }

  void Number(double& value);
  void Flag(bool& value);
  // `least` to `most`.
  void Count(int& value, int least, int most);
  // An enum whose values are 0 to `last`.
  template <class Enum>
  void Choice(Enum& value, Enum last) {
    int number = static_cast<int>(value);
    Count(number, 0, static_cast<int>(last));
    value = static_cast<Enum>(number);
  }
  void Vector(Eigen::Vector3d& value);
  // Numbers of a size that both sides know.
  void Numbers(Eigen::Ref<Eigen::VectorXd> values);
  // Near unit, taken as it is.
  void Rotation(Eigen::Quaterniond& value);
  void Place(RigidTransform& value);
  // Exact to the nanosecond, which is what messages carry.
  void Time(std::optional<absl::Duration>& value);

  // What was read so far is no state of this object.
  void Refuse(absl::string_view why);

  bool ok() const { return status_.ok(); }
  // INVALID_ARGUMENT naming the first number that is wrong, or when there are
  // too few or too many.
  absl::Status Finish() const;

 private:
  StateNumbers(std::vector<double>* written, absl::Span<const double> read)
      : written_(written), read_(read) {}
  // The next number; false when there is none to take.
  bool Take(double& value);

  std::vector<double>* written_;
  absl::Span<const double> read_;
  size_t next_ = 0;
  absl::Status status_;
};

template <class Object>
std::vector<double> StateOf(Object& object) {
  std::vector<double> numbers;
  StateNumbers state = StateNumbers::Writer(numbers);
  object.Exchange(state);
  return numbers;
}

// Puts `object` into the state that `numbers` tell; with an error (see Finish)
// it is as before.
template <class Object>
absl::Status RestoreState(absl::Span<const double> numbers, Object& object) {
  const std::vector<double> before = StateOf(object);
  StateNumbers state = StateNumbers::Reader(numbers);
  object.Exchange(state);
  const absl::Status status = state.Finish();
  if (status.ok()) return status;
  StateNumbers back = StateNumbers::Reader(before);
  object.Exchange(back);
  return status;
}

}  // namespace gelenk

#endif  // GELENK_MATH_STATE_NUMBERS_H_

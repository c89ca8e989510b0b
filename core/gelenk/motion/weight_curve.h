// A weight that changes over time: straight lines between keys, the first and
// the last hold before and after.
#ifndef GELENK_MOTION_WEIGHT_CURVE_H_
#define GELENK_MOTION_WEIGHT_CURVE_H_

#include <utility>
#include <vector>

#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"

namespace gelenk {

struct WeightKey {
  double time_s = 0;
  double weight = 1;
};

class WeightCurve {
 public:
  // Always `weight`.
  WeightCurve(double weight = 1) : keys_({{0, weight}}) {}  // NOLINT: a number
  // Keys in order of time; see Check.
  explicit WeightCurve(std::vector<WeightKey> keys) : keys_(std::move(keys)) {}

  // From 0 to 1 within `duration_s`, and from 1 to 0.
  static WeightCurve FadeIn(double start_s, double duration_s) {
    return WeightCurve({{start_s, 0}, {start_s + duration_s, 1}});
  }
  static WeightCurve FadeOut(double start_s, double duration_s) {
    return WeightCurve({{start_s, 1}, {start_s + duration_s, 0}});
  }

  // Logarithmic in the keys.
  double At(double time_s) const;

  // At least one key; times finite and not falling (two at one time are a
  // jump), weights finite and at least `lowest`.
  void Check(absl::string_view field, double lowest,
             Violations& violations) const;

  const std::vector<WeightKey>& keys() const { return keys_; }

 private:
  std::vector<WeightKey> keys_;
};

}  // namespace gelenk

#endif  // GELENK_MOTION_WEIGHT_CURVE_H_

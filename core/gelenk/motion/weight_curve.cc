#include "gelenk/motion/weight_curve.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"

namespace gelenk {

double WeightCurve::At(double time_s) const {
  const auto after = std::upper_bound(
      keys_.begin(), keys_.end(), time_s,
      [](double time, const WeightKey& key) { return time < key.time_s; });
  if (after == keys_.begin()) return keys_.front().weight;
  if (after == keys_.end()) return keys_.back().weight;
  const WeightKey& before = *(after - 1);
  const double u = (time_s - before.time_s) / (after->time_s - before.time_s);
  return before.weight + u * (after->weight - before.weight);
}

void WeightCurve::Check(absl::string_view field, double lowest,
                        Violations& violations) const {
  if (keys_.empty()) violations.Add(field, "want at least one key");
  for (size_t i = 0; i < keys_.size(); ++i) {
    const WeightKey& key = keys_[i];
    const bool is_ordered = std::isfinite(key.time_s) &&
                            (i == 0 || !(key.time_s < keys_[i - 1].time_s));
    if (!is_ordered) {
      violations.Add(
          absl::StrCat(field, "[", i, "].time_s"),
          absl::StrCat("want finite times in order, got ", key.time_s));
    }
    if (!(std::isfinite(key.weight) && key.weight >= lowest)) {
      violations.Add(absl::StrCat(field, "[", i, "].weight"),
                     absl::StrCat("want a finite number >= ", lowest, ", got ",
                                  key.weight));
    }
  }
}

}  // namespace gelenk

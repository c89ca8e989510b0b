// Checks of plain numbers at the border, all in the same words.
//
// What is larger than kLargestNumber is refused like what is not finite: it is
// a mistake, and its squares and products would not be finite for long.
#ifndef GELENK_BASE_NUMBER_CHECK_H_
#define GELENK_BASE_NUMBER_CHECK_H_

#include <Eigen/Core>
#include <cmath>

#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"

namespace gelenk {

// m, rad, kg, weights: far beyond any use, and a tenth power of it is finite.
inline constexpr double kLargestNumber = 1e12;

// False for NaN.
inline bool IsUsable(double value) { return std::abs(value) <= kLargestNumber; }

void CheckNumber(absl::string_view field, double value, Violations& violations);
void CheckPositive(absl::string_view field, double value,
                   Violations& violations);
void CheckNotNegative(absl::string_view field, double value,
                      Violations& violations);

// A point or another short vector, told as a whole.
void CheckNumbers(absl::string_view field,
                  const Eigen::Ref<const Eigen::VectorXd>& values,
                  Violations& violations);

}  // namespace gelenk

#endif  // GELENK_BASE_NUMBER_CHECK_H_

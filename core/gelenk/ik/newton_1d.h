// Newton's method in one dimension, on a user's function: x <- x - f / f', with
// the derivative given or by finite differences, and its tangents recorded for
// a picture.
//
// With a bracket the function is looked at in a row of samples first; every
// change of sign is a zero, and none, one and many are told apart as far as the
// samples show: zeros between two samples that come in pairs, and those that
// touch without crossing (unless a sample hits them), are not seen. A step that
// leaves the piece in which the sign changes, or has no slope, is replaced by
// halving the piece, so that a zero that was seen is found. Without a bracket
// it is the plain method, which may find nothing.
#ifndef GELENK_IK_NEWTON_1D_H_
#define GELENK_IK_NEWTON_1D_H_

#include <functional>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"

namespace gelenk {

using ScalarFunction = std::function<double(double)>;

struct Newton1dOptions {
  double start = 0;
  struct Bracket {
    double lower = 0;
    double upper = 0;
  };
  std::optional<Bracket> bracket;
  // Samples in the bracket, ends included.
  int sample_count = 257;
  // |f| that counts as zero.
  double tolerance = 1e-12;
  int max_iterations = 50;
  // Step of the finite difference (f(x + step) - f(x)) / step.
  double difference_step = 1e-7;
};

enum class ZeroCount { kUnknown, kNone, kOne, kMany };

struct Tangent {
  double x = 0;
  double f = 0;
  double slope = 0;
};

struct Newton1dResult {
  bool converged = false;
  // The slope vanished, and there was no bracket to fall back on.
  bool singular = false;
  double x = 0;
  double f = 0;
  // What the bracket shows; kUnknown without one.
  ZeroCount zero_count = ZeroCount::kUnknown;
  // Middles of the sampled pieces in which the sign changes, ascending.
  std::vector<double> seen_zeros;
  // In order, one per iteration.
  std::vector<Tangent> tangents;
};

// `derivative` may be null. INVALID_ARGUMENT naming the field of `options` that
// is out of range. A value of the function that is not finite ends the search,
// not converged. Of many zeros the one in the piece nearest to the start is
// looked for.
absl::StatusOr<Newton1dResult> FindZero(const ScalarFunction& function,
                                        const ScalarFunction& derivative,
                                        const Newton1dOptions& options);

}  // namespace gelenk

#endif  // GELENK_IK_NEWTON_1D_H_

// Other starts for a solve that did not converge from the first one.
#ifndef GELENK_IK_START_SAMPLER_H_
#define GELENK_IK_START_SAMPLER_H_

#include <cstdint>

#include "absl/types/span.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

// Where random numbers for one coordinate come from.
struct StartRange {
  double lower;
  double upper;
};

// The bounds where there are any; else, or where they are more than two turns
// or 1 km apart, half a turn either way of zero for an angle, and near `start`
// for a translation.
StartRange RangeOfStarts(bool is_angle, double start, double lower,
                         double upper);

// Deterministic: the same seed gives the same starts on every machine.
class StartSampler {
 public:
  explicit StartSampler(int64_t seed);

  // Draws numbers inside the limits for the joints of these indices, and leaves
  // the others: uniform where a coordinate is bounded or an angle; near `start`
  // where it is not (translations, orientations), since the last known place of
  // an actor is the best guess there is.
  void Sample(const Skeleton& skeleton, absl::Span<const int> joints,
              const ConstVectorView& start, VectorView positions);

 private:
  void SampleJoint(const Skeleton& skeleton, int index,
                   const ConstVectorView& start, VectorView positions);
  // Uniform in [lower, upper).
  double Uniform(double lower, double upper);

  uint64_t state_;
};

}  // namespace gelenk

#endif  // GELENK_IK_START_SAMPLER_H_

// How much the points of feet tremble: noise of a capture, which looks like
// speed but goes nowhere.
//
// The third difference of evenly spaced frames is small where a body moves or
// stands, and sqrt(20) of the noise where every frame errs by itself. Of all
// points the one that has least counts: some point mostly stands. Noise that
// points do not have in common is told too small by that, never too large.
#ifndef GELENK_CONTACT_POINT_NOISE_H_
#define GELENK_CONTACT_POINT_NOISE_H_

#include <array>

#include "gelenk/contact/foot_points.h"
#include "gelenk/math/state_numbers.h"

namespace gelenk {

class PointNoise {
 public:
  // A frame, `dt_s` > 0 after the one before. Allocates nothing.
  void Update(const FootPoints& points, double dt_s);

  // Standard deviation along an axis, m; 0 in the first frames.
  double deviation_m() const;

  void Reset() { *this = {}; }

  void Exchange(StateNumbers& state);

 private:
  static constexpr int kBefore = 3;

  // The latest first.
  std::array<FootPoints, kBefore> before_ = {};
  int count_ = 0;
  double variance_ = 0;
};

}  // namespace gelenk

#endif  // GELENK_CONTACT_POINT_NOISE_H_

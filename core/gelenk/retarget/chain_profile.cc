#include "gelenk/retarget/chain_profile.h"

namespace gelenk {

ChainPlace PlaceOnChain(absl::Span<const double> fractions, double fraction) {
  constexpr double kRounding = 1e-9;
  double before = 0;
  int index = 0;
  for (double at : fractions) {
    if (fraction <= at + kRounding) {
      const double way = at - before;
      const double part = way > kRounding ? (fraction - before) / way : 1;
      return {index, index + 1, part};
    }
    before = at;
    ++index;
  }
  // Beyond the last joint: on the way to the end.
  const double way = 1 - before;
  const double part = way > kRounding ? (fraction - before) / way : 1;
  return {index, index + 1, part};
}

Eigen::Quaterniond OrientationAt(const ChainPlace& place,
                                 const Eigen::Quaterniond& below,
                                 absl::Span<const Eigen::Quaterniond> chain,
                                 const Eigen::Quaterniond& end) {
  const auto at = [&](int index) -> const Eigen::Quaterniond& {
    if (index == 0) return below;
    const size_t joint = static_cast<size_t>(index) - 1;
    return joint < chain.size() ? chain[joint] : end;
  };
  return at(place.from).slerp(place.part, at(place.to));
}

}  // namespace gelenk

// Chains of equal links with targets that they can reach.
#ifndef GELENK_TESTS_BENCHMARKS_CHAIN_SETS_H_
#define GELENK_TESTS_BENCHMARKS_CHAIN_SETS_H_

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "gelenk/skeleton/skeleton.h"

namespace gelenk::benchmarks {

enum class ChainKind {
  kPlanar,     // a revolute joint a link, all about z, +-2.0944 rad
  kBall,       // three revolute joints a link, about z, y and x, +-1.5 rad
  kSpherical,  // a spherical joint a link, without limits
};

struct ChainSet {
  std::string name;
  std::shared_ptr<const Skeleton> skeleton;
  // The tip at joint values drawn uniformly inside the limits.
  std::vector<Eigen::Vector3d> targets;
};

// `link_count` links, 1 m together, straight along x at rest, the tip is "tip".
// `limited` or not, the targets are the same. Where the folder GELENK_BENCH_IK
// has the file planar3.csv, ball100.csv or so (joint values in columns q0, q1,
// .. of lines that are problems), targets come from there.
ChainSet MakeChainSet(ChainKind kind, int link_count, bool limited);

}  // namespace gelenk::benchmarks

#endif  // GELENK_TESTS_BENCHMARKS_CHAIN_SETS_H_

// Three arms that everybody knows, with targets that they can reach.
#ifndef TESTS_BENCHMARKS_IK_ARM_SETS_H_
#define TESTS_BENCHMARKS_IK_ARM_SETS_H_

#include <string>
#include <vector>

#include "client/cli/bench/ik_set.h"

namespace gelenk::benchmarks {

struct ArmSet {
  std::string name;
  // From the middle of each joint's range, and from the truth +- 0.1 rad.
  cli::IkSet cold;
  cli::IkSet warm;
};

// Panda, iiwa 14 and UR5 by the tables and limits of their makers; targets are
// the forward kinematics of joint values drawn uniformly inside the limits.
// Where the folder GELENK_BENCH_IK is given, its {panda,iiwa14,ur5}.json and
// .csv.gz are taken in their place.
std::vector<ArmSet> ArmSets(int target_count);

}  // namespace gelenk::benchmarks

#endif  // TESTS_BENCHMARKS_IK_ARM_SETS_H_

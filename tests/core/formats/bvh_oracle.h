// Where the joints of a BVH file stand, straight from the definition of the
// format and with matrices: slow, and independent of what is tested.
#ifndef GELENK_TESTS_CORE_FORMATS_BVH_ORACLE_H_
#define GELENK_TESTS_CORE_FORMATS_BVH_ORACLE_H_

#include <Eigen/Geometry>
#include <vector>

#include "gelenk/formats/bvh_document.h"

namespace gelenk {

// World frames of the file's joints, in the file's unit: the OFFSET, or
// positions where there are channels, then each rotation in turn.
std::vector<Eigen::Affine3d> OracleWorldFromJoints(const BvhDocument& document,
                                                   int frame);

// The worst over all joints and frames of two documents of one hierarchy:
// difference of rotation matrices, and distance in the file's unit.
struct BvhDifference {
  double rotation = 0;
  double position = 0;
};
BvhDifference CompareMotion(const BvhDocument& a, const BvhDocument& b);

}  // namespace gelenk

#endif  // GELENK_TESTS_CORE_FORMATS_BVH_ORACLE_H_

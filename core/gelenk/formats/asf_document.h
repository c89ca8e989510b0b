// What an ASF file (Acclaim skeleton) and its AMC file (motion) say, as they
// say it: bones with directions in the world at rest, and rows of the numbers
// that move them.
//
// Lengths are in the files' own unit; nothing is turned or scaled. asf_bvh.h
// makes joints and channels of it.
#ifndef GELENK_FORMATS_ASF_DOCUMENT_H_
#define GELENK_FORMATS_ASF_DOCUMENT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "gelenk/formats/bvh_document.h"
#include "gelenk/math/euler.h"

namespace gelenk {

struct AsfBone {
  std::string name = {};
  // Index in AsfDocument::bones, smaller than its own; -1 for the root.
  int parent = -1;
  // From its start to its end at rest, unit, in the world; zero of the root.
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  double length = 0;
  // The frame that its numbers turn about: turns about fixed axes by
  // `axis_rad[k]` about X, Y, Z, in the order of `axis_order`.
  Eigen::Vector3d axis_rad = Eigen::Vector3d::Zero();
  EulerAxes axis_order = {0, 1, 2};
  // What moves it, in file order. Below the root rotations only.
  std::vector<BvhChannel> dofs = {};
};

struct AsfDocument {
  // Parents first; the root is bones[0].
  std::vector<AsfBone> bones;
  Eigen::Vector3d root_position = Eigen::Vector3d::Zero();
  // Whether AMC files that do not say are in degrees.
  bool is_in_degrees = true;
  // What the reader took with a grain of salt.
  std::vector<std::string> warnings;

  int dof_count() const {
    int count = 0;
    for (const AsfBone& bone : bones) {
      count += static_cast<int>(bone.dofs.size());
    }
    return count;
  }
};

// One column a frame, one row a dof: the bones' dofs one after the other;
// angles in rad.
struct AmcMotion {
  Eigen::MatrixXd numbers;
};

}  // namespace gelenk

#endif  // GELENK_FORMATS_ASF_DOCUMENT_H_

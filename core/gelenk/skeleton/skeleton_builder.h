// Turns joints in any order into a Skeleton.
//
// Errors: INVALID_ARGUMENT that lists every malformed field (no tree, cycle,
// duplicate or unknown id, non-finite number, axis or quaternion not unit,
// lower above upper, wrong sizes, mimic of a mimic).
#ifndef GELENK_SKELETON_SKELETON_BUILDER_H_
#define GELENK_SKELETON_SKELETON_BUILDER_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// Largest skeletons taken unless the caller says otherwise: a body with fingers
// and face has about 200 joints, a rope of 300 links three joints a link.
struct SkeletonBounds {
  int max_joints = 1024;
  int max_depth = 1024;
  int max_end_effectors = 1024;
};

class SkeletonBuilder {
 public:
  SkeletonBuilder& AddJoint(Joint joint);
  SkeletonBuilder& AddEndEffector(EndEffector end_effector);
  // Any length but zero; normalised. Default +Y.
  SkeletonBuilder& SetUp(const Eigen::Vector3d& up);
  // Planar skeletons refuse axes other than Z and joints that leave the XY
  // plane.
  SkeletonBuilder& SetPlanar(bool planar);
  // Size position_count, in the order in which the joints were added.
  SkeletonBuilder& SetRestPositions(Eigen::VectorXd positions);
  SkeletonBuilder& SetBounds(const SkeletonBounds& bounds);

  // Joints keep their order of adding where that has parents first; else they
  // are moved behind their parents. Errors name joints by their place in the
  // order of adding. Cost: linear in the joints.
  absl::StatusOr<std::shared_ptr<const Skeleton>> Build() const;

 private:
  absl::Status CheckCounts() const;

  // Moves `joints`, checked, into the skeleton in the given order of their
  // indices.
  void PlaceJoints(const std::vector<int>& order, std::vector<Joint>& joints,
                   Skeleton& skeleton) const;

  // `given` in the order of adding, or empty.
  void PlaceRestPositions(const std::vector<int>& order,
                          const Eigen::VectorXd& given,
                          Skeleton& skeleton) const;

  std::vector<Joint> joints_;
  std::vector<EndEffector> end_effectors_;
  Eigen::VectorXd rest_positions_;
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitY();
  bool planar_ = false;
  SkeletonBounds bounds_;
};

}  // namespace gelenk

#endif  // GELENK_SKELETON_SKELETON_BUILDER_H_

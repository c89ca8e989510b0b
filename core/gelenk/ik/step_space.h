// The coordinates of one step from a pose, and how far each may go: joint
// limits, swing cones, twist ranges, and what a solve from a warm start may
// move at most.
//
// One coordinate per velocity. Those of a rotation are body axes, except near
// its limits: there they are the basis dual to swing angle, swing direction and
// twist, in which the limits are bounds of single coordinates (see
// RotationBasis). What a rotation may turn from the start is a ball, of which a
// step sees a box inside: a cube at the start, later a longer one along the
// turn so far.
//
// Cost: linear in the joints. Keeps its memory. Not thread-safe.
#ifndef GELENK_IK_STEP_SPACE_H_
#define GELENK_IK_STEP_SPACE_H_

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "gelenk/ik/level_step.h"
#include "gelenk/ik/step_bounds.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

class StepSpace {
 public:
  // For solves from `start`, which is inside the limits. `max_step` and
  // `bounds` (may be null) are measured from it.
  void Reset(const Skeleton& skeleton, std::optional<double> max_step,
             const StepBounds* bounds, const ConstVectorView& start);

  // Takes up the coordinates at a pose inside all of these.
  void MoveTo(const ConstVectorView& positions);

  int size() const { return static_cast<int>(lower_.size()); }
  // Per coordinate, from where it is: <= 0 and >= 0.
  double lower(int coordinate) const { return lower_[coordinate]; }
  double upper(int coordinate) const { return upper_[coordinate]; }

  // Turns columns of body axes into those of the coordinates, in place.
  void TurnColumns(LevelStep::MatrixView rows) const;
  // Null where the coordinates of the rotation at velocity `first` are its body
  // axes; else these, as columns, and whether they are at right angles.
  struct Basis {
    Eigen::Matrix3d axes;
    bool orthogonal;
  };
  const Basis* BasisAt(int first) const;

  // Moves `positions` by scale * step, and then inside all limits.
  void Move(const double* step, double scale, VectorView positions) const;

 private:
  struct Scalar {
    int position;
    int velocity;
    double lower;
    double upper;
  };
  struct Rotation {
    int joint;
    int position;
    int velocity;
    // From the start, rad; infinite where unbounded.
    double most_turn;
    // Where it is.
    bool based;
    Basis basis;
  };

  void AddJoint(int joint, std::optional<double> max_step,
                const StepBounds* bounds);
  // Where it is near its limits.
  void FindBasis(const ConstVectorView& positions, Rotation& rotation);
  // The box of its turn, in axes along that where it has none yet.
  void BoundTurn(const ConstVectorView& positions, Rotation& rotation);
  // The nearest rotation that keeps both bounds.
  void KeepInside(const Rotation& rotation, double* quaternion) const;
  bool KeepTurn(const Rotation& rotation, double* quaternion) const;

  const Skeleton* skeleton_ = nullptr;
  std::vector<double> start_;
  std::vector<Scalar> scalars_;
  std::vector<Rotation> rotations_;
  std::vector<int> rotation_at_;  // by its first velocity, -1 for none
  std::vector<double> lower_;
  std::vector<double> upper_;
};

}  // namespace gelenk

#endif  // GELENK_IK_STEP_SPACE_H_

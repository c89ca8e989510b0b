// A skeleton understood as a body: what its joints' frames mean, whatever axes,
// rolls and rest pose the rig has.
//
// Canonical coordinates: m, X to the body's left when it stands as its rig was
// made, Y up, Z forward. The world keeps its heading and its origin, only up
// becomes Y.
//
// Every joint has an anatomical frame: `anatomy` = G with
//     A(t) = canonical_from_world * R(t) * G^-1,
// R(t) the joint's orientation in the world; A is the identity in the canonical
// T-pose, for every rig. So A of one body can be given to another. G is made of
// the reference pose and, per bone, of the shortest rotation that takes the
// bone from its direction there to that of the T-pose: legs down, arms to the
// sides, feet forward. The shortest rotation carries the roll right between T-,
// A- and arms-down poses, because it turns about the forward axis. Where the
// reference is no rest pose but a frame of a clip, the roll of limbs is told by
// their hinges: elbows and knees bend about one axis. Feet that are flat in the
// clip but tilted in the reference are made flat.
#ifndef GELENK_RETARGET_BODY_MODEL_H_
#define GELENK_RETARGET_BODY_MODEL_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/contact/foot_points.h"
#include "gelenk/retarget/joint_map.h"
#include "gelenk/retarget/reference_pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// The two bones of an arm or a leg, m.
struct LimbLengths {
  double upper = 0;
  double lower = 0;

  double Total() const { return upper + lower; }
};

// The points of one foot that touch the ground.
struct FootShape {
  // In the foot's joint frame.
  Eigen::Vector3d heel = Eigen::Vector3d::Zero();
  Eigen::Vector3d ball = Eigen::Vector3d::Zero();
  // In the toe's joint frame; where has_tip is false the ball stands for it.
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  bool has_tip = false;
  // Of the ankle above the sole.
  double ankle_height = 0;
};

// Whether feet are made flat by the clip: by default where the rest pose is not
// the reference, or where its feet are tilted by more than 5 degrees.
enum class FlatFeet { kAuto, kOff, kOn };

struct BodyModelOptions {
  // A pose that stands, for rigs whose rest pose does not and which come
  // without a clip.
  std::optional<Eigen::VectorXd> reference_positions;
  FlatFeet flat_feet = FlatFeet::kAuto;
};

struct BodyModel {
  std::shared_ptr<const Skeleton> skeleton;
  JointMap map;
  ReferencePose reference;
  Eigen::Quaterniond canonical_from_world = Eigen::Quaterniond::Identity();
  // Per joint, see above.
  std::vector<Eigen::Quaterniond> anatomy;
  // Per joint its place in the parent at the reference pose, motion included.
  std::vector<RigidTransform> parent_from_joint;
  // Along the way from the pelvis to the chest, 0 to 1, of each joint of
  // map.spine; and from the chest to the head of each of map.neck.
  std::vector<double> spine_fractions;
  std::vector<double> neck_fractions;
  // By side; 0 where the limb is missing.
  std::array<LimbLengths, 2> legs;
  std::array<LimbLengths, 2> arms;
  std::array<FootShape, 2> feet;
  PlantedHeights planted_heights = {};
  // Mean of both legs, else estimated from what is there: thresholds and the
  // root's way scale with it.
  double leg_length = 0;
  // What was found out and done: reference, rolls, tilts of feet.
  std::vector<std::string> notes;

  // Factor on lengths and speeds that are given for kReferenceLegM.
  double Size() const { return leg_length / kReferenceLegM; }
};

// `clip` may be null. Errors: INVALID_ARGUMENT when the map has neither a
// pelvis nor any limb, when the reference positions given are none of the
// skeleton's, or when neither the rest pose nor a clip shows a standing body
// and no reference was given. Cost: linear in joints and frames.
absl::StatusOr<std::shared_ptr<const BodyModel>> MakeBodyModel(
    std::shared_ptr<const Skeleton> skeleton, const JointMap& map,
    const ClipView* clip = nullptr, const BodyModelOptions& options = {});

}  // namespace gelenk

#endif  // GELENK_RETARGET_BODY_MODEL_H_

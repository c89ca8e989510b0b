// Free-form-deformation volumes around the links of a skeleton.
//
// Link i has seven control planes P0 .. P6 and two cubic volumes between them:
// P0 .. P3 and P3 .. P6. P1 and P5 turn with the joints, into the bisector of
// the links on either side; P2 and P4 swell with the muscles; P3 lies midway
// between P2 and P4, the plane of a joint midway between P5 of the one link and
// P1 of the next. So neighbours share border planes and are collinear 1:1
// across them: the map is C1 whatever the bends, lengths and muscles.
//
// A branch (a link that starts at a joint but continues nothing) has a stub: a
// third volume that reaches back into its parent, three spacings long. A link
// has a rigid volume, too, the affine map of its frame: the cap beyond a
// chain's ends, and what rigid pieces ride on.
//
// World frame, m. Immutable, safe to use from any thread; Evaluate allocates
// nothing on a frame that it has seen before. About 0.1 us a link.
//
// Source: Chadwick, Haumann, Parent, "Layered construction for deformable
// animated characters", SIGGRAPH 1989.
#ifndef GELENK_SKIN_VOLUME_RIG_H_
#define GELENK_SKIN_VOLUME_RIG_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "gelenk/kinematics/kinematic_tree.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/skin/bezier_volume.h"
#include "gelenk/skin/control_plane.h"
#include "gelenk/skin/muscle.h"
#include "gelenk/skin/skin_link.h"

namespace gelenk {

inline constexpr int kPlanesPerLink = 7;
inline constexpr int kPlanesPerStub = 4;

// What a volume is to its link.
enum class VolumePart { kFirstHalf, kSecondHalf, kRigid, kStub };

// The planes and volumes at one pose.
class VolumeFrame {
 public:
  // P0 .. P6 of a link.
  absl::Span<const ControlPlane> planes(int link) const {
    return absl::MakeConstSpan(planes_).subspan(kPlanesPerLink * link,
                                                kPlanesPerLink);
  }
  // All planes: seven a link, then four a stub.
  absl::Span<const ControlPlane> all_planes() const { return planes_; }

  absl::Span<const BezierVolume> volumes() const { return volumes_; }
  const BezierVolume& volume(int index) const { return volumes_[index]; }

  // Columns are the axes of the link's frame.
  const Eigen::Matrix3d& rotation(int link) const { return rotations_[link]; }
  const Eigen::Vector3d& origin(int link) const { return origins_[link]; }

  // Of links that preserve their volume: the scale that was set, and the one
  // that would have been needed; they differ where it was clamped. 1 for all
  // others.
  double volume_scale(int link) const { return volume_scales_[link]; }
  double wanted_volume_scale(int link) const { return wanted_scales_[link]; }

 private:
  friend class VolumeRig;
  friend class RigPose;

  KinematicFrames kinematics_;
  std::vector<Eigen::Matrix3d> rotations_;  // world_from_link
  std::vector<Eigen::Vector3d> origins_;
  std::vector<Eigen::Matrix3d> joint_rotations_;  // of the plane at the start
  std::vector<ControlPlane> planes_;
  std::vector<BezierVolume> volumes_;
  std::vector<double> volume_scales_;
  std::vector<double> wanted_scales_;
};

// One volume that turns inside out at a pose.
struct VolumeFold {
  int volume = -1;
  // The least determinant against its value in the middle at rest; <= 0.
  double least_jacobian = 0;
};

// See SkinLink.
struct LinkSection {
  Eigen::Vector2d half_extents_m;
  Eigen::Vector2d cap_reach_m;
};

class VolumeRig {
 public:
  // INVALID_ARGUMENT that lists every malformed override, muscle and fullness.
  static absl::StatusOr<std::shared_ptr<const VolumeRig>> Create(
      std::shared_ptr<const Skeleton> skeleton,
      const SkinLinkOptions& options = {}, const SkinMuscles& muscles = {});

  // The same volumes with other muscles. Bindings stay valid unless a fullness
  // changed where the rest pose is bent.
  absl::StatusOr<std::shared_ptr<const VolumeRig>> WithMuscles(
      const SkinMuscles& muscles) const;

  // The same with other sections: half extents of every link. Planes and
  // bindings do not depend on them.
  std::shared_ptr<const VolumeRig> WithHalfExtents(
      absl::Span<const Eigen::Vector2d> half_extents_m) const;
  std::shared_ptr<const VolumeRig> WithSections(
      absl::Span<const LinkSection> sections) const;

  const Skeleton& skeleton() const { return *skeleton_; }
  const std::shared_ptr<const Skeleton>& shared_skeleton() const {
    return skeleton_;
  }
  const SkinMuscles& muscles() const { return muscles_; }
  const Eigen::VectorXd& rest_positions() const { return rest_positions_; }

  int link_count() const { return static_cast<int>(links_.size()); }
  const SkinLink& link(int index) const { return links_[index]; }
  absl::Span<const SkinLink> links() const { return links_; }
  // -1 when there is none.
  int FindLink(absl::string_view id) const;

  // The distance of the planes around the joint at a link's start, and at its
  // end, m: a sixth of the shorter of the two links.
  double start_spacing_m(int link) const { return start_spacings_[link]; }
  double end_spacing_m(int link) const { return end_spacings_[link]; }
  bool is_branch(int link) const { return stubs_[link] >= 0; }
  // Links that continue one another have the same number.
  int chain(int link) const { return chains_[link]; }

  int volume_count() const {
    return kVolumesPerLink * link_count() +
           static_cast<int>(stub_links_.size());
  }
  // The index of a part's volume; kStub only for branches.
  int volume(int link, VolumePart part) const;
  int volume_link(int volume) const;
  VolumePart volume_part(int volume) const;

  // `positions` has size position_count.
  void Evaluate(const ConstVectorView& positions,
                const RigidTransform& world_from_skeleton,
                VolumeFrame& frame) const;

  // At the rest pose, without muscles, the skeleton's base at the origin.
  const VolumeFrame& rest() const { return rest_; }

  // The volumes of `frame` that turn inside out within their sections.
  // 1 us a volume.
  std::vector<VolumeFold> FindFolds(const VolumeFrame& frame) const;

 private:
  friend class RigPose;
  friend class MuscleCompiler;
  static constexpr int kVolumesPerLink = 3;

  // How the planes at a link's start turn.
  struct JointMotion {
    Eigen::Matrix3d joint_from_link;
    // The one hinge, or ball, between the links; -1 for anything else.
    int hinge = -1;
    int ball = -1;
    // Of the ball: stem_from_link = before * its quaternion * after.
    Eigen::Quaterniond before;
    Eigen::Quaterniond after;
    Eigen::Vector3d axis;  // link frame
    double rest_angle_rad = 0;
    // What is halved is the turn of the link against the stem: the parent for
    // a continuation; for a branch what stands in the parent as the link does
    // at rest, or a leg that hangs from a spine would be half turned before it
    // moves.
    Eigen::Quaterniond parent_from_stem;
    Eigen::Quaterniond stem_from_rest;
    Eigen::Vector3d parent_origin;  // of this link at rest
  };

  struct CompiledMuscle {
    int link;
    MuscleMode mode;
    int driver;                             // joint
    Eigen::Quaterniond driver_from_rest;    // of joints with a quaternion
    double rest_angle_rad;                  // of all others
    std::array<Eigen::Vector2d, 2> scales;  // P2, P4; or gains
    Eigen::Vector2d pivot_m;
  };

  struct VolumeGoal {
    double volume_per_section = 0;  // 0 for none
    double min_scale = 1;
    double max_scale = 1;
  };

  VolumeRig(std::shared_ptr<const Skeleton> skeleton,
            std::vector<SkinLink> links, Eigen::VectorXd rest_positions);

  void CompileJoints();
  // Of a link with a parent.
  void CompileMotion(int link, const WorldTransforms& world_from_joints);
  absl::Status SetMuscles(const SkinMuscles& muscles);
  void EvaluateRest();

  std::shared_ptr<const Skeleton> skeleton_;
  Eigen::VectorXd rest_positions_;
  std::vector<SkinLink> links_;
  KinematicTree tree_;
  std::vector<double> start_spacings_;
  std::vector<double> end_spacings_;
  std::vector<int> chains_;
  std::vector<int> stubs_;       // of each link: its stub, or -1
  std::vector<int> stub_links_;  // of each stub
  std::vector<JointMotion> joints_;

  SkinMuscles muscles_;
  std::vector<CompiledMuscle> compiled_;
  std::vector<double> fullness_;          // of the joint at each link's start
  std::vector<VolumeGoal> volume_goals_;  // of each link
  VolumeFrame rest_;
};

}  // namespace gelenk

#endif  // GELENK_SKIN_VOLUME_RIG_H_

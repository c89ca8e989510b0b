// VolumeRig at a pose: frames of the links, planes, volumes.
#include <algorithm>
#include <cmath>

#include "gelenk/math/rotation.h"
#include "gelenk/skin/half_rotation.h"
#include "gelenk/skin/volume_rig.h"

namespace gelenk {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Sections that straight neighbours have in common need no mitre.
constexpr double kStraight = 1e-9;

// Nodes of a 5-point Gauss rule on [0, 1] and their weights; exact for the
// volume of a link.
constexpr int kNodes = 5;
constexpr double kNode[kNodes] = {0.5, 0.7692346550528415, 0.2307653449471585,
                                  0.9530899229693320, 0.0469100770306680};
constexpr double kNodeWeight[kNodes] = {
    0.28444444444444444, 0.23931433524968324, 0.23931433524968324,
    0.11846344252809454, 0.11846344252809454};

ControlPlane PlaneOf(const Matrix3d& rotation, const Vector3d& center) {
  return ControlPlane(center, rotation.col(1), rotation.col(2));
}

double Det(const Vector3d& u, const Vector3d& a, const Vector3d& b) {
  return u.dot(a.cross(b));
}

// The volume of a link per section, as base + linear x + square x^2 where x
// scales its inner planes across.
struct VolumeBySectionScale {
  double base = 0;
  double linear = 0;
  double square = 0;
};

// Adds the cubic between `planes`; `inner` marks those that x scales.
void AddVolume(absl::Span<const ControlPlane> planes,
               const std::array<bool, 4>& inner, VolumeBySectionScale& sum) {
  const BezierVolume volume = BezierVolume::Between(planes);
  for (int n = 0; n < kNodes; ++n) {
    const double u = kNode[n];
    const double v = 1 - u;
    const double bernstein[4] = {v * v * v, 3 * u * v * v, 3 * u * u * v,
                                 u * u * u};
    Vector3d fixed_s = Vector3d::Zero(), fixed_t = Vector3d::Zero();
    Vector3d scaled_s = Vector3d::Zero(), scaled_t = Vector3d::Zero();
    for (int k = 0; k < 4; ++k) {
      (inner[k] ? scaled_s : fixed_s) += bernstein[k] * planes[k].s_axis();
      (inner[k] ? scaled_t : fixed_t) += bernstein[k] * planes[k].t_axis();
    }
    const Vector3d along = volume.DerivativeAt(u).center();
    sum.base += kNodeWeight[n] * Det(along, fixed_s, fixed_t);
    sum.linear += kNodeWeight[n] * (Det(along, fixed_s, scaled_t) +
                                    Det(along, scaled_s, fixed_t));
    sum.square += kNodeWeight[n] * Det(along, scaled_s, scaled_t);
  }
}

// The larger root, or where the parabola comes nearest to `volume`.
double ScaleForVolume(const VolumeBySectionScale& by_scale, double volume) {
  const double a = by_scale.square;
  const double b = by_scale.linear;
  const double c = by_scale.base - volume;
  const double discriminant = std::max(0.0, b * b - 4 * a * c);
  // Without cancellation: b is positive in all but twisted wrecks.
  const double q = b + std::sqrt(discriminant);
  return q > 0 ? -2 * c / q : -b / (2 * a);
}

}  // namespace

class RigPose {
 public:
  RigPose(const VolumeRig& rig, const ConstVectorView& positions,
          VolumeFrame& frame)
      : rig_(rig), positions_(positions), frame_(frame) {
    const int links = rig.link_count();
    frame.rotations_.resize(links);
    frame.origins_.resize(links);
    frame.joint_rotations_.resize(links);
    frame.planes_.resize(kPlanesPerLink * links +
                         kPlanesPerStub * rig.stub_links_.size());
    frame.volumes_.resize(rig.volume_count());
    frame.volume_scales_.assign(links, 1);
    frame.wanted_scales_.assign(links, 1);
  }

  void Run(const RigidTransform& world_from_skeleton, bool with_muscles) {
    rig_.tree_.Evaluate(positions_, world_from_skeleton, frame_.kinematics_);
    for (int i = 0; i < rig_.link_count(); ++i) PlaceFrame(i);
    for (int i = 0; i < rig_.link_count(); ++i) PlaceEnds(i);
    for (int i = 0; i < rig_.link_count(); ++i) JoinEnd(i);
    size_t next_muscle = 0;
    for (int i = 0; i < rig_.link_count(); ++i) {
      PlaceInner(i, with_muscles, next_muscle);
      if (with_muscles) PreserveVolume(i);
      FillVolumes(i);
    }
  }

 private:
  ControlPlane* Planes(int link) {
    return frame_.planes_.data() + kPlanesPerLink * link;
  }
  ControlPlane* StubPlanes(int stub) {
    return frame_.planes_.data() + kPlanesPerLink * rig_.link_count() +
           kPlanesPerStub * stub;
  }

  void PlaceFrame(int i) {
    const SkinLink& link = rig_.links_[i];
    const auto joint = frame_.kinematics_.rotation(link.joint);
    frame_.rotations_[i] = joint * rig_.joints_[i].joint_from_link;
    frame_.origins_[i] = frame_.kinematics_.origin(link.joint) +
                         joint * link.joint_from_link.translation;
    if (link.parent < 0) {
      frame_.joint_rotations_[i] = frame_.rotations_[i];
    } else {
      frame_.joint_rotations_[i] =
          frame_.rotations_[link.parent] * HalfMotion(i).toRotationMatrix();
    }
  }

  // Of the link against its parent.
  Quaterniond HalfMotion(int i) const {
    const VolumeRig::JointMotion& motion = rig_.joints_[i];
    if (motion.hinge >= 0) {
      const double angle =
          ScalarPosition(*rig_.skeleton_, positions_, motion.hinge);
      return motion.parent_from_stem * HalfHinge(motion.stem_from_rest,
                                                 motion.axis,
                                                 angle - motion.rest_angle_rad);
    }
    if (motion.ball >= 0) {
      const int offset = rig_.skeleton_->span(motion.ball).quaternion_offset;
      return motion.parent_from_stem *
             HalfSwingAndTwist(motion.before *
                               QuaternionXyzw(positions_.data() + offset) *
                               motion.after);
    }
    const Matrix3d parent_from_link =
        frame_.rotations_[rig_.links_[i].parent].transpose() *
        frame_.rotations_[i];
    return motion.parent_from_stem *
           HalfSwingAndTwist(motion.parent_from_stem.conjugate() *
                             Quaterniond(parent_from_link));
  }

  // The plane through `center` of the joint at the start of link i, mitred.
  ControlPlane JointPlane(int i, const Vector3d& center) const {
    const Matrix3d& rotation = frame_.joint_rotations_[i];
    ControlPlane plane = PlaneOf(rotation, center);
    const double fullness = rig_.fullness_[i];
    if (fullness == 0) return plane;
    const Vector3d before =
        frame_.rotations_[rig_.links_[i].parent] *
        (rig_.joints_[i].parent_from_stem * Vector3d::UnitX());
    const Vector3d after = frame_.rotations_[i].col(0);
    Vector3d bend = after - before;
    bend -= bend.dot(rotation.col(0)) * rotation.col(0);
    const double length = bend.norm();
    if (length < kStraight) return plane;
    bend /= length;
    const double cosine = 0.5 * (after + before).norm();
    const double mitre = std::min(1 / cosine, kMaxMitre);
    const double growth = fullness * (mitre - 1);
    plane.columns.rightCols<2>() +=
        growth * bend * (bend.transpose() * plane.columns.rightCols<2>());
    return plane;
  }

  // P0, P1 and, with a stub, S0 .. S3; P5 and P6 of the link before.
  void PlaceEnds(int i) {
    const SkinLink& link = rig_.links_[i];
    const Matrix3d& joint = frame_.joint_rotations_[i];
    const Matrix3d& rotation = frame_.rotations_[i];
    const Vector3d& origin = frame_.origins_[i];
    const Vector3d step = rig_.start_spacings_[i] * joint.col(0);
    ControlPlane* planes = Planes(i);
    planes[0] = JointPlane(i, origin);
    planes[1] = JointPlane(i, origin + step);
    if (rig_.is_branch(i)) PlaceStub(i);
    if (link.continuation >= 0) return;
    const Vector3d end = origin + link.length_m * rotation.col(0);
    planes[5] =
        PlaneOf(rotation, end - rig_.end_spacings_[i] * rotation.col(0));
    planes[6] = PlaneOf(rotation, end);
  }

  void PlaceStub(int i) {
    const VolumeRig::JointMotion& motion = rig_.joints_[i];
    const int parent = rig_.links_[i].parent;
    const double spacing = rig_.start_spacings_[i];
    // Where the branch lies in the parent at rest, and so do S0 and S1.
    const Matrix3d rest =
        frame_.rotations_[parent] * motion.parent_from_stem.toRotationMatrix();
    const Vector3d root = frame_.origins_[parent] +
                          frame_.rotations_[parent] * motion.parent_origin;
    ControlPlane* stub = StubPlanes(rig_.stubs_[i]);
    stub[0] = PlaneOf(rest, root - 3 * spacing * rest.col(0));
    stub[1] = PlaneOf(rest, root - 2 * spacing * rest.col(0));
    stub[2] = JointPlane(
        i, frame_.origins_[i] - spacing * frame_.joint_rotations_[i].col(0));
    stub[3] = Middle(stub[2], Planes(i)[1]);
    Planes(i)[0] = stub[3];
  }

  // P5 and the plane in common with the link that goes on.
  void JoinEnd(int i) {
    const int next = rig_.links_[i].continuation;
    if (next < 0) return;
    ControlPlane* planes = Planes(i);
    planes[5] = JointPlane(
        next, frame_.origins_[next] -
                  rig_.end_spacings_[i] * frame_.joint_rotations_[next].col(0));
    planes[6] = Middle(planes[5], Planes(next)[1]);
    Planes(next)[0] = planes[6];
  }

  void PlaceInner(int i, bool with_muscles, size_t& next_muscle) {
    const SkinLink& link = rig_.links_[i];
    const double middle = 0.5 * link.length_m;
    const double step = 0.25 * (link.length_m - rig_.start_spacings_[i] -
                                rig_.end_spacings_[i]);
    // Offset of the centre and scale of the axes, for P2 and P4.
    Eigen::Vector2d offset_m[2] = {Eigen::Vector2d::Zero(),
                                   Eigen::Vector2d::Zero()};
    Eigen::Vector2d scale[2] = {Eigen::Vector2d::Ones(),
                                Eigen::Vector2d::Ones()};
    const auto& muscles = rig_.compiled_;
    for (; with_muscles && next_muscle < muscles.size() &&
           muscles[next_muscle].link == i;
         ++next_muscle) {
      const VolumeRig::CompiledMuscle& muscle = muscles[next_muscle];
      for (int k = 0; k < 2; ++k) {
        const Eigen::Vector2d factor = MuscleScale(muscle, k);
        offset_m[k] =
            muscle.pivot_m + factor.cwiseProduct(offset_m[k] - muscle.pivot_m);
        scale[k] = scale[k].cwiseProduct(factor);
      }
    }
    const Matrix3d& rotation = frame_.rotations_[i];
    ControlPlane* planes = Planes(i);
    for (int k = 0; k < 2; ++k) {
      const double x = middle + (k == 0 ? -step : step);
      planes[2 + 2 * k] = ControlPlane(
          frame_.origins_[i] +
              rotation * Vector3d(x, offset_m[k][0], offset_m[k][1]),
          scale[k][0] * rotation.col(1), scale[k][1] * rotation.col(2));
    }
    planes[3] = Middle(planes[2], planes[4]);
  }

  Eigen::Vector2d MuscleScale(const VolumeRig::CompiledMuscle& muscle,
                              int plane) const {
    if (muscle.mode == MuscleMode::kExplicit) return muscle.scales[plane];
    const double effort = 0.5 * (1 - FlexionCosine(muscle));
    return Eigen::Vector2d::Ones() + effort * muscle.scales[plane];
  }

  double FlexionCosine(const VolumeRig::CompiledMuscle& muscle) const {
    const Skeleton& skeleton = *rig_.skeleton_;
    const JointSpan& span = skeleton.span(muscle.driver);
    if (span.quaternion_offset >= 0) {
      const Quaterniond turn =
          muscle.driver_from_rest *
          QuaternionXyzw(positions_.data() + span.quaternion_offset);
      return 2 * turn.w() * turn.w() - 1;
    }
    const double angle =
        skeleton.joint(muscle.driver).type == JointType::kPlanar
            ? positions_[span.position_offset + 2]
            : ScalarPosition(skeleton, positions_, muscle.driver);
    return std::cos(angle - muscle.rest_angle_rad);
  }

  void PreserveVolume(int i) {
    const VolumeRig::VolumeGoal& goal = rig_.volume_goals_[i];
    if (goal.volume_per_section == 0) return;
    ControlPlane* planes = Planes(i);
    VolumeBySectionScale by_scale;
    AddVolume({planes, 4}, {false, false, true, true}, by_scale);
    AddVolume({planes + 3, 4}, {true, true, false, false}, by_scale);
    const double wanted = ScaleForVolume(by_scale, goal.volume_per_section);
    const double scale = std::clamp(wanted, goal.min_scale, goal.max_scale);
    frame_.wanted_scales_[i] = wanted;
    frame_.volume_scales_[i] = scale;
    for (int k = 2; k <= 4; ++k) {
      planes[k].columns.rightCols<2>() *= scale;
    }
  }

  void FillVolumes(int i) {
    const Matrix3d& rotation = frame_.rotations_[i];
    const absl::Span<const ControlPlane> planes(Planes(i), kPlanesPerLink);
    BezierVolume* volumes =
        frame_.volumes_.data() + VolumeRig::kVolumesPerLink * i;
    volumes[0] = BezierVolume::Between(planes.subspan(0, 4));
    volumes[1] = BezierVolume::Between(planes.subspan(3, 4));
    volumes[2] = BezierVolume::Affine(
        PlaneOf(rotation, frame_.origins_[i]),
        ControlPlane(rig_.links_[i].length_m * rotation.col(0),
                     Vector3d::Zero(), Vector3d::Zero()));
    const int stub = rig_.stubs_[i];
    if (stub < 0) return;
    frame_.volumes_[VolumeRig::kVolumesPerLink * rig_.link_count() + stub] =
        BezierVolume::Between({StubPlanes(stub), kPlanesPerStub});
  }

  const VolumeRig& rig_;
  const ConstVectorView& positions_;
  VolumeFrame& frame_;
};

void VolumeRig::Evaluate(const ConstVectorView& positions,
                         const RigidTransform& world_from_skeleton,
                         VolumeFrame& frame) const {
  RigPose(*this, positions, frame).Run(world_from_skeleton, true);
}

void VolumeRig::EvaluateRest() {
  RigPose(*this, rest_positions_, rest_).Run({}, false);
  for (int i = 0; i < link_count(); ++i) {
    VolumeGoal& goal = volume_goals_[i];
    if (goal.volume_per_section == 0) continue;
    goal.volume_per_section =
        rest_.volume(volume(i, VolumePart::kFirstHalf)).VolumePerSection() +
        rest_.volume(volume(i, VolumePart::kSecondHalf)).VolumePerSection();
  }
}

}  // namespace gelenk

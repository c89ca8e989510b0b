#include "gelenk/motion/mirror.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/motion/clip_frames.h"

namespace gelenk {
namespace {

// Joints of a symmetric body are so near to their images, of its size.
constexpr double kSymmetric = 0.02;
// Cosine up to which two axes are the same.
constexpr double kSameAxis = 0.999;
// Cosine between a mirror's normal and up from which its plane is not upright.
constexpr double kUpright = 0.3;

Eigen::Vector3d Image(const Eigen::Vector3d& normal,
                      const Eigen::Vector3d& vector) {
  return vector - 2 * normal.dot(vector) * normal;
}

// M_a R M_b for the mirrors across `a` and `b`: both are half a turn and an
// inversion, and the inversions cancel.
Eigen::Quaterniond BetweenMirrors(const Eigen::Vector3d& a,
                                  const Eigen::Quaterniond& rotation,
                                  const Eigen::Vector3d& b) {
  return QuaternionXyzw(a.x(), a.y(), a.z(), 0) * rotation *
         QuaternionXyzw(b.x(), b.y(), b.z(), 0);
}

WorldTransforms RestFrames(const Skeleton& skeleton) {
  WorldTransforms frames;
  ForwardKinematics(skeleton, skeleton.rest_positions(), frames);
  return frames;
}

char OtherSide(char c) {
  switch (c) {
    case 'l':
      return 'r';
    case 'r':
      return 'l';
    case 'L':
      return 'R';
    case 'R':
      return 'L';
    default:
      return 0;
  }
}

// Whether the letter at `i` stands by itself: between marks, or as the first of
// a word whose next letter is a capital (lHand, LWrist).
bool IsSideLetter(absl::string_view id, size_t i) {
  if (i > 0 && absl::ascii_isalnum(id[i - 1])) return false;
  return i + 1 == id.size() || !absl::ascii_isalnum(id[i + 1]) ||
         absl::ascii_isupper(id[i + 1]);
}

double SymmetryError(const WorldTransforms& rest,
                     const std::vector<int>& partner,
                     const Eigen::Vector3d& normal) {
  double worst = 0;
  for (size_t i = 0; i < partner.size(); ++i) {
    const Eigen::Vector3d own = rest[i].translation - rest[0].translation;
    const Eigen::Vector3d image =
        rest[partner[i]].translation - rest[0].translation;
    worst = std::max(worst, (Image(normal, own) - image).norm());
  }
  return worst;
}

// Of the world's axes and the mean way from right to left the one across which
// the rest pose is most symmetric.
void FindNormal(const WorldTransforms& rest, MirrorMap& map) {
  std::vector<Eigen::Vector3d> normals = {Eigen::Vector3d::UnitX(),
                                          Eigen::Vector3d::UnitZ(),
                                          Eigen::Vector3d::UnitY()};
  Eigen::Vector3d across = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < map.partner.size(); ++i) {
    Eigen::Vector3d way =
        rest[i].translation - rest[map.partner[i]].translation;
    if (way.dot(across) < 0) way = -way;
    across += way;
  }
  if (across.norm() > 0) normals.push_back(across.normalized());
  map.symmetry_error_m = INFINITY;
  for (const Eigen::Vector3d& normal : normals) {
    const double error = SymmetryError(rest, map.partner, normal);
    // The world's axes unless another is clearly better.
    if (error >= 0.9 * map.symmetry_error_m) continue;
    map.symmetry_error_m = error;
    map.rest_normal = normal;
  }
}

bool PairByNames(const Skeleton& skeleton, MirrorMap& map) {
  absl::flat_hash_map<absl::string_view, int> joint_of_id;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    joint_of_id[skeleton.joint(i).id] = i;
  }
  bool any = false;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    map.partner[i] = i;
    bool has_side = false;
    for (const std::string& name : OtherSideNames(skeleton.joint(i).id)) {
      has_side = true;
      const auto found = joint_of_id.find(name);
      if (found == joint_of_id.end()) continue;
      if (skeleton.joint(found->second).type != skeleton.joint(i).type) {
        continue;
      }
      map.partner[i] = found->second;
      any = true;
      break;
    }
    if (has_side && map.partner[i] == i) map.unpaired.push_back(i);
  }
  // Both ways, or not at all.
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    if (map.partner[map.partner[i]] == i) continue;
    map.partner[i] = i;
    map.unpaired.push_back(i);
  }
  return any;
}

bool PairByRest(const Skeleton& skeleton, const WorldTransforms& rest,
                const Eigen::Vector3d& normal, double size, MirrorMap& map) {
  const int count = skeleton.joint_count();
  std::vector<bool> taken(count, false);
  bool any = false;
  map.partner[0] = 0;
  for (int i = 1; i < count; ++i) {
    const int parent = skeleton.span(i).parent;
    const Eigen::Vector3d image =
        Image(normal, rest[i].translation - rest[0].translation) +
        rest[0].translation;
    int best = -1;
    double nearest = kSymmetric * size;
    for (int k = 1; k < count; ++k) {
      if (taken[k] || skeleton.span(k).parent != map.partner[parent] ||
          skeleton.joint(k).type != skeleton.joint(i).type) {
        continue;
      }
      const double distance = (rest[k].translation - image).norm();
      if (distance >= nearest) continue;
      nearest = distance;
      best = k;
    }
    if (best < 0) return false;
    taken[best] = true;
    map.partner[i] = best;
    any |= best != i;
  }
  for (int i = 0; i < count; ++i) {
    if (map.partner[map.partner[i]] != i) return false;
  }
  return any;
}

double AxisSign(const Skeleton& skeleton, const WorldTransforms& rest,
                const MirrorMap& map, int joint, double* cosine) {
  const int partner = map.partner[joint];
  const Eigen::Vector3d image =
      Image(map.rest_normal, rest[joint].rotation * skeleton.joint(joint).axis);
  double along =
      image.dot(rest[partner].rotation * skeleton.joint(partner).axis);
  // A turn's image is about the image of its axis the other way round.
  if (skeleton.joint(joint).type == JointType::kRevolute) along = -along;
  if (cosine != nullptr) *cosine = std::abs(along);
  return along < 0 ? -1 : 1;
}

// How the numbers (u, v, angle) of a planar joint map to its partner's.
Eigen::Matrix3d PlanarImage(const Skeleton& skeleton,
                            const WorldTransforms& rest, const MirrorMap& map,
                            int joint) {
  const auto world_basis = [&](int i) {
    const int parent = skeleton.span(i).parent;
    const Joint& planar = skeleton.joint(i);
    const Eigen::Quaterniond before =
        parent < 0 ? planar.parent_from_joint.rotation
                   : rest[parent].rotation * planar.parent_from_joint.rotation;
    return Eigen::Matrix3d(before * PlanarBasis(planar.axis));
  };
  Eigen::Matrix3d image = world_basis(joint);
  for (int k = 0; k < 3; ++k) {
    image.col(k) = Image(map.rest_normal, image.col(k));
  }
  Eigen::Matrix3d result = world_basis(map.partner[joint]).transpose() * image;
  result(2, 2) = -result(2, 2);
  return result;
}

}  // namespace

std::vector<std::string> OtherSideNames(absl::string_view id) {
  std::vector<std::string> names;
  const std::string swapped = absl::StrReplaceAll(id, {{"Left", "Right"},
                                                       {"Right", "Left"},
                                                       {"left", "right"},
                                                       {"right", "left"},
                                                       {"LEFT", "RIGHT"},
                                                       {"RIGHT", "LEFT"}});
  if (swapped != id) names.push_back(swapped);
  for (size_t i = 0; i < id.size(); ++i) {
    const char other = OtherSide(id[i]);
    if (other == 0 || !IsSideLetter(id, i)) continue;
    std::string name(id);
    name[i] = other;
    names.push_back(std::move(name));
  }
  return names;
}

absl::StatusOr<MirrorMap> FindMirrorMap(const Skeleton& skeleton) {
  const WorldTransforms rest = RestFrames(skeleton);
  Eigen::AlignedBox3d box;
  for (const RigidTransform& frame : rest) box.extend(frame.translation);
  MirrorMap map;
  map.partner.resize(skeleton.joint_count());
  map.by_names = PairByNames(skeleton, map);
  if (!map.by_names) {
    map.unpaired.clear();
    const double size = box.sizes().maxCoeff();
    bool is_paired = false;
    for (const Eigen::Vector3d& normal :
         {Eigen::Vector3d(Eigen::Vector3d::UnitX()),
          Eigen::Vector3d(Eigen::Vector3d::UnitZ()),
          Eigen::Vector3d(Eigen::Vector3d::UnitY())}) {
      is_paired = PairByRest(skeleton, rest, normal, size, map);
      if (is_paired) break;
    }
    if (!is_paired) {
      return absl::FailedPreconditionError(
          "skeleton: neither names nor the rest pose tell left from right");
    }
  }
  FindNormal(rest, map);
  const Eigen::Vector3d& up = skeleton.up();
  map.world_normal = map.rest_normal;
  if (std::abs(map.rest_normal.dot(up)) > kUpright) {
    // The rest pose lies; any upright plane will do.
    map.world_normal = std::abs(up.x()) < kUpright ? Eigen::Vector3d::UnitX()
                                                   : Eigen::Vector3d::UnitZ();
  }
  map.world_normal =
      (map.world_normal - map.world_normal.dot(up) * up).normalized();
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const JointType type = skeleton.joint(i).type;
    if (type != JointType::kRevolute && type != JointType::kPrismatic) continue;
    double cosine = 1;
    AxisSign(skeleton, rest, map, i, &cosine);
    if (cosine < kSameAxis) map.skewed.push_back(i);
  }
  return map;
}

void MirrorPose(const Skeleton& skeleton, const MirrorMap& map,
                const ConstVectorView& positions, VectorView mirrored) {
  const WorldTransforms rest = RestFrames(skeleton);
  const Eigen::VectorXd& q0 = skeleton.rest_positions();
  WorldTransforms frames;
  ForwardKinematics(skeleton, positions, frames);
  WorldTransforms images(skeleton.joint_count());
  for (int m = 0; m < skeleton.joint_count(); ++m) {
    const int j = map.partner[m];
    const Joint& joint = skeleton.joint(m);
    const int parent = skeleton.span(m).parent;
    const RigidTransform before =
        parent < 0 ? joint.parent_from_joint
                   : images[parent] * joint.parent_from_joint;
    const int to = skeleton.span(m).position_offset;
    const int from = skeleton.span(j).position_offset;
    if (to >= 0 && from >= 0) {
      const Eigen::Quaterniond image =
          BetweenMirrors(map.world_normal,
                         frames[j].rotation * rest[j].rotation.conjugate(),
                         map.rest_normal) *
          rest[m].rotation;
      const Eigen::Quaterniond local =
          (before.rotation.conjugate() * image).normalized();
      switch (joint.type) {
        case JointType::kFixed:
          break;
        case JointType::kRevolute:
        case JointType::kPrismatic:
          mirrored[to] = q0[to] + AxisSign(skeleton, rest, map, j, nullptr) *
                                      (positions[from] - q0[from]);
          break;
        case JointType::kPlanar:
          mirrored.segment<3>(to) =
              q0.segment<3>(to) +
              PlanarImage(skeleton, rest, map, j) *
                  (positions.segment<3>(from) - q0.segment<3>(from));
          break;
        case JointType::kSpherical:
          StoreXyzw(local, mirrored.data() + to);
          break;
        case JointType::kFree:
          mirrored.segment<3>(to) =
              before.Inverse() * Image(map.world_normal, frames[j].translation);
          StoreXyzw(local, mirrored.data() + to + 3);
          break;
      }
    }
    images[m] = before * JointMotion(skeleton, m, mirrored);
  }
}

absl::StatusOr<MotionClip> MirrorClip(const MotionClip& clip,
                                      const MirrorMap& map) {
  const Skeleton& skeleton = *clip.skeleton();
  if (map.partner.size() != static_cast<size_t>(skeleton.joint_count())) {
    return absl::InvalidArgumentError(
        absl::StrFormat("map: want %d joints, got %d", skeleton.joint_count(),
                        map.partner.size()));
  }
  const absl::StatusOr<Eigen::MatrixXd> frames = FramesFromClip(clip);
  if (!frames.ok()) return frames.status();
  Eigen::MatrixXd mirrored = *frames;
  for (Eigen::Index i = 0; i < frames->cols(); ++i) {
    MirrorPose(skeleton, map, frames->col(i), mirrored.col(i));
  }
  ClipProperties properties = clip.properties();
  properties.frame_time_s = FrameTimeOf(clip);
  MirrorPose(skeleton, map, clip.properties().base_positions,
             properties.base_positions);
  return ClipFromFrames(clip.skeleton(), mirrored, std::move(properties));
}

}  // namespace gelenk

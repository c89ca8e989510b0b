#include "convert/skin_deformer.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "convert/geometry.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk::convert {
namespace {

constexpr int kDefaultInfluences = 4;
constexpr int kMatrixSize = 12;

SkinLinkOverride FromProto(const v1::SkinLinkOverride& proto) {
  SkinLinkOverride result;
  result.joint_id = proto.joint_id();
  result.omit = proto.omit();
  if (proto.has_length_m()) result.length_m = proto.length_m();
  if (proto.has_direction()) {
    result.direction = convert::FromProto(proto.direction());
  }
  if (proto.has_s_direction()) {
    result.s_direction = convert::FromProto(proto.s_direction());
  }
  // One without the other reads as 0, which is refused.
  if (proto.has_half_extent_s_m() || proto.has_half_extent_t_m()) {
    result.half_extents_m =
        Eigen::Vector2d(proto.half_extent_s_m(), proto.half_extent_t_m());
  }
  if (proto.has_continuation_joint_id()) {
    result.continuation_joint_id = proto.continuation_joint_id();
  }
  return result;
}

// The index in the skeleton of each joint that is named; -1 for a bad one.
std::vector<int> FindJoints(const Skeleton& skeleton,
                            const v1::VertexWeights& proto,
                            Violations& violations) {
  std::vector<int> joints;
  std::vector<bool> seen(skeleton.joint_count(), false);
  for (int i = 0; i < proto.joint_ids_size(); ++i) {
    const int joint = skeleton.FindJoint(proto.joint_ids(i));
    joints.push_back(joint);
    if (joint >= 0 && !seen[joint]) {
      seen[joint] = true;
      continue;
    }
    violations.Add(absl::StrCat("joint_ids[", i, "]"),
                   absl::StrCat(joint < 0 ? "no joint " : "is there twice: ",
                                QuotedId(proto.joint_ids(i))));
  }
  return joints;
}

}  // namespace

SkinLinkOptions FromProto(const v1::LayeredVolumes& proto) {
  SkinLinkOptions options;
  if (proto.has_slenderness()) options.slenderness = proto.slenderness();
  for (const v1::SkinLinkOverride& link : proto.overrides()) {
    options.overrides.push_back(FromProto(link));
  }
  return options;
}

absl::StatusOr<WeightsOfJoints> FromProto(const Skeleton& skeleton,
                                          const v1::VertexWeights& proto) {
  Violations violations;
  const std::vector<int> joints = FindJoints(skeleton, proto, violations);
  WeightsOfJoints result;
  result.weights.influences_per_vertex = proto.influences_per_vertex() == 0
                                             ? kDefaultInfluences
                                             : proto.influences_per_vertex();
  result.weights.weights.assign(proto.weights().begin(), proto.weights().end());
  result.weights.joints.reserve(proto.joints_size());
  for (int i = 0; i < proto.joints_size(); ++i) {
    const int at = proto.joints(i);
    const bool is_known = at >= 0 && at < static_cast<int>(joints.size());
    result.weights.joints.push_back(is_known ? joints[at] : -1);
    if (is_known) continue;
    violations.Add(absl::StrCat("joints[", i, "]"),
                   absl::StrCat("want 0 to ", joints.size(),
                                " - 1, as joint_ids, got ", at));
  }
  const int numbers = proto.joint_from_mesh_size();
  if (numbers > 0 && numbers != kMatrixSize * static_cast<int>(joints.size())) {
    violations.Add("joint_from_mesh",
                   absl::StrCat("want none or ", kMatrixSize, " for each of ",
                                joints.size(), " joints, got ", numbers));
  }
  if (!violations.empty()) return violations.ToStatus();
  if (numbers > 0) {
    // Joints that are not named move nothing.
    WeightedSkin::Affine identity;
    identity.setIdentity();
    result.joint_from_mesh.assign(skeleton.joint_count(), identity);
    for (size_t i = 0; i < joints.size(); ++i) {
      result.joint_from_mesh[joints[i]] =
          Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(
              proto.joint_from_mesh().data() + kMatrixSize * i);
    }
  }
  return result;
}

void ToProto(const VolumeRig& rig, int index, v1::SkinLink* proto) {
  const SkinLink& link = rig.link(index);
  proto->set_link_id(link.id);
  proto->set_parent(link.parent);
  proto->set_continuation(link.continuation);
  proto->set_length_m(link.length_m);
  proto->set_half_extent_s_m(link.half_extents_m.x());
  proto->set_half_extent_t_m(link.half_extents_m.y());
  proto->set_start_spacing_m(rig.start_spacing_m(index));
  proto->set_end_spacing_m(rig.end_spacing_m(index));
  proto->set_is_branch(rig.is_branch(index));
}

}  // namespace gelenk::convert

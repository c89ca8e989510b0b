#include "gelenk/import/joined_mesh.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

using Eigen::Affine3d;

// Two bindings of a joint are the same when vertices come out so near, as a
// part of the mesh's size.
constexpr double kSameBinding = 1e-5;

// Nothing that a joint moves is so far from where it was bound.
constexpr double kMaxMagnitude = 1e9;

// Below that part of its size a matrix has no inverse worth the name.
constexpr double kFlat = 1e-9;

absl::Status Fault(absl::string_view path, absl::string_view reason) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": ", reason));
}

}  // namespace

bool IsFlat(const Affine3d& transform) {
  const double size = transform.linear().norm();
  // Written so that NaN is flat.
  return !(std::abs(transform.linear().determinant()) >
           kFlat * size * size * size);
}

absl::Status JoinedMesh::Append(const GltfMesh& mesh,
                                const MeshBinding& binding) {
  // Of each joint of the binding, over all vertices.
  std::vector<double> weights(binding.joints.size(), 0);
  for (const GltfInfluence& influence : mesh.influences) {
    if (influence.joint >= static_cast<int>(weights.size())) {
      return Fault(
          binding.path,
          absl::StrFormat("want a joint, 0 to %d, of every vertex, got "
                          "%d",
                          weights.size() - 1, influence.joint));
    }
    weights[influence.joint] += influence.weight;
  }
  const absl::StatusOr<Affine3d> place = Place(binding, weights);
  if (!place.ok()) return place.status();
  TriangleMesh& joined = mesh_;
  const int first = static_cast<int>(joined.positions.size());
  const bool is_mirrored = place->linear().determinant() < 0;
  double size_m = 0;
  for (const Eigen::Vector3d& position : mesh.surface.positions) {
    joined.positions.push_back(*place * position);
    size_m = std::max(size_m, joined.positions.back().norm());
  }
  // Of normals; a mirror leaves them on their side.
  const Eigen::Matrix3d inverse_transpose =
      place->linear().inverse().transpose();
  for (const Eigen::Vector3d& normal : mesh.surface.normals) {
    joined.normals.push_back((inverse_transpose * normal).stableNormalized());
  }
  for (Triangle triangle : mesh.surface.triangles) {
    if (is_mirrored) std::swap(triangle[1], triangle[2]);
    joined.triangles.emplace_back(triangle.array() + first);
  }
  if (absl::Status status = Bind(binding, weights, *place, size_m);
      !status.ok()) {
    return status;
  }
  size_t next = 0;
  for (size_t end : mesh.influence_ends) {
    if (next == end) {
      ++weightless_;
      influences_.push_back({binding.joints[0], 1});
    }
    for (; next < end; ++next) {
      influences_.push_back({binding.joints[mesh.influences[next].joint],
                             mesh.influences[next].weight});
    }
    influence_ends_.push_back(influences_.size());
  }
  return absl::OkStatus();
}

absl::StatusOr<Affine3d> JoinedMesh::Place(
    const MeshBinding& binding, const std::vector<double>& weights) const {
  // The joint with most of the mesh, of those bound already if there are any.
  const auto rank = [&](size_t i) {
    return std::pair(weights[i] > 0 && rest_from_bound_[binding.joints[i]],
                     weights[i]);
  };
  size_t best = 0;
  for (size_t i = 1; i < weights.size(); ++i) {
    if (rank(i) > rank(best)) best = i;
  }
  const Affine3d& moved = binding.skeleton_from_mesh[best];
  if (IsFlat(moved)) {
    return Fault(
        binding.path,
        absl::StrFormat("the matrix of joint %d has no inverse", best));
  }
  const auto& bound = rest_from_bound_[binding.joints[best]];
  return bound ? bound->inverse() * moved : moved;
}

absl::Status JoinedMesh::Bind(const MeshBinding& binding,
                              const std::vector<double>& weights,
                              const Affine3d& skeleton_from_mesh,
                              double size_m) {
  const Affine3d mesh_from_skeleton = skeleton_from_mesh.inverse();
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) continue;
    const Affine3d moved = binding.skeleton_from_mesh[i] * mesh_from_skeleton;
    // Written so that NaN is too large.
    if (!(moved.matrix().cwiseAbs().maxCoeff() <= kMaxMagnitude)) {
      return Fault(binding.path,
                   absl::StrFormat("the matrix of joint %d is too large", i));
    }
    std::optional<Affine3d>& bound = rest_from_bound_[binding.joints[i]];
    if (!bound) {
      bound = moved;
      continue;
    }
    const double apart_m = (moved.linear() - bound->linear()).norm() * size_m +
                           (moved.translation() - bound->translation()).norm();
    if (apart_m > kSameBinding * size_m) {
      return Fault(
          binding.path,
          absl::StrFormat("binds joint %s in another place than a mesh before; "
                          "take one of the meshes",
                          QuotedId(skeleton_.joint(binding.joints[i]).id)));
    }
  }
  return absl::OkStatus();
}

SkinWeights JoinedMesh::PackedWeights() const {
  size_t most = 1;
  size_t first = 0;
  for (size_t end : influence_ends_) {
    most = std::max(most, end - first);
    first = end;
  }
  SkinWeights weights;
  weights.influences_per_vertex = static_cast<int>(most);
  weights.joints.assign(most * influence_ends_.size(), 0);
  weights.weights.assign(most * influence_ends_.size(), 0);
  first = 0;
  for (size_t v = 0; v < influence_ends_.size(); ++v) {
    double sum = 0;
    for (size_t i = first; i < influence_ends_[v]; ++i) {
      sum += influences_[i].weight;
    }
    for (size_t i = first; i < influence_ends_[v]; ++i) {
      weights.joints[most * v + i - first] = influences_[i].joint;
      weights.weights[most * v + i - first] = influences_[i].weight / sum;
    }
    first = influence_ends_[v];
  }
  return weights;
}

std::vector<WeightedSkin::Affine> JoinedMesh::JointFromMesh() const {
  WorldTransforms rest;
  ForwardKinematics(skeleton_, skeleton_.rest_positions(), rest);
  std::vector<WeightedSkin::Affine> joint_from_mesh;
  for (size_t i = 0; i < rest.size(); ++i) {
    const RigidTransform inverse = rest[i].Inverse();
    const Affine3d joint_from_skeleton =
        Eigen::Translation3d(inverse.translation) * inverse.rotation;
    joint_from_mesh.push_back(
        (joint_from_skeleton *
         rest_from_bound_[i].value_or(Affine3d::Identity()))
            .matrix()
            .topRows<3>());
  }
  return joint_from_mesh;
}

}  // namespace gelenk

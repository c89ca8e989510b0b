#include "gelenk/skin/weighted_skin.h"

#include <Eigen/Geometry>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;
using DualQuaternion = Eigen::Matrix<float, 8, 1>;  // x y z w, then the dual's

// How far a matrix may be from a rotation and still be taken for one.
constexpr double kRigidTolerance = 1e-3;

void CheckWeights(const Skeleton& skeleton, size_t vertex_count,
                  const SkinWeights& weights, Violations& violations) {
  const int count = weights.influences_per_vertex;
  if (count < 1 || count > kMaxInfluences) {
    violations.Add("influences_per_vertex",
                   absl::StrCat("want 1 to ", kMaxInfluences, ", got ", count));
    return;
  }
  const size_t size = vertex_count * count;
  if (weights.joints.size() != size) {
    violations.Add("joints", absl::StrCat("want ", size, " numbers, got ",
                                          weights.joints.size()));
  }
  if (weights.weights.size() != size) {
    violations.Add("weights", absl::StrCat("want ", size, " numbers, got ",
                                           weights.weights.size()));
  }
  if (!violations.empty()) return;
  for (size_t i = 0; i < size; ++i) {
    if (weights.joints[i] < 0 || weights.joints[i] >= skeleton.joint_count()) {
      violations.Add(absl::StrCat("joints[", i, "]"),
                     absl::StrCat("want 0 to ", skeleton.joint_count() - 1,
                                  ", got ", weights.joints[i]));
    }
    if (!(weights.weights[i] >= 0 && std::isfinite(weights.weights[i]))) {
      violations.Add(absl::StrCat("weights[", i, "]"),
                     absl::StrCat("want >= 0, got ", weights.weights[i]));
    }
  }
  for (size_t v = 0; v < vertex_count && violations.empty(); ++v) {
    double sum = 0;
    for (int k = 0; k < count; ++k) sum += weights.weights[count * v + k];
    if (!(sum > 0 && std::isfinite(sum))) {
      violations.Add(absl::StrCat("weights[", count * v, "]"),
                     absl::StrCat("vertex ", v, ": the sum is ", sum));
    }
  }
}

bool IsRigid(const WeightedSkin::Affine& matrix) {
  const Eigen::Matrix3d rotation = matrix.leftCols<3>();
  return (rotation * rotation.transpose() - Eigen::Matrix3d::Identity())
                 .norm() <= kRigidTolerance &&
         rotation.determinant() > 0;
}

void CheckMatrices(const Skeleton& skeleton,
                   const WeightedSkin::Options& options,
                   Violations& violations) {
  const auto& matrices = options.joint_from_mesh;
  if (matrices.empty()) return;
  if (static_cast<int>(matrices.size()) != skeleton.joint_count()) {
    violations.Add("joint_from_mesh",
                   absl::StrCat("want none or ", skeleton.joint_count(),
                                ", got ", matrices.size()));
    return;
  }
  for (size_t i = 0; i < matrices.size(); ++i) {
    const std::string field = absl::StrCat("joint_from_mesh[", i, "]");
    if (!matrices[i].allFinite()) {
      violations.Add(field, "want finite numbers");
    } else if (options.method == BlendMethod::kDualQuaternion &&
               !IsRigid(matrices[i])) {
      violations.Add(field, "is not rigid, as dual quaternions are");
    }
  }
}

WeightedSkin::Affine AffineOf(const RigidTransform& transform) {
  WeightedSkin::Affine matrix;
  matrix << transform.rotation.toRotationMatrix(), transform.translation;
  return matrix;
}

// transform * matrix
WeightedSkin::Affine Moved(const RigidTransform& transform,
                           const WeightedSkin::Affine& matrix) {
  WeightedSkin::Affine moved = transform.rotation.toRotationMatrix() * matrix;
  moved.col(3) += transform.translation;
  return moved;
}

// Normals go with the cofactors, the inverse transpose but for scale; it is
// there also where the matrix is flat.
template <typename Number>
Eigen::Matrix<Number, 3, 1> MovedNormal(
    const Eigen::Matrix<Number, 3, 4>& matrix,
    const Eigen::Matrix<Number, 3, 1>& n) {
  const Eigen::Matrix<Number, 3, 1> x = matrix.col(0), y = matrix.col(1),
                                    z = matrix.col(2);
  return (n[0] * y.cross(z) + n[1] * z.cross(x) + n[2] * x.cross(y))
      .stableNormalized();
}

Eigen::VectorXd BindPose(const Skeleton& skeleton,
                         const WeightedSkin::Options& options) {
  return options.rest_positions.size() == 0 ? skeleton.rest_positions()
                                            : options.rest_positions;
}

// Those of the options, or those of the pose at which the mesh is bound.
std::vector<WeightedSkin::Affine> JointFromMesh(
    const Skeleton& skeleton, const WeightedSkin::Options& options) {
  if (!options.joint_from_mesh.empty()) return options.joint_from_mesh;
  WorldTransforms world_from_joints;
  ForwardKinematics(skeleton, BindPose(skeleton, options), world_from_joints);
  std::vector<WeightedSkin::Affine> joint_from_mesh;
  for (const RigidTransform& world_from_joint : world_from_joints) {
    joint_from_mesh.push_back(AffineOf(world_from_joint.Inverse()));
  }
  return joint_from_mesh;
}

DualQuaternion DualQuaternionOf(const Matrix3f& rotation,
                                const Vector3f& translation) {
  const Eigen::Quaternionf q = Eigen::Quaternionf(rotation).normalized();
  DualQuaternion dual;
  dual.head<4>() = q.coeffs();
  const Eigen::Quaternionf moved =
      Eigen::Quaternionf(0, translation.x(), translation.y(), translation.z()) *
      q;
  dual.tail<4>() = 0.5f * moved.coeffs();
  return dual;
}

}  // namespace

SkinWeights RigidWeights(int vertex_count, int joint) {
  SkinWeights weights;
  weights.influences_per_vertex = 1;
  weights.joints.assign(vertex_count, joint);
  weights.weights.assign(vertex_count, 1);
  return weights;
}

absl::StatusOr<std::shared_ptr<const WeightedSkin>> WeightedSkin::Create(
    const std::shared_ptr<const Skeleton>& skeleton, const TriangleMesh& mesh,
    const SkinWeights& weights, const Options& options) {
  Violations violations;
  violations.AddStatus("mesh", CheckMesh(mesh));
  CheckWeights(*skeleton, mesh.positions.size(), weights, violations);
  CheckMatrices(*skeleton, options, violations);
  Options checked = options;
  checked.rest_positions = BindPose(*skeleton, options);
  violations.AddStatus("rest",
                       CheckPositions(*skeleton, checked.rest_positions));
  if (absl::Status status = violations.ToStatus(); !status.ok()) return status;
  return std::shared_ptr<const WeightedSkin>(
      new WeightedSkin(skeleton, mesh, weights, checked));
}

WeightedSkin::WeightedSkin(const std::shared_ptr<const Skeleton>& skeleton,
                           const TriangleMesh& mesh, const SkinWeights& weights,
                           const Options& options)
    : Skin(skeleton, SlotsInOrder(static_cast<int>(mesh.positions.size())),
           BlocksFor(static_cast<int>(mesh.positions.size())), mesh.triangles,
           RestMesh(*skeleton, mesh, weights, options).positions,
           skeleton->rest_positions()),
      method_(options.method),
      influences_(weights.influences_per_vertex),
      rigid_joint_(options.rigid_joint),
      joints_(weights.joints),
      joint_from_mesh_(JointFromMesh(*skeleton, options)) {
  for (size_t i = 0; i < weights.weights.size(); i += influences_) {
    double sum = 0;
    for (int k = 0; k < influences_; ++k) sum += weights.weights[i + k];
    for (int k = 0; k < influences_; ++k) {
      weights_.push_back(static_cast<float>(weights.weights[i + k] / sum));
    }
  }
  for (const Eigen::Vector3d& position : mesh.positions) {
    positions_.push_back(position.cast<float>());
  }
  for (const Eigen::Vector3d& normal : VertexNormals(mesh)) {
    normals_.push_back(normal.cast<float>());
  }
}

void WeightedSkin::Deform(const ConstVectorView& positions,
                          const RigidTransform& world_from_skeleton,
                          SkinWorkspace& workspace,
                          VertexBlocks& blocks) const {
  ForwardKinematics(skeleton(), positions, world_from_skeleton,
                    workspace.world_from_joints);
  const int joint_count = skeleton().joint_count();
  workspace.world_from_bind.resize(joint_count);
  for (int i = 0; i < joint_count; ++i) {
    workspace.world_from_bind[i] =
        Moved(workspace.world_from_joints[i], joint_from_mesh_[i])
            .cast<float>();
  }
  blocks.Resize(block_count());
  if (method_ == BlendMethod::kLinear) {
    ForParts(workspace, vertex_count(), kSingleVerticesPerPart,
             [&](int first, int end) {
               BlendLinearly(workspace, first, end, blocks);
             });
    return;
  }
  workspace.dual_quaternions.resize(joint_count);
  for (int i = 0; i < joint_count; ++i) {
    workspace.dual_quaternions[i] =
        DualQuaternionOf(workspace.world_from_bind[i].leftCols<3>(),
                         workspace.world_from_bind[i].col(3));
  }
  ForParts(workspace, vertex_count(), kSingleVerticesPerPart,
           [&](int first, int end) {
             BlendDualQuaternions(workspace, first, end, blocks);
           });
}

void WeightedSkin::BlendLinearly(const SkinWorkspace& workspace,
                                 int first_vertex, int end_vertex,
                                 VertexBlocks& blocks) const {
  for (int v = first_vertex; v < end_vertex; ++v) {
    const int first = influences_ * v;
    Eigen::Matrix<float, 3, 4> blended =
        weights_[first] * workspace.world_from_bind[joints_[first]];
    for (int k = 1; k < influences_; ++k) {
      blended +=
          weights_[first + k] * workspace.world_from_bind[joints_[first + k]];
    }
    blocks.Set(v, blended.leftCols<3>() * positions_[v] + blended.col(3),
               MovedNormal(blended, normals_[v]));
  }
}

void WeightedSkin::BlendDualQuaternions(const SkinWorkspace& workspace,
                                        int first_vertex, int end_vertex,
                                        VertexBlocks& blocks) const {
  for (int v = first_vertex; v < end_vertex; ++v) {
    const int first = influences_ * v;
    const DualQuaternion& pivot = workspace.dual_quaternions[joints_[first]];
    DualQuaternion blended = weights_[first] * pivot;
    for (int k = 1; k < influences_; ++k) {
      const DualQuaternion& other =
          workspace.dual_quaternions[joints_[first + k]];
      // The way round that is shorter.
      const float sign =
          pivot.head<4>().dot(other.head<4>()) < 0 ? -1.0f : 1.0f;
      blended += sign * weights_[first + k] * other;
    }
    blended /= blended.head<4>().norm();
    const Vector3f real = blended.head<3>();
    const Vector3f dual = blended.segment<3>(4);
    const float w = blended[3];
    const auto rotate = [&](const Vector3f& p) -> Vector3f {
      return p + 2 * real.cross(real.cross(p) + w * p);
    };
    const Vector3f translation =
        2 * (w * dual - blended[7] * real + real.cross(dual));
    blocks.Set(v, rotate(positions_[v]) + translation, rotate(normals_[v]));
  }
}

TriangleMesh RestMesh(const Skeleton& skeleton, const TriangleMesh& mesh,
                      const SkinWeights& weights,
                      const WeightedSkin::Options& options) {
  WorldTransforms rest;
  ForwardKinematics(skeleton, skeleton.rest_positions(), rest);
  const std::vector<WeightedSkin::Affine> joint_from_mesh =
      JointFromMesh(skeleton, options);
  std::vector<WeightedSkin::Affine> rest_from_mesh;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    rest_from_mesh.push_back(Moved(rest[i], joint_from_mesh[i]));
  }
  TriangleMesh moved;
  moved.triangles = mesh.triangles;
  const std::vector<Eigen::Vector3d> normals = VertexNormals(mesh);
  const int count = weights.influences_per_vertex;
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    WeightedSkin::Affine blended = WeightedSkin::Affine::Zero();
    double sum = 0;
    for (size_t i = count * v; i < count * (v + 1); ++i) {
      blended += weights.weights[i] * rest_from_mesh[weights.joints[i]];
      sum += weights.weights[i];
    }
    blended /= sum;
    moved.positions.push_back(blended.leftCols<3>() * mesh.positions[v] +
                              blended.col(3));
    moved.normals.push_back(MovedNormal(blended, normals[v]));
  }
  return moved;
}

size_t WeightedSkin::ByteSize() const {
  return Skin::ByteSize() + sizeof(*this) + joints_.size() * sizeof(int) +
         weights_.size() * sizeof(float) +
         (positions_.size() + normals_.size()) * sizeof(Vector3f) +
         joint_from_mesh_.size() * sizeof(Affine);
}

}  // namespace gelenk

#include "gelenk/skin/example_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "gelenk/base/violations.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "gelenk/skin/mesh_around.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

constexpr absl::string_view kNames[] = {"cylinder", "arm", "leg", "humanoid"};
constexpr int kLeastVertices = 100;
constexpr int kMostVertices = 100000;
// Of the thickest limb's radius.
constexpr double kCoarseCell = 0.25;

// A limb at rest: world frame, m. Capsules of one joint may be several.
struct Limb {
  const char* id;
  const char* parent;
  JointType type;
  Vector3d joint;
  Vector3d end;
  double joint_radius_m;
  double end_radius_m;
};

// Bones run along the x of their joints, as the skin's links do; hinges turn
// about z.
class BodyBuilder {
 public:
  explicit BodyBuilder(const Vector3d& hinge_axis) : hinge_axis_(hinge_axis) {}

  void Add(const Limb& limb) {
    RigidTransform world_from_joint;
    const Vector3d x = (limb.end - limb.joint).normalized();
    const Vector3d z =
        (hinge_axis_ - hinge_axis_.dot(x) * x).stableNormalized();
    Eigen::Matrix3d axes;
    axes << x, z.cross(x), z;
    world_from_joint.rotation = Eigen::Quaterniond(axes).normalized();
    world_from_joint.translation = limb.joint;
    Joint joint;
    joint.id = limb.id;
    joint.parent_id = limb.parent;
    joint.type = limb.type;
    joint.axis = limb.type == JointType::kRevolute ? Vector3d::UnitZ()
                                                   : Vector3d::UnitX();
    joint.parent_from_joint = world_from_joint;
    for (size_t i = 0; i < ids_.size(); ++i) {
      if (ids_[i] != joint.parent_id) continue;
      joint.parent_from_joint =
          world_from_joints_[i].Inverse() * world_from_joint;
    }
    joint.parent_from_joint.rotation.normalize();
    joint.link_length_m = (limb.end - limb.joint).norm();
    builder_.AddJoint(joint);
    ids_.push_back(joint.id);
    world_from_joints_.push_back(world_from_joint);
    AddFlesh(limb);
  }

  // Flesh without a joint of its own.
  void AddFlesh(const Limb& limb) {
    capsules_.push_back(
        {limb.joint, limb.end, limb.joint_radius_m, limb.end_radius_m});
    owners_.push_back(limb.id);
  }

  absl::StatusOr<SkinShape> Build(double blend_m, int vertex_count) {
    absl::StatusOr<std::shared_ptr<const Skeleton>> skeleton = builder_.Build();
    if (!skeleton.ok()) return skeleton.status();
    SkinShape shape;
    shape.skeleton = *std::move(skeleton);
    // A cell has about one vertex, so the number goes with the square of its
    // size: a coarse mesh tells the factor.
    double cell = 0;
    for (const Capsule& capsule : capsules_) {
      cell = std::max({cell, capsule.start_radius_m, capsule.end_radius_m});
    }
    cell *= kCoarseCell;
    absl::StatusOr<TriangleMesh> mesh = MeshAround(capsules_, cell, blend_m);
    if (!mesh.ok()) return mesh.status();
    cell *=
        std::sqrt(mesh->positions.size() / static_cast<double>(vertex_count));
    mesh = MeshAround(capsules_, cell, blend_m);
    if (!mesh.ok()) return mesh.status();
    shape.mesh = *std::move(mesh);
    for (const Vector3d& position : shape.mesh.positions) {
      shape.joint_ids.push_back(Nearest(position));
    }
    return shape;
  }

 private:
  std::string Nearest(const Vector3d& point) const {
    size_t best = 0;
    for (size_t i = 1; i < capsules_.size(); ++i) {
      if (DistanceTo(capsules_[i], point) <
          DistanceTo(capsules_[best], point)) {
        best = i;
      }
    }
    return owners_[best];
  }

  Vector3d hinge_axis_;
  SkeletonBuilder builder_;
  std::vector<std::string> ids_;
  std::vector<RigidTransform> world_from_joints_;
  std::vector<Capsule> capsules_;
  std::vector<std::string> owners_;
};

absl::StatusOr<SkinShape> Cylinder(int vertex_count) {
  SkinShape shape;
  BodyBuilder body(Vector3d::UnitZ());
  body.Add({"upper", "", JointType::kFree, {0, 0, 0}, {1, 0, 0}, 0.2, 0.2});
  body.Add({"lower",
            "upper",
            JointType::kSpherical,
            {1, 0, 0},
            {2, 0, 0},
            0.2,
            0.2});
  absl::StatusOr<SkinShape> built = body.Build(0, kLeastVertices);
  if (!built.ok()) return built.status();
  shape.skeleton = built->skeleton;
  TubeShape tube;
  tube.length_m = 2;
  tube.radius_m = 0.2;
  // Quads as long as they are wide.
  const double around =
      std::sqrt(vertex_count * 2 * std::numbers::pi * tube.radius_m / 2);
  tube.around = std::max(8, static_cast<int>(around));
  tube.rings = std::max(4, vertex_count / tube.around);
  absl::StatusOr<TriangleMesh> mesh = TubeMesh(tube);
  if (!mesh.ok()) return mesh.status();
  shape.mesh = *std::move(mesh);
  for (const Vector3d& position : shape.mesh.positions) {
    shape.joint_ids.push_back(position.x() < 1 ? "upper" : "lower");
  }
  return shape;
}

Muscle DrivenMuscle(absl::string_view id, absl::string_view link,
                    absl::string_view driver, double gain,
                    const Eigen::Vector2d& pivot_m) {
  Muscle muscle;
  muscle.id = std::string(id);
  muscle.link_id = std::string(link);
  muscle.driver_joint_id = std::string(driver);
  muscle.gain_s = muscle.gain_t = gain;
  muscle.pivot_m = pivot_m;
  return muscle;
}

absl::StatusOr<SkinShape> Arm(int vertex_count) {
  BodyBuilder body(Vector3d::UnitZ());
  body.Add({"upper_arm",
            "",
            JointType::kFree,
            {0, 0, 0},
            {0.3, 0, 0},
            0.055,
            0.045});
  body.Add({"forearm",
            "upper_arm",
            JointType::kRevolute,
            {0.3, 0, 0},
            {0.57, 0, 0},
            0.045,
            0.03});
  body.Add({"hand",
            "forearm",
            JointType::kSpherical,
            {0.57, 0, 0},
            {0.72, 0, 0},
            0.032,
            0.025});
  absl::StatusOr<SkinShape> shape = body.Build(0.01, vertex_count);
  if (!shape.ok()) return shape;
  // The elbow bends towards +Y: the biceps bulges there, with its pivot on the
  // other side.
  shape->muscles.muscles = {
      DrivenMuscle("biceps", "upper_arm", "forearm", 0.35, {-0.05, 0}),
      DrivenMuscle("triceps", "upper_arm", "forearm", -0.08, {0.05, 0})};
  return shape;
}

absl::StatusOr<SkinShape> Leg(int vertex_count) {
  BodyBuilder body(Vector3d::UnitX());
  body.Add(
      {"thigh", "", JointType::kFree, {0, 0.92, 0}, {0, 0.5, 0}, 0.09, 0.058});
  body.Add({"shank",
            "thigh",
            JointType::kRevolute,
            {0, 0.5, 0},
            {0, 0.08, 0},
            0.058,
            0.04});
  body.Add({"foot",
            "shank",
            JointType::kSpherical,
            {0, 0.08, 0},
            {0, 0.03, 0.18},
            0.042,
            0.03});
  return body.Build(0.015, vertex_count);
}

absl::StatusOr<SkinShape> Humanoid(int vertex_count) {
  BodyBuilder body(Vector3d::UnitX());
  body.Add(
      {"pelvis", "", JointType::kFree, {0, 0.95, 0}, {0, 1.1, 0}, 0.14, 0.125});
  body.Add({"spine",
            "pelvis",
            JointType::kSpherical,
            {0, 1.1, 0},
            {0, 1.26, 0},
            0.125,
            0.135});
  body.Add({"chest",
            "spine",
            JointType::kSpherical,
            {0, 1.26, 0},
            {0, 1.46, 0},
            0.14,
            0.1});
  body.Add({"neck",
            "chest",
            JointType::kSpherical,
            {0, 1.46, 0},
            {0, 1.56, 0.01},
            0.06,
            0.055});
  body.Add({"head",
            "neck",
            JointType::kSpherical,
            {0, 1.56, 0.01},
            {0, 1.66, 0.01},
            0.085,
            0.09});
  for (const double side : {1.0, -1.0}) {
    std::vector<std::string> ids;
    for (absl::string_view part :
         {"thigh", "shank", "foot", "upper_arm", "forearm", "hand"}) {
      ids.push_back(absl::StrCat(side > 0 ? "left_" : "right_", part));
    }
    const auto at = [side](double x, double y, double z) {
      return Vector3d(side * x, y, z);
    };
    body.Add({ids[0].c_str(), "pelvis", JointType::kSpherical, at(0.1, 0.9, 0),
              at(0.115, 0.48, 0), 0.09, 0.058});
    body.Add({ids[1].c_str(), ids[0].c_str(), JointType::kRevolute,
              at(0.115, 0.48, 0), at(0.12, 0.08, -0.01), 0.058, 0.04});
    body.Add({ids[2].c_str(), ids[1].c_str(), JointType::kSpherical,
              at(0.12, 0.08, -0.01), at(0.125, 0.035, 0.16), 0.042, 0.032});
    body.Add({ids[3].c_str(), "chest", JointType::kSpherical, at(0.19, 1.4, 0),
              at(0.25, 1.12, 0), 0.055, 0.043});
    body.Add({ids[4].c_str(), ids[3].c_str(), JointType::kRevolute,
              at(0.25, 1.12, 0), at(0.3, 0.87, 0.02), 0.043, 0.03});
    body.Add({ids[5].c_str(), ids[4].c_str(), JointType::kSpherical,
              at(0.3, 0.87, 0.02), at(0.32, 0.73, 0.03), 0.032, 0.024});
    // Shoulder and hip, where there is no bone.
    body.AddFlesh({"chest", "", JointType::kFixed, at(0.08, 1.4, 0),
                   at(0.15, 1.4, 0), 0.07, 0.065});
    body.AddFlesh({"pelvis", "", JointType::kFixed, at(0.03, 0.95, 0),
                   at(0.08, 0.94, 0), 0.13, 0.11});
  }
  return body.Build(0.02, vertex_count);
}

}  // namespace

absl::Span<const absl::string_view> SkinShapeNames() { return kNames; }

absl::StatusOr<SkinShape> MakeSkinShape(absl::string_view name,
                                        int vertex_count) {
  if (vertex_count < kLeastVertices || vertex_count > kMostVertices) {
    Violations violations;
    violations.Add("vertex_count",
                   absl::StrCat("want ", kLeastVertices, " to ", kMostVertices,
                                ", got ", vertex_count));
    return violations.ToStatus();
  }
  if (name == "cylinder") return Cylinder(vertex_count);
  if (name == "arm") return Arm(vertex_count);
  if (name == "leg") return Leg(vertex_count);
  if (name == "humanoid") return Humanoid(vertex_count);
  return absl::NotFoundError(absl::StrCat("no shape \"", name, "\": want ",
                                          absl::StrJoin(kNames, ", ")));
}

}  // namespace gelenk

#include "gelenk/retarget/humanoid.h"

#include <numbers>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kPelvisHeight = 0.96;
constexpr absl::string_view kHumanoid = "humanoid";

// A ball joint: where it is in its parent, the bone it turns, how far it swings
// and twists, and the mass of its link.
struct BallJoint {
  std::string id;
  std::string parent_id;
  Vector3d place;
  Vector3d bone;
  double cone_deg;
  double twist_deg;
  double mass_kg;
};

// Takes lengths of a body of kHumanoidHeightM.
class ScaledBuilder {
 public:
  explicit ScaledBuilder(double scale) : scale_(scale) {}

  double scale() const { return scale_; }
  void AddJoint(Joint joint) {
    joint.parent_from_joint.translation *= scale_;
    joint.link_center_of_mass *= scale_;
    builder_.AddJoint(std::move(joint));
  }
  void AddEndEffector(EndEffector end) {
    end.joint_from_end_effector.translation *= scale_;
    builder_.AddEndEffector(std::move(end));
  }
  absl::StatusOr<std::shared_ptr<const Skeleton>> Build(Eigen::VectorXd rest) {
    return builder_.SetRestPositions(std::move(rest)).Build();
  }

 private:
  double scale_;
  SkeletonBuilder builder_;
};

void AddBall(const BallJoint& ball, ScaledBuilder& builder) {
  Joint joint;
  joint.id = ball.id;
  joint.parent_id = ball.parent_id;
  joint.type = JointType::kSpherical;
  joint.parent_from_joint.translation = ball.place;
  joint.axis = ball.bone.normalized();
  joint.limits.swing_cone_rad = ball.cone_deg * kDegree;
  joint.limits.twist_lower_rad = -ball.twist_deg * kDegree;
  joint.limits.twist_upper_rad = ball.twist_deg * kDegree;
  joint.link_mass_kg = ball.mass_kg;
  joint.link_center_of_mass = ball.bone / 2;
  builder.AddJoint(joint);
}

void AddEnd(const std::string& id, const std::string& joint_id,
            const Vector3d& place, ScaledBuilder& builder) {
  EndEffector end;
  end.id = id;
  end.joint_id = joint_id;
  end.joint_from_end_effector.translation = place;
  builder.AddEndEffector(end);
}

void AddTrunk(ScaledBuilder& builder) {
  Joint pelvis;
  pelvis.id = "pelvis";
  pelvis.type = JointType::kFree;
  pelvis.link_mass_kg = 8.5;
  builder.AddJoint(pelvis);
  const Vector3d up = Vector3d::UnitY();
  AddBall({"spine", "pelvis", 0.11 * up, 0.13 * up, 50, 40, 9}, builder);
  AddBall({"chest", "spine", 0.13 * up, 0.14 * up, 50, 40, 9}, builder);
  AddBall({"upper_chest", "chest", 0.14 * up, 0.16 * up, 50, 40, 11}, builder);
  AddBall({"neck", "upper_chest", 0.16 * up, 0.10 * up, 75, 75, 1}, builder);
  AddBall({"head", "neck", {0, 0.10, 0.01}, 0.15 * up, 75, 75, 4}, builder);
  AddEnd("crown", "head", 0.15 * up, builder);
}

void AddArm(const std::string& side, double out, ScaledBuilder& builder) {
  const std::string clavicle = absl::StrCat(side, "_clavicle");
  const std::string upper = absl::StrCat(side, "_upper_arm");
  const std::string forearm = absl::StrCat(side, "_forearm");
  const std::string hand = absl::StrCat(side, "_hand");
  const Vector3d x = out * Vector3d::UnitX();
  AddBall({clavicle, "upper_chest", 0.03 * x + Vector3d(0, 0.11, 0), 0.14 * x,
           50, 60, 0.5},
          builder);
  AddBall({upper, clavicle, 0.14 * x, 0.28 * x, 150, 150, 2}, builder);
  AddBall({forearm, upper, 0.28 * x, 0.26 * x, 160, 120, 1.2}, builder);
  AddBall({hand, forearm, 0.26 * x, 0.09 * x, 100, 90, 0.5}, builder);
  AddEnd(absl::StrCat(side, "_palm"), hand, 0.09 * x, builder);
}

void AddLeg(const std::string& side, double out, ScaledBuilder& builder) {
  const std::string thigh = absl::StrCat(side, "_thigh");
  const std::string shin = absl::StrCat(side, "_shin");
  const std::string foot = absl::StrCat(side, "_foot");
  const std::string toe = absl::StrCat(side, "_toe");
  const Vector3d down = -Vector3d::UnitY();
  AddBall({thigh, "pelvis", {0.095 * out, -0.04, 0}, 0.43 * down, 150, 90, 8},
          builder);
  AddBall({shin, thigh, 0.43 * down, 0.415 * down, 165, 60, 3.5}, builder);
  AddBall({foot, shin, 0.415 * down, {0, -0.055, 0.13}, 80, 60, 1}, builder);
  AddBall({toe, foot, {0, -0.055, 0.13}, {0, -0.02, 0.07}, 80, 45, 0.2},
          builder);
  AddEnd(absl::StrCat(side, "_heel"), foot, {0, -0.075, -0.05}, builder);
  AddEnd(absl::StrCat(side, "_toe_tip"), toe, {0, -0.02, 0.07}, builder);
}

}  // namespace

std::shared_ptr<const Skeleton> MakeHumanoid(double height_m) {
  ScaledBuilder builder(height_m / kHumanoidHeightM);
  AddTrunk(builder);
  AddArm("left", 1, builder);
  AddArm("right", -1, builder);
  AddLeg("left", 1, builder);
  AddLeg("right", -1, builder);
  constexpr int kNumbers = 7 + 21 * 4;
  Eigen::VectorXd rest = Eigen::VectorXd::Zero(kNumbers);
  rest[1] = builder.scale() * kPelvisHeight;
  for (int w = 6; w < kNumbers; w += 4) rest[w] = 1;
  // What is built here is well formed; a test holds it.
  return *builder.Build(std::move(rest));
}

std::vector<absl::string_view> BundledSkeletonNames() { return {kHumanoid}; }

absl::StatusOr<std::shared_ptr<const Skeleton>> BundledSkeleton(
    absl::string_view name) {
  if (name == kHumanoid) return MakeHumanoid();
  return absl::NotFoundError(absl::StrCat(
      "no bundled skeleton \"", name,
      "\"; there is: ", absl::StrJoin(BundledSkeletonNames(), ", ")));
}

}  // namespace gelenk

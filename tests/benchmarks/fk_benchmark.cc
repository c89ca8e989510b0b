// Forward kinematics: frames of all joints and the axis of every degree of
// freedom by KinematicTree, by level of the instruction set; and frames alone
// by ForwardKinematics. A thousand random poses in turn, ns a pose.
#include <benchmark/benchmark.h>

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/kinematics/kinematic_tree.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/benchmarks/problems.h"

namespace gelenk::benchmarks {
namespace {

constexpr int kPoses = 1000;

// A body of 60 joints with one degree of freedom each.
class HingeBody {
 public:
  static std::shared_ptr<const Skeleton> Build() {
    HingeBody body;
    for (const char* axis : {"x", "y", "z"}) {
      body.Add(axis, {0, 0, 0}, JointType::kPrismatic);
    }
    const std::string pelvis = body.AddAll("zyx", {0, 0, 0.95});
    body.AddAll("zyx", {0, 0, 0.12});
    const std::string chest = body.AddAll("zyx", {0, 0, 0.18});
    body.AddAll("zyx", {0, 0, 0.28});
    body.Add("y", {0.03, 0, 0.02});
    for (double side : {1, -1}) {
      body.parent_ = chest;
      body.AddAll("zx", {0, 0.03 * side, 0.22});
      body.AddAll("yxz", {0, 0.16 * side, 0});
      body.AddAll("yz", {0, 0, -0.29});
      const std::string hand = body.AddAll("yx", {0, 0, -0.26});
      for (int finger = 0; finger < 3; ++finger) {
        body.parent_ = hand;
        body.Add("y", {0.03 * (finger - 1), 0, -0.09});
        body.Add("y", {0, 0, -0.04});
      }
    }
    for (double side : {1, -1}) {
      body.parent_ = pelvis;
      body.AddAll("zxy", {0, 0.09 * side, -0.05});
      body.Add("y", {0, 0, -0.42});
      body.AddAll("yx", {0, 0, -0.41});
      body.Add("y", {0.13, 0, -0.06});
    }
    return *body.builder_.Build();
  }

 private:
  std::string Add(absl::string_view axis, const Eigen::Vector3d& offset_m,
                  JointType type = JointType::kRevolute) {
    Joint joint;
    joint.id = absl::StrCat("j", count_++);
    joint.parent_id = parent_;
    joint.type = type;
    joint.axis = Eigen::Vector3d::Unit(axis[0] - 'x');
    joint.parent_from_joint.translation = offset_m;
    builder_.AddJoint(joint);
    return parent_ = joint.id;
  }

  // Joints at one place; returns the last.
  std::string AddAll(absl::string_view axes, Eigen::Vector3d offset_m) {
    for (size_t i = 0; i < axes.size(); ++i) {
      Add(axes.substr(i, 1), offset_m);
      offset_m.setZero();
    }
    return parent_;
  }

  SkeletonBuilder builder_;
  std::string parent_;
  int count_ = 0;
};

std::vector<Eigen::VectorXd> RandomAngles(const Skeleton& skeleton) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Eigen::VectorXd> poses;
  for (int i = 0; i < kPoses; ++i) {
    Eigen::VectorXd q(skeleton.position_count());
    for (double& number : q) number = unit(random);
    poses.push_back(q);
  }
  return poses;
}

void Evaluate(benchmark::State& state, const Skeleton& skeleton,
              InstructionSet level) {
  const KinematicTree tree(skeleton, level);
  const std::vector<Eigen::VectorXd> poses = RandomAngles(skeleton);
  KinematicFrames frames;
  size_t at = 0;
  for (auto _ : state) {
    at = (at + 1) % poses.size();
    tree.Evaluate(poses[at], frames);
    benchmark::DoNotOptimize(frames.origin(0).data());
    benchmark::ClobberMemory();
  }
}

void EvaluateQuaternions(benchmark::State& state, const Skeleton& skeleton) {
  const std::vector<Eigen::VectorXd> poses = RandomAngles(skeleton);
  WorldTransforms frames;
  size_t at = 0;
  for (auto _ : state) {
    at = (at + 1) % poses.size();
    ForwardKinematics(skeleton, poses[at], frames);
    benchmark::DoNotOptimize(frames.data());
    benchmark::ClobberMemory();
  }
}

void RegisterAll(const std::string& name,
                 const std::shared_ptr<const Skeleton>& skeleton) {
  for (InstructionSet level : SupportedInstructionSets()) {
    benchmark::RegisterBenchmark(
        absl::StrCat(name, "/tree/", InstructionSetName(level)).c_str(),
        [=](benchmark::State& state) { Evaluate(state, *skeleton, level); });
  }
  benchmark::RegisterBenchmark(
      absl::StrCat(name, "/quaternions").c_str(),
      [=](benchmark::State& state) { EvaluateQuaternions(state, *skeleton); });
}

int Register() {
  RegisterAll("arm_7_joints", PandaProblem(1).skeleton);
  RegisterAll("body_60_joints", HingeBody::Build());
  return 0;
}

[[maybe_unused]] const int registered = Register();

}  // namespace
}  // namespace gelenk::benchmarks

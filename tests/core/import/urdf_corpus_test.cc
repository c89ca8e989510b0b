// Real robots, none of them part of the project: the folder that GELENK_CORPUS
// names, or shared/data beside the source tree.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/import/urdf_import.h"
#include "gelenk/import/urdf_reader.h"
#include "gelenk/skeleton/pose.h"
#include "tests/core/import/urdf_oracle.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/matrix_kinematics_oracle.h"
#include "tests/testing/random_pose.h"

namespace gelenk {
namespace {

namespace fs = std::filesystem;
using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::MatrixOf;
using ::gelenk::testing::OraclePositionError;
using ::gelenk::testing::OracleRotationError;
using ::gelenk::testing::PoseGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPoseWithinLimits;
using ::gelenk::testing::UrdfOracle;
using ::testing::Contains;
using ::testing::HasSubstr;

// Products of some ten rotations and translations of a metre.
constexpr double kRounding = 1e-12;
constexpr int kPoses = 5;

fs::path CorpusFolder() {
  const char* named = std::getenv("GELENK_CORPUS");
  const fs::path data =
      named != nullptr
          ? fs::path(named)
          : fs::path(GELENK_SOURCE_DIR).parent_path() / "shared" / "data";
  return data / "urdf";
}

std::vector<fs::path> Robots() {
  std::vector<fs::path> robots;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(CorpusFolder(), none)) {
    if (entry.path().extension() == ".urdf") robots.push_back(entry.path());
  }
  std::sort(robots.begin(), robots.end());
  return robots;
}

std::string ReadFile(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

UrdfImport Import(const std::string& text) {
  const absl::StatusOr<UrdfDocument> document = ReadUrdf(text);
  EXPECT_TRUE(document.ok()) << document.status();
  absl::StatusOr<UrdfImport> import = ImportUrdf(*document);
  EXPECT_TRUE(import.ok()) << import.status();
  return *std::move(import);
}

void ExpectLinksWhereTheFileSays(UrdfOracle& oracle, const Skeleton& skeleton,
                                 const Eigen::VectorXd& pose) {
  std::map<std::string, double> numbers;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const Joint& joint = skeleton.joint(i);
    const bool is_scalar = joint.type == JointType::kRevolute ||
                           joint.type == JointType::kPrismatic;
    if (is_scalar && !joint.mimic) {
      numbers[joint.id] = pose[skeleton.span(i).position_offset];
    }
  }
  for (const std::string& link : oracle.Links()) {
    ASSERT_TRUE(skeleton.FindEffector(link).has_value()) << link;
    ASSERT_LT((MatrixOf(EffectorPose(skeleton, pose, link)) -
               oracle.RootFromLink(link, numbers))
                  .norm(),
              kRounding)
        << link;
  }
}

// Floating joints rest, as the oracle wants.
Eigen::VectorXd RandomScalars(Random& random, const Skeleton& skeleton) {
  Eigen::VectorXd pose = RandomPoseWithinLimits(random, skeleton);
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    if (skeleton.joint(i).type != JointType::kFree) continue;
    const int at = skeleton.span(i).position_offset;
    pose.segment<7>(at) = skeleton.rest_positions().segment<7>(at);
  }
  return pose;
}

// The joints that nothing hangs from.
std::vector<std::string> Tips(const Skeleton& skeleton) {
  std::vector<bool> is_parent(skeleton.joint_count(), false);
  for (int i = 1; i < skeleton.joint_count(); ++i) {
    is_parent[skeleton.span(i).parent] = true;
  }
  std::vector<std::string> tips;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    if (!is_parent[i]) tips.push_back(skeleton.joint(i).id);
  }
  return tips;
}

// Cold, as a request without a start is; by an oracle's measure.
void ExpectTipsAreReached(const std::shared_ptr<const Skeleton>& skeleton,
                          const Eigen::VectorXd& pose) {
  LevenbergMarquardtSolver solver;
  SolveReport report;
  for (const std::string& tip : Tips(*skeleton)) {
    const Goal goal = PoseGoalFor(tip, EffectorPose(*skeleton, pose, tip));
    const absl::StatusOr<IkProblem> problem =
        IkProblem::Create(skeleton, {goal});
    ASSERT_TRUE(problem.ok()) << problem.status();
    Eigen::VectorXd solved = skeleton->rest_positions();
    solver.Solve(*problem, SolverOptions(), SolveStart::kCold, solved, report);
    EXPECT_EQ(report.outcome, SolveOutcome::kConverged) << tip;
    EXPECT_LT(OraclePositionError(*skeleton, goal, solved), 1e-4) << tip;
    EXPECT_LT(OracleRotationError(*skeleton, goal, solved), 1e-3) << tip;
    int worst = -1;
    EXPECT_EQ(LimitExcess(*skeleton, solved, &worst), 0) << tip;
  }
}

TEST(UrdfCorpusTest, EveryRobotStandsAndReaches) {
  const std::vector<fs::path> robots = Robots();
  if (robots.empty()) {
    GTEST_SKIP() << "SKIPPED: no robots in " << CorpusFolder();
  }
  for (const fs::path& path : robots) {
    SCOPED_TRACE(path);
    const std::string text = ReadFile(path);
    const UrdfImport import = Import(text);
    const Skeleton& skeleton = *import.skeleton;
    UrdfOracle oracle(text);
    EXPECT_EQ(oracle.Joints().size() + 1, skeleton.joint_count());
    Random random(1);
    for (int i = 0; i < kPoses; ++i) {
      const Eigen::VectorXd pose = RandomScalars(random, skeleton);
      ExpectLinksWhereTheFileSays(oracle, skeleton, pose);
      ExpectTipsAreReached(import.skeleton, pose);
    }
  }
}

TEST(UrdfCorpusTest, ARobotWithoutLimitsIsUnlimited) {
  const fs::path path = CorpusFolder() / "kuka_iiwa.urdf";
  if (!fs::exists(path)) GTEST_SKIP() << "SKIPPED: no " << path;
  const UrdfImport import = Import(ReadFile(path));
  EXPECT_EQ(import.skeleton->velocity_count(), 7);
  for (const Joint& joint : import.skeleton->joints()) {
    EXPECT_TRUE(joint.limits.lower.empty());
  }
  EXPECT_THAT(import.warnings, Contains(HasSubstr("no <limit>")).Times(7));
}

TEST(UrdfCorpusTest, MimicsOwnNoNumber) {
  const fs::path path = CorpusFolder() / "talos_full_v2.urdf";
  if (!fs::exists(path)) GTEST_SKIP() << "SKIPPED: no " << path;
  const UrdfImport import = Import(ReadFile(path));
  const int follower =
      import.skeleton->FindJoint("gripper_left_inner_double_joint");
  ASSERT_GE(follower, 0);
  EXPECT_EQ(import.skeleton->joint(follower).mimic->joint_id,
            "gripper_left_joint");
  // 44 hinges, 12 of which follow.
  EXPECT_EQ(import.skeleton->velocity_count(), 32);
}

}  // namespace
}  // namespace gelenk

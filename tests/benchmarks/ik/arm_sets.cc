#include "tests/benchmarks/ik/arm_sets.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <random>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "client/cli/bench/number_table.h"
#include "client/cli/skeleton_file.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk::benchmarks {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kQuarter = kPi / 2;
constexpr double kWarmSpread_rad = 0.1;
constexpr char kTip[] = "tip";

struct Row {
  double a_m;
  double alpha_rad;
  double d_m;
  double lower_rad;
  double upper_rad;
};

struct Arm {
  const char* name;
  bool modified;  // by the convention of Craig, else of Denavit and Hartenberg
  double tool_m;  // along the last z
  std::vector<Row> rows;
};

std::vector<Arm> Arms() {
  const double iiwa_far = 170 * kPi / 180;
  const double iiwa_near = 120 * kPi / 180;
  const double iiwa_last = 175 * kPi / 180;
  const double whole = 2 * kPi;
  return {
      {"panda",
       true,
       0.107,
       {{0, 0, 0.333, -2.8973, 2.8973},
        {0, -kQuarter, 0, -1.7628, 1.7628},
        {0, kQuarter, 0.316, -2.8973, 2.8973},
        {0.0825, kQuarter, 0, -3.0718, -0.0698},
        {-0.0825, -kQuarter, 0.384, -2.8973, 2.8973},
        {0, kQuarter, 0, -0.0175, 3.7525},
        {0.088, kQuarter, 0, -2.8973, 2.8973}}},
      {"iiwa14",
       false,
       0,
       {{0, -kQuarter, 0.36, -iiwa_far, iiwa_far},
        {0, kQuarter, 0, -iiwa_near, iiwa_near},
        {0, kQuarter, 0.42, -iiwa_far, iiwa_far},
        {0, -kQuarter, 0, -iiwa_near, iiwa_near},
        {0, -kQuarter, 0.4, -iiwa_far, iiwa_far},
        {0, kQuarter, 0, -iiwa_near, iiwa_near},
        {0, 0, 0.126, -iiwa_last, iiwa_last}}},
      {"ur5",
       false,
       0,
       {{0, kQuarter, 0.089159, -whole, whole},
        {-0.425, 0, 0, -whole, whole},
        {-0.39225, 0, 0, -whole, whole},
        {0, kQuarter, 0.10915, -whole, whole},
        {0, -kQuarter, 0.09465, -whole, whole},
        {0, 0, 0.0823, -whole, whole}}},
  };
}

RigidTransform TurnAboutX(double angle_rad) {
  return {Eigen::Quaterniond(
              Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitX())),
          Eigen::Vector3d::Zero()};
}

RigidTransform Shift(double x, double z) {
  return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, 0, z)};
}

std::shared_ptr<const Skeleton> Build(const Arm& arm) {
  SkeletonBuilder builder;
  RigidTransform before;  // what the standard convention puts behind a joint
  std::string parent;
  for (const Row& row : arm.rows) {
    Joint joint;
    joint.id = absl::StrCat("j", &row - arm.rows.data());
    joint.parent_id = parent;
    joint.type = JointType::kRevolute;
    joint.axis = Eigen::Vector3d::UnitZ();
    joint.parent_from_joint =
        arm.modified ? TurnAboutX(row.alpha_rad) * Shift(row.a_m, row.d_m)
                     : before;
    joint.limits.lower = {row.lower_rad};
    joint.limits.upper = {row.upper_rad};
    before = Shift(row.a_m, row.d_m) * TurnAboutX(row.alpha_rad);
    parent = joint.id;
    builder.AddJoint(std::move(joint));
  }
  builder.AddEndEffector(
      {kTip, parent, arm.modified ? Shift(0, arm.tool_m) : before});
  return *builder.Build();
}

cli::NumberTable Draw(const Skeleton& skeleton, int count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  const PositionBounds& bounds = skeleton.position_bounds();
  const int joints = skeleton.position_count();
  cli::NumberTable table;
  for (const char* prefix : {"q", "warm"}) {
    for (int i = 0; i < joints; ++i) {
      table.columns.push_back(absl::StrCat(prefix, i));
    }
  }
  std::vector<double> truth(joints);
  for (int row = 0; row < count; ++row) {
    for (int i = 0; i < joints; ++i) {
      truth[i] = 0.5 * (bounds.lower[i] + bounds.upper[i]) +
                 0.5 * (bounds.upper[i] - bounds.lower[i]) * unit(random);
      table.numbers.push_back(truth[i]);
    }
    for (int i = 0; i < joints; ++i) {
      table.numbers.push_back(
          std::clamp(truth[i] + kWarmSpread_rad * unit(random), bounds.lower[i],
                     bounds.upper[i]));
    }
  }
  return table;
}

template <class Value>
Value OrExit(absl::StatusOr<Value> value) {
  if (value.ok()) return *std::move(value);
  std::fprintf(stderr, "%s\n", std::string(value.status().message()).c_str());
  std::exit(1);
}

cli::IkSet MakeSet(const std::shared_ptr<const Skeleton>& skeleton,
                   const cli::NumberTable& table, cli::BenchStart start) {
  return OrExit(
      cli::MakeIkSet(skeleton, {kTip}, table, start, cli::BenchGoal::kPose));
}

}  // namespace

std::vector<ArmSet> ArmSets(int target_count) {
  const char* folder = std::getenv("GELENK_BENCH_IK");
  std::vector<ArmSet> sets;
  for (const Arm& arm : Arms()) {
    std::shared_ptr<const Skeleton> skeleton;
    cli::NumberTable table;
    if (folder != nullptr) {
      const std::string path = absl::StrCat(folder, "/", arm.name);
      skeleton =
          OrExit(cli::ReadSkeletonFile(path + ".json", std::nullopt)).skeleton;
      table = OrExit(cli::ReadNumberTable(path + ".csv.gz"));
      table.numbers.resize(table.columns.size() *
                           std::min(target_count, table.row_count()));
    } else {
      skeleton = Build(arm);
      table = Draw(*skeleton, target_count);
    }
    sets.push_back({arm.name, MakeSet(skeleton, table, cli::BenchStart::kCold),
                    MakeSet(skeleton, table, cli::BenchStart::kWarm)});
  }
  return sets;
}

}  // namespace gelenk::benchmarks

#include "tests/benchmarks/chain_sets.h"

#include <cstdlib>
#include <fstream>
#include <random>

#include "absl/strings/str_cat.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk::benchmarks {
namespace {

constexpr int kTargets = 200;
constexpr double kPlanarRange_rad = 2.0944;
constexpr double kBallRange_rad = 1.5;

double RangeOf(ChainKind kind) {
  return kind == ChainKind::kPlanar ? kPlanarRange_rad : kBallRange_rad;
}

const char* NameOf(ChainKind kind) {
  switch (kind) {
    case ChainKind::kPlanar:
      return "planar";
    case ChainKind::kBall:
      return "ball";
    case ChainKind::kSpherical:
      return "spherical";
  }
  return "";
}

std::shared_ptr<const Skeleton> Build(ChainKind kind, int link_count,
                                      bool limited) {
  SkeletonBuilder builder;
  std::string parent;
  int count = 0;
  const auto add = [&](JointType type, int axis, double along) {
    Joint joint;
    joint.id = absl::StrCat("j", count++);
    joint.parent_id = parent;
    joint.type = type;
    joint.axis = Eigen::Vector3d::Unit(axis);
    joint.parent_from_joint.translation.x() = along;
    if (limited && type == JointType::kRevolute) {
      joint.limits.lower = {-RangeOf(kind)};
      joint.limits.upper = {RangeOf(kind)};
    }
    parent = joint.id;
    builder.AddJoint(joint);
  };
  const double length = 1.0 / link_count;
  for (int i = 0; i < link_count; ++i) {
    const double along = i == 0 ? 0 : length;
    if (kind == ChainKind::kSpherical) {
      add(JointType::kSpherical, 0, along);
      continue;
    }
    add(JointType::kRevolute, 2, along);
    if (kind == ChainKind::kPlanar) continue;
    add(JointType::kRevolute, 1, 0);
    add(JointType::kRevolute, 0, 0);
  }
  RigidTransform tip;
  tip.translation.x() = length;
  return *builder.AddEndEffector({"tip", parent, tip}).Build();
}

// Rows of the first `count` columns of a file of numbers; none without it.
std::vector<Eigen::VectorXd> ReadRows(const std::string& path, int count) {
  std::vector<Eigen::VectorXd> rows;
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);  // the columns' names
  while (std::getline(file, line)) {
    Eigen::VectorXd row(count);
    const char* at = line.c_str();
    for (double& number : row) {
      char* end;
      number = std::strtod(at, &end);
      at = end + 1;
    }
    rows.push_back(row);
  }
  return rows;
}

std::vector<Eigen::VectorXd> Draw(double range, int count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-range, range);
  std::vector<Eigen::VectorXd> rows;
  for (int i = 0; i < kTargets; ++i) {
    Eigen::VectorXd row(count);
    for (double& number : row) number = unit(random);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

ChainSet MakeChainSet(ChainKind kind, int link_count, bool limited) {
  ChainSet set;
  set.name = absl::StrCat(NameOf(kind), link_count);
  set.skeleton = Build(kind, link_count, limited);
  // Spherical joints have the targets of balls.
  const ChainKind drawn =
      kind == ChainKind::kSpherical ? ChainKind::kBall : kind;
  const auto skeleton = Build(drawn, link_count, true);
  std::vector<Eigen::VectorXd> rows;
  if (const char* folder = std::getenv("GELENK_BENCH_IK")) {
    rows =
        ReadRows(absl::StrCat(folder, "/", NameOf(drawn), link_count, ".csv"),
                 skeleton->position_count());
  }
  if (rows.empty()) rows = Draw(RangeOf(drawn), skeleton->position_count());
  const EffectorFrame tip = *skeleton->FindEffector("tip");
  WorldTransforms frames;
  for (const Eigen::VectorXd& row : rows) {
    ForwardKinematics(*skeleton, row, frames);
    set.targets.push_back(frames[tip.joint] *
                          tip.joint_from_effector.translation);
  }
  return set;
}

}  // namespace gelenk::benchmarks

#include "gelenk/ik/solve_diagnosis.h"

#include <Eigen/SVD>
#include <cmath>
#include <vector>

#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/kinematics/jacobian.h"
#include "gelenk/math/pseudo_inverse.h"

namespace gelenk {
namespace {

// sqrt(det(J J^T)) is the product of J's singular values.
double Manipulability(const std::vector<Eigen::RowVectorXd>& rows) {
  if (rows.empty() || static_cast<int>(rows.size()) > rows[0].size()) return 0;
  Eigen::MatrixXd j(rows.size(), rows[0].size());
  for (size_t i = 0; i < rows.size(); ++i) j.row(i) = rows[i];
  return j.bdcSvd().singularValues().prod();
}

int Rank(const Eigen::MatrixXd& j) {
  if (j.size() == 0) return 0;
  const Eigen::VectorXd values = j.bdcSvd().singularValues();
  int rank = 0;
  for (double value : values) {
    if (value > kRankCutoff * values[0]) ++rank;
  }
  return rank;
}

}  // namespace

double WeightedChange(const IkProblem& problem, const ConstVectorView& from,
                      const ConstVectorView& to, VectorView change) {
  const Skeleton& skeleton = problem.skeleton();
  Difference(skeleton, from, to, change);
  double sum = 0;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const int v = skeleton.span(i).velocity_offset;
    if (v < 0) continue;
    const Joint& joint = skeleton.joint(i);
    for (int k = 0; k < VelocityCount(joint.type); ++k) {
      const double stiffness = joint.stiffness.empty() ? 1 : joint.stiffness[k];
      sum += stiffness * change[v + k] * change[v + k];
    }
  }
  return std::sqrt(sum);
}

void Diagnose(const IkProblem& problem, const ConstVectorView& positions,
              SolveReport& report) {
  const Skeleton& skeleton = problem.skeleton();
  WorldTransforms frames;
  ForwardKinematics(skeleton, positions, problem.world_from_skeleton(), frames);
  std::vector<Eigen::RowVectorXd> translation_rows;
  std::vector<Eigen::RowVectorXd> rotation_rows;
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian;
  for (size_t g = 0; g < problem.goals().size(); ++g) {
    const kernel::TaskTarget& target = problem.targets()[g];
    const GoalKind& kind = problem.goals()[g].kind;
    if (!target.active) continue;
    ComputeJacobian(skeleton, positions, frames,
                    *skeleton.FindEffector(EffectorId(kind)), jacobian);
    for (int k = 0; k < 3; ++k) {
      const bool counts = target.row_counts[k] > 0 &&
                          !std::holds_alternative<RotationGoal>(kind);
      if (counts) translation_rows.push_back(jacobian.row(k));
      if (!std::holds_alternative<PositionGoal>(kind) &&
          target.row_scale[3 + k] > 0) {
        rotation_rows.push_back(jacobian.row(3 + k));
      }
    }
  }
  Eigen::MatrixXd all(translation_rows.size() + rotation_rows.size(),
                      skeleton.velocity_count());
  int row = 0;
  for (const auto* rows : {&translation_rows, &rotation_rows}) {
    for (const Eigen::RowVectorXd& r : *rows) all.row(row++) = r;
  }
  report.rank = Rank(all);
  report.free_velocity_count = skeleton.velocity_count() - report.rank;
  report.translation_manipulability = Manipulability(translation_rows);
  report.rotation_manipulability = Manipulability(rotation_rows);
}

}  // namespace gelenk

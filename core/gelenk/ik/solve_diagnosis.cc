#include "gelenk/ik/solve_diagnosis.h"

#include <cmath>
#include <vector>

#include "gelenk/ik/goal_linearizer.h"
#include "gelenk/math/pseudo_inverse.h"

namespace gelenk {
namespace {

using RowMajorMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// sqrt(det(J J^T)) is the product of J's singular values.
double Manipulability(const std::vector<Eigen::RowVectorXd>& rows) {
  if (rows.empty() || static_cast<int>(rows.size()) > rows[0].size()) return 0;
  Eigen::MatrixXd j(rows.size(), rows[0].size());
  for (size_t i = 0; i < rows.size(); ++i) j.row(i) = rows[i];
  return ComputeSingularValues(j).prod();
}

int Rank(const Eigen::MatrixXd& j) {
  const Eigen::VectorXd values = ComputeSingularValues(j);
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
  GoalLinearizer linearizer;
  linearizer.SetProblem(problem);
  linearizer.MoveTo(positions);
  kernel::GoalRows rows = {};
  std::vector<Eigen::RowVectorXd> translation_rows;
  std::vector<Eigen::RowVectorXd> rotation_rows;
  for (size_t g = 0; g < problem.goals().size(); ++g) {
    const kernel::TaskTarget& target = problem.targets()[g];
    if (!target.active) continue;
    RowMajorMatrix jacobian(GoalLinearizer::RowCount(target),
                            skeleton.velocity_count());
    const int goal = static_cast<int>(g);
    linearizer.Evaluate(goal, target, rows);
    linearizer.ComputeJacobian(goal, target, rows, positions, jacobian);
    for (int r = 0; r < jacobian.rows(); ++r) {
      const bool translates = r < target.translation_rows;
      if (target.row_scale[translates ? r : 3] <= 0) continue;
      (translates ? translation_rows : rotation_rows)
          .push_back(jacobian.row(r));
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

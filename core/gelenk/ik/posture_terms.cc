#include "gelenk/ik/posture_terms.h"

#include <algorithm>
#include <variant>

namespace gelenk {
namespace {

using kernel::PostureTerm;

// Opposite rotations of equal weight cancel out.
constexpr double kLeastWeight = 1e-300;

// Of one number, or of a quaternion's four.
class Sum {
 public:
  void Add(double weight, const double* target, int count) {
    if (weight <= 0) return;
    double aligned = 0;
    for (int k = 0; k < count; ++k) aligned += sum_[k] * target[k];
    const double sign = count == 4 && aligned < 0 ? -1 : 1;
    for (int k = 0; k < count; ++k) sum_[k] += sign * weight * target[k];
    weight_ += weight;
  }

  void AppendTo(std::vector<PostureTerm>& terms, int column, int position,
                int count) const {
    double weight = weight_;
    if (count == 4) {
      weight = Eigen::Map<const Eigen::Vector4d>(sum_).norm();
    }
    if (weight < kLeastWeight) return;
    PostureTerm term = {column, position, count == 4, weight, {}};
    for (int k = 0; k < count; ++k) term.target[k] = sum_[k] / weight;
    terms.push_back(term);
  }

 private:
  double sum_[4] = {};
  double weight_ = 0;
};

// Numbers of q before the quaternion of a joint, or all.
int ScalarCount(JointType type) {
  if (type == JointType::kSpherical) return 0;
  return type == JointType::kFree ? 3 : PositionCount(type);
}

class PostureJoiner {
 public:
  PostureJoiner(absl::Span<const Goal> goals, std::optional<int> priority,
                std::vector<PostureTerm>& terms)
      : goals_(goals), priority_(priority), terms_(terms) {}

  void AddJoint(const Skeleton& skeleton, int joint, int column) {
    const int position = skeleton.span(joint).position_offset;
    if (position < 0) return;
    const JointType type = skeleton.joint(joint).type;
    const int scalars = ScalarCount(type);
    const auto at = [&](int k) { return column < 0 ? column : column + k; };
    for (int k = 0; k < scalars; ++k) {
      SumOf(joint, position + k, 1).AppendTo(terms_, at(k), position + k, 1);
    }
    if (scalars == PositionCount(type)) return;
    SumOf(joint, position + scalars, 4)
        .AppendTo(terms_, at(scalars), position + scalars, 4);
  }

 private:
  Sum SumOf(int joint, int position, int count) const {
    Sum sum;
    for (const Goal& goal : goals_) {
      const auto* posture = std::get_if<PostureGoal>(&goal.kind);
      if (posture == nullptr ||
          goal.priority != priority_.value_or(goal.priority)) {
        continue;
      }
      const double share =
          posture->joint_weights.empty() ? 1 : posture->joint_weights[joint];
      sum.Add(goal.weight * share, posture->positions.data() + position, count);
    }
    return sum;
  }

  absl::Span<const Goal> goals_;
  const std::optional<int> priority_;
  std::vector<PostureTerm>& terms_;
};

}  // namespace

int JoinPostures(const Skeleton& skeleton, absl::Span<const Goal> goals,
                 std::optional<int> priority,
                 absl::Span<const int> first_columns,
                 std::vector<PostureTerm>& terms) {
  terms.clear();
  PostureJoiner joiner(goals, priority, terms);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (first_columns[j] >= 0) joiner.AddJoint(skeleton, j, first_columns[j]);
  }
  const int with_columns = static_cast<int>(terms.size());
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (first_columns[j] < 0) joiner.AddJoint(skeleton, j, -1);
  }
  return with_columns;
}

void TakePosture(absl::Span<const PostureTerm> terms, VectorView positions) {
  for (const PostureTerm& term : terms) {
    std::copy_n(term.target, term.rotation ? 4 : 1,
                positions.data() + term.position);
  }
}

}  // namespace gelenk

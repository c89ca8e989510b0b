// The goals of a problem by priority, at a pose: how far each level is from
// what it wants, what the levels that are done hold, and both as rows of a
// LevelStep.
//
// Levels count from 0, the most important one, without gaps; goals that are
// switched off belong to none. World frame, m, rad. A level that is done holds
// the residuals that it got to, reached or not; a half-space holds its side of
// its plane, or of the parallel one that it got to.
//
// Dense: cost of a pose and its rows is that of GoalLinearizer. Keeps its
// memory. Not thread-safe.
#ifndef GELENK_IK_GOAL_LEVELS_H_
#define GELENK_IK_GOAL_LEVELS_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/types/span.h"
#include "gelenk/ik/goal_linearizer.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/level_step.h"
#include "gelenk/ik/solver_options.h"
#include "gelenk/ik/step_space.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

class GoalLevels {
 public:
  // `start` is where plants without a pose of their own stand. `problem` must
  // outlive this.
  void SetProblem(const IkProblem& problem, const ConstVectorView& start);

  int level_count() const { return level_count_; }
  // Has goals other than postures.
  bool HasRows(int level) const { return row_counts_[level] > 0; }
  absl::Span<const kernel::PostureTerm> posture(int level) const {
    return postures_[level];
  }
  // Whether a joint moves a goal of any level, by joint.
  absl::Span<const uint8_t> moves() const { return moves_; }

  // Starts a level over: nothing at it or below is held.
  void BeginLevel(int level);
  // Evaluates the goals of the levels up to `last`.
  void MoveTo(const ConstVectorView& positions, int last);

  // Half the weighted squared error of a level's goals, and what a posture adds
  // to it.
  double GoalEnergy(int level) const;
  double PostureEnergy(int level, const ConstVectorView& positions) const;
  // Every goal within these, m and rad.
  bool IsWithin(int level, double position_tolerance,
                double rotation_tolerance) const;

  double position_error(int goal) const;
  double rotation_error(int goal) const;

  // From here on the level holds what it got to.
  void Hold(int level);
  // How far the held levels are from that, at worst, m or rad. `values` (may be
  // null) receives, by row, what would bring them back.
  double Deviation(double* values) const;

  // Room that both kinds of rows take.
  int held_row_count() const { return held_row_count_; }
  int row_count(int level) const;
  // Adds the rows of the held levels: that they stay where they are or, with
  // `restore`, go back to what they hold.
  void AddHeld(const ConstVectorView& positions, bool restore, LevelStep& step);
  // Adds those of a level, and of its postures what no diagonal holds.
  void AddLevel(int level, const ConstVectorView& positions,
                const StepSpace& space, LevelStep& step);
  // Sets the diagonal: `damping`, by velocity, plus what postures add.
  void SetDiagonal(int level, absl::Span<const double> damping,
                   const ConstVectorView& positions, const StepSpace& space,
                   LevelStep& step) const;
  // After the step is solved: half-spaces that it stops at their plane stay
  // bound to it, so that none is thrown far beyond by a long step. True when
  // that changed how far the level is from what it wants.
  bool BindHalfSpaces(int level, const LevelStep& step);

 private:
  // Of one goal.
  struct State {
    kernel::GoalRows rows;
    double held[kernel::kMaxGoalRows];
    int level;
    // Of a half-space, see BindHalfSpaces.
    bool bound;
  };

  bool Counts(int goal, int row) const;
  double HalfSpaceDepth(const State& state) const;
  // All rows, valid until the next call.
  LevelStep::MatrixView ComputeJacobian(int goal,
                                        const ConstVectorView& positions);
  void MarkMoving(int goal);

  const IkProblem* problem_ = nullptr;
  GoalLinearizer linearizer_;
  std::vector<kernel::TaskTarget> targets_;
  std::vector<State> states_;
  std::vector<std::vector<kernel::PostureTerm>> postures_;
  std::vector<int> row_counts_;  // by level
  std::vector<int> first_columns_;
  std::vector<uint8_t> moves_;
  int level_count_ = 0;
  int held_levels_ = 0;
  int held_row_count_ = 0;
  std::vector<double> scratch_;  // kMaxGoalRows x velocity_count
};

}  // namespace gelenk

#endif  // GELENK_IK_GOAL_LEVELS_H_

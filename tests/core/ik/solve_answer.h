// What a solver answered, to compare bit by bit.
#ifndef TESTS_CORE_IK_SOLVE_ANSWER_H_
#define TESTS_CORE_IK_SOLVE_ANSWER_H_

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "gelenk/ik/solve_report.h"

namespace gelenk::testing {

struct SolveAnswer {
  Eigen::VectorXd positions;
  SolveReport report;
};

inline void ExpectSameBits(const SolveAnswer& a, const SolveAnswer& b) {
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.report.outcome, b.report.outcome);
  EXPECT_EQ(a.report.iteration_count, b.report.iteration_count);
  EXPECT_EQ(a.report.restart_count, b.report.restart_count);
  EXPECT_EQ(a.report.position_errors_m, b.report.position_errors_m);
  EXPECT_EQ(a.report.rotation_errors_rad, b.report.rotation_errors_rad);
  EXPECT_EQ(a.report.limited_joints, b.report.limited_joints);
  EXPECT_EQ(a.report.change, b.report.change);
}

}  // namespace gelenk::testing

#endif  // TESTS_CORE_IK_SOLVE_ANSWER_H_

// The parts of `gelenk bench ik`: tables of numbers, sets, judgement.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include "client/cli/bench/ik_run.h"
#include "client/cli/bench/ik_set.h"
#include "client/cli/bench/number_table.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Two links of 1 m in the plane and a side branch, which moves no tip.
std::shared_ptr<const Skeleton> Arm() {
  SkeletonBuilder builder;
  const auto add = [&builder](const char* id, const char* parent, double x,
                              double lower, double upper) {
    Joint joint;
    joint.id = id;
    joint.parent_id = parent;
    joint.type = JointType::kRevolute;
    joint.axis = Eigen::Vector3d::UnitZ();
    joint.parent_from_joint.translation.x() = x;
    if (lower < upper) {
      joint.limits.lower = {lower};
      joint.limits.upper = {upper};
    }
    builder.AddJoint(joint);
  };
  add("shoulder", "", 0, -1, 3);
  add("flag", "shoulder", 0, -1, 1);
  add("elbow", "shoulder", 1, 0, 0);
  EndEffector tip;
  tip.id = "tip";
  tip.joint_id = "elbow";
  tip.joint_from_end_effector.translation.x() = 1;
  builder.AddEndEffector(tip);
  return *builder.Build();
}

NumberTable Table(const std::string& text) {
  const auto table = ParseNumberTable(text);
  EXPECT_TRUE(table.ok()) << table.status();
  return *table;
}

std::string Error(const std::string& text) {
  const auto table = ParseNumberTable(text);
  EXPECT_FALSE(table.ok());
  return std::string(table.status().message());
}

// --- Tables ---

TEST(NumberTableTest, ReadsColumnsAndRows) {
  const NumberTable table = Table("a, b\r\n1,2\n\n-3e-2,4\n");
  EXPECT_THAT(table.columns, ElementsAre("a", "b"));
  EXPECT_THAT(table.numbers, ElementsAre(1, 2, -3e-2, 4));
  EXPECT_EQ(table.row_count(), 2);
  EXPECT_EQ(table.FindColumn("b"), 1);
  EXPECT_EQ(table.FindColumn("c"), -1);
}

TEST(NumberTableTest, ErrorsNameLineAndColumn) {
  EXPECT_THAT(Error("a,b\n1,2\n1,x\n"),
              testing::AllOf(HasSubstr("line 3"), HasSubstr("\"b\"")));
  EXPECT_THAT(Error("a,b\n1\n"), HasSubstr("line 2: want 2 cells, got 1"));
  EXPECT_THAT(Error("a,b\n1,2,3\n"), HasSubstr("line 2: more than 2 cells"));
  EXPECT_THAT(Error("a,a\n1,2\n"), HasSubstr("stands twice"));
  EXPECT_THAT(Error("a\nnan\n"), HasSubstr("line 2"));
  EXPECT_THAT(Error("a,b\n"), HasSubstr("no rows"));
  EXPECT_THAT(Error(""), HasSubstr("no rows"));
}

TEST(NumberTableTest, ReadsGzippedAndPlainFiles) {
  const std::string plain = testing::TempDir() + "/table.csv";
  const std::string packed = plain + ".gz";
  std::ofstream(plain) << "a\n7\n";
  gzFile file = gzopen(packed.c_str(), "wb");
  gzputs(file, "a\n7\n");
  gzclose(file);
  for (const std::string& path : {plain, packed}) {
    const auto table = ReadNumberTable(path);
    ASSERT_TRUE(table.ok()) << table.status();
    EXPECT_THAT(table->numbers, ElementsAre(7));
  }
  // Cut off in the middle.
  std::ifstream whole(packed, std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(whole), {});
  std::ofstream(packed, std::ios::binary) << bytes.substr(0, bytes.size() - 9);
  EXPECT_FALSE(ReadNumberTable(packed).ok());
  EXPECT_THAT(std::string(ReadNumberTable("/none.csv").status().message()),
              HasSubstr("/none.csv"));
}

// --- Sets ---

TEST(IkSetTest, ValuesAreThoseOfTheJointsOnTheWayOrOfAll) {
  const auto path = MakeIkSet(Arm(), {"tip"}, Table("q0,q1\n0,1.5707963268\n"),
                              BenchStart::kCold, BenchGoal::kPose);
  ASSERT_TRUE(path.ok()) << path.status();
  EXPECT_THAT(path->coordinate_names, ElementsAre("shoulder", "elbow"));
  EXPECT_TRUE(
      path->target(0, 0).translation.isApprox(Eigen::Vector3d(1, 1, 0), 1e-9));

  const auto all =
      MakeIkSet(Arm(), {"tip"}, Table("q0,q1,q2\n0,0.5,1.5707963268\n"),
                BenchStart::kCold, BenchGoal::kPose);
  ASSERT_TRUE(all.ok()) << all.status();
  EXPECT_THAT(all->coordinate_names, ElementsAre("shoulder", "flag", "elbow"));
  EXPECT_TRUE(
      all->target(0, 0).translation.isApprox(Eigen::Vector3d(1, 1, 0), 1e-9));
}

TEST(IkSetTest, AColdStartIsTheMiddleAndZeroWithoutLimits) {
  const auto set = MakeIkSet(Arm(), {"tip"}, Table("q0,q1\n0,0\n"),
                             BenchStart::kCold, BenchGoal::kPose);
  ASSERT_TRUE(set.ok());
  EXPECT_EQ(Eigen::VectorXd(set->start(0)), Eigen::Vector3d(1, 0, 0));
}

TEST(IkSetTest, APoseCountsBeforeValuesAndWarmColumnsStart) {
  const auto set = MakeIkSet(Arm(), {"tip"},
                             Table("q0,q1,warm0,warm1,px,py,pz,qx,qy,qz,qw\n"
                                   "0,0,0.1,0.2,1,1,0,0,0,0,1\n"),
                             BenchStart::kWarm, BenchGoal::kPose);
  ASSERT_TRUE(set.ok()) << set.status();
  EXPECT_EQ(set->target(0, 0).translation, Eigen::Vector3d(1, 1, 0));
  EXPECT_EQ(Eigen::VectorXd(set->start(0)), Eigen::Vector3d(0.1, 0, 0.2));
}

TEST(IkSetTest, APositionAloneIsAPositionGoal) {
  const auto set = MakeIkSet(Arm(), {"tip"}, Table("px,py,pz\n1,1,0\n"),
                             BenchStart::kCold, BenchGoal::kPose);
  ASSERT_TRUE(set.ok()) << set.status();
  EXPECT_EQ(set->goal, BenchGoal::kPosition);
  EXPECT_TRUE(std::holds_alternative<PositionGoal>(set->goals[0].kind));
}

TEST(IkSetTest, SeveralTipsHaveATargetEach) {
  const auto set = MakeIkSet(Arm(), {"tip", "flag"}, Table("q0,q1,q2\n0,0,0\n"),
                             BenchStart::kCold, BenchGoal::kPose);
  ASSERT_TRUE(set.ok()) << set.status();
  EXPECT_EQ(set->size(), 1);
  EXPECT_EQ(set->target(0, 0).translation, Eigen::Vector3d(2, 0, 0));
  EXPECT_EQ(set->target(0, 1).translation, Eigen::Vector3d(0, 0, 0));
}

TEST(IkSetTest, ErrorsSayWhatIsMissing) {
  const auto error = [](const std::string& tip, const std::string& text,
                        BenchStart start) {
    return std::string(
        MakeIkSet(Arm(), {tip}, Table(text), start, BenchGoal::kPose)
            .status()
            .message());
  };
  EXPECT_THAT(error("hand", "q0,q1\n0,0\n", BenchStart::kCold),
              HasSubstr("\"hand\""));
  EXPECT_THAT(error("tip", "x\n0\n", BenchStart::kCold), HasSubstr("q0, q1"));
  EXPECT_THAT(error("tip", "q0\n0\n", BenchStart::kCold),
              HasSubstr("want 2 columns q0"));
  EXPECT_THAT(error("tip", "q0,q1\n0,0\n", BenchStart::kWarm),
              HasSubstr("warm0"));
  EXPECT_THAT(
      error("tip", "px,py,pz,qx,qy,qz,qw\n1,0,0,0,0,0,2\n", BenchStart::kCold),
      HasSubstr("row 1"));
}

// --- Judgement ---

class JudgeTest : public ::testing::Test {
 protected:
  JudgeTest()
      : set_(*MakeIkSet(Arm(), {"tip"},
                        Table("q0,q1,warm0,warm1\n0.5,1,0.5,1.05\n"),
                        BenchStart::kWarm, BenchGoal::kPose)) {}

  IkFigures Judge(double shoulder, double elbow, double flag = 0) {
    IkAnswers answers;
    answers.positions = Eigen::Vector3d(shoulder, flag, elbow);
    answers.durations_us = {4};
    return JudgeIkAnswers(set_, answers, 1e-3);
  }

  IkSet set_;
};

TEST_F(JudgeTest, TheTruthIsSolved) {
  const IkFigures figures = Judge(0.5, 1);
  EXPECT_EQ(figures.solved, 1);
  EXPECT_EQ(figures.jumped, 0);
  EXPECT_EQ(figures.mean_us, 4);
}

TEST_F(JudgeTest, ToleranceHoldsFromBothSides) {
  // The elbow alone turns the tip, which is 1 m away from it.
  EXPECT_EQ(Judge(0.5, 1 + 1.7e-3).solved, 1);
  EXPECT_EQ(Judge(0.5, 1 + 1.8e-3).solved, 0);
  EXPECT_EQ(Judge(0.5, std::nan("")).solved, 0);
}

TEST_F(JudgeTest, OutsideLimitsIsNotSolved) {
  EXPECT_EQ(Judge(0.5, 1, 1 + 1e-7).solved, 1);
  const IkFigures figures = Judge(0.5, 1, 1 + 1e-5);
  EXPECT_EQ(figures.solved, 0);
  EXPECT_EQ(figures.outside_limits, 1);
}

TEST_F(JudgeTest, AWholeTurnIsAJump) {
  EXPECT_EQ(Judge(0.5, 1 + 2 * M_PI).jumped, 1);
  EXPECT_EQ(Judge(0.5, 1, 0.6).jumped, 1);
  EXPECT_EQ(Judge(0.5, 1, 0.4).jumped, 0);
}

TEST(IkRunTest, EveryProblemStartsFromItsOwnStart) {
  const auto set =
      MakeIkSet(Arm(), {"tip"}, Table("q0,q1,warm0,warm1\n0,0,1,0\n0,0,2,0\n"),
                BenchStart::kWarm, BenchGoal::kPose);
  ASSERT_TRUE(set.ok());
  const IkAnswers answers = RunIkSet(
      *set,
      [](int, Eigen::Ref<Eigen::VectorXd> positions) { positions[0] += 10; },
      3);
  EXPECT_EQ(answers.positions(0, 0), 11);
  EXPECT_EQ(answers.positions(0, 1), 12);
  EXPECT_EQ(answers.durations_us.size(), 2);
}

}  // namespace
}  // namespace gelenk::cli

// What a session holds while nobody drives it, as the allocator counts it.
#include <gtest/gtest.h>
#include <malloc.h>

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/session/session.h"
#include "server/session/session_registry.h"
#include "tests/testing/example_bodies.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::PersonWithFingers;
using ::gelenk::testing::SixTentacles;

// The promise for a body of 64 joints and six goals; transport and what
// sessions share are not counted.
constexpr size_t kPromisedBytes = 16 * 1024;
// For one with goals where no other session of its skeleton has any.
constexpr size_t kAloneBytes = 20 * 1024;
constexpr int kSessionCount = 100;

// Of the whole process, with what the allocator adds; 0 where a sanitizer has
// replaced it.
size_t AllocatedBytes() {
  const struct mallinfo2 counts = mallinfo2();
  return counts.uordblks + counts.hblkhd;
}

std::vector<Goal> PoseGoals(const std::vector<std::string>& effector_ids) {
  std::vector<Goal> goals;
  for (const std::string& id : effector_ids) {
    PoseGoal kind;
    kind.end_effector_id = id;
    goals.push_back({absl::StrCat("goal_", id), 1, kind});
  }
  return goals;
}

std::vector<Goal> SixGoals() {
  return PoseGoals(
      {"left_palm", "right_palm", "left_sole", "right_sole", "crown", "chest"});
}

std::shared_ptr<Session> MakeSession(std::string name,
                                     const std::shared_ptr<SharedTrees>& trees,
                                     const std::vector<Goal>& goals) {
  SessionState state;
  state.goals = goals;
  state.positions = trees->skeleton()->rest_positions();
  state.cold = false;
  return std::make_shared<Session>(name, "skeletons/body", name, trees,
                                   trees->CreateProblem(goals).value(), state,
                                   absl::UnixEpoch());
}

// Bytes of one of many sessions that were solved once and are idle now.
size_t BytesPerSession(
    const std::function<std::shared_ptr<SharedTrees>()>& trees,
    const std::vector<Goal>& goals) {
  uint64_t random = 0;
  SessionRegistry registry(2 * kSessionCount, [&random] { return ++random; });
  IkSolver solver;
  SolvedFrame solved;
  size_t counted = 0;
  const auto open = [&] {
    const std::shared_ptr<Session> session =
        registry
            .Create("default", "", "", absl::UnixEpoch(),
                    [&](std::string name) {
                      return MakeSession(std::move(name), trees(), goals);
                    })
            .value();
    EXPECT_TRUE(session->Solve(kUnaryDriver, solver, true, solved).ok());
    counted = session->ByteSize();
  };
  open();  // what the solver and the allocator take once
  const size_t before = AllocatedBytes();
  for (int i = 0; i < kSessionCount; ++i) open();
  const size_t bytes = (AllocatedBytes() - before) / kSessionCount;
  std::cout << bytes << " bytes a session, " << counted << " by ByteSize\n";
  return bytes;
}

TEST(SessionMemoryTest, APersonWithSixGoals) {
  const auto trees = std::make_shared<SharedTrees>(PersonWithFingers());
  ASSERT_EQ(trees->skeleton()->joint_count(), 64);
  EXPECT_LE(BytesPerSession([&] { return trees; }, SixGoals()), kPromisedBytes);
  EXPECT_EQ(trees->tree_count(), 0) << "trees go with their sessions";
}

TEST(SessionMemoryTest, SixGoalsThatMoveEveryJoint) {
  const auto trees = std::make_shared<SharedTrees>(SixTentacles());
  ASSERT_EQ(trees->skeleton()->joint_count(), 64);
  EXPECT_LE(BytesPerSession(
                [&] { return trees; },
                PoseGoals({"tip0", "tip1", "tip2", "tip3", "tip4", "tip5"})),
            kPromisedBytes);
}

TEST(SessionMemoryTest, APersonWhoSharesItsTreeWithNobody) {
  const auto body = PersonWithFingers();
  EXPECT_LE(BytesPerSession([&] { return std::make_shared<SharedTrees>(body); },
                            SixGoals()),
            kAloneBytes);
}

TEST(SessionMemoryTest, ByteSizeIsWhatTheAllocatorCounts) {
  const auto trees = std::make_shared<SharedTrees>(PersonWithFingers());
  const size_t bytes = BytesPerSession([&] { return trees; }, SixGoals());
  const size_t counted =
      MakeSession("sessions/s", trees, SixGoals())->ByteSize();
  // The registry's entry and what the allocator adds are not in it.
  constexpr size_t kAround = 600;
  if (bytes > 0) {
    EXPECT_LE(counted, bytes);
    EXPECT_GE(counted + kAround, bytes);
  }
}

}  // namespace
}  // namespace gelenk::server

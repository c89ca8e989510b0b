#include "server/rpc/worker_pool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "absl/synchronization/notification.h"

namespace gelenk::server {
namespace {

using ::testing::ElementsAre;

WorkerPool::Work Doing(std::function<void()> work) {
  return [work = std::move(work)](IkSolver&) { work(); };
}

TEST(WorkerPoolTest, RunsWhatWaitsInOrderBeforeItGoes) {
  std::vector<int> done;
  {
    WorkerPool pool(1, 100, InstructionSet::kBaseline);
    for (int i = 0; i < 5; ++i) {
      ASSERT_TRUE(pool.Submit(Doing([&done, i] { done.push_back(i); })));
    }
  }
  EXPECT_THAT(done, ElementsAre(0, 1, 2, 3, 4));
}

TEST(WorkerPoolTest, RefusesMoreThanMayWait) {
  absl::Notification started;
  absl::Notification go_on;
  std::atomic<int> done = 0;
  {
    WorkerPool pool(1, 2, InstructionSet::kBaseline);
    ASSERT_TRUE(pool.Submit(Doing([&] {
      started.Notify();
      go_on.WaitForNotification();
      ++done;
    })));
    started.WaitForNotification();  // it waits no longer, it runs
    EXPECT_TRUE(pool.Submit(Doing([&] { ++done; })));
    EXPECT_TRUE(pool.Submit(Doing([&] { ++done; })));
    EXPECT_FALSE(pool.Submit(Doing([&] { done = 1000; })));
    go_on.Notify();
  }
  EXPECT_EQ(done, 3);
}

TEST(WorkerPoolTest, GivesEachThreadItsSolver) {
  constexpr int kThreads = 3;
  std::mutex mutex;
  std::condition_variable came;
  std::set<IkSolver*> solvers;
  {
    WorkerPool pool(kThreads, 100, InstructionSet::kBaseline);
    for (int i = 0; i < kThreads; ++i) {
      ASSERT_TRUE(pool.Submit([&](IkSolver& solver) {
        EXPECT_EQ(solver.instruction_set(), InstructionSet::kBaseline);
        std::unique_lock<std::mutex> lock(mutex);
        solvers.insert(&solver);
        // Holds its thread until each one has had its turn.
        came.notify_all();
        came.wait(lock, [&solvers] { return solvers.size() == kThreads; });
      }));
    }
  }
  EXPECT_EQ(solvers.size(), kThreads);
}

TEST(WorkerPoolTest, WorkMaySubmitWork) {
  std::atomic<int> done = 0;
  absl::Notification both;
  WorkerPool pool(1, 10, InstructionSet::kBaseline);
  ASSERT_TRUE(pool.Submit(Doing([&] {
    ++done;
    EXPECT_TRUE(pool.Submit(Doing([&] {
      ++done;
      both.Notify();
    })));
  })));
  both.WaitForNotification();
  EXPECT_EQ(done, 2);
}

// The second part waits for the first: somebody else must run that.
TEST(WorkerPoolTest, IdleThreadsHelpWithParts) {
  WorkerPool pool(2, 10, InstructionSet::kBaseline);
  absl::Notification ran[2];
  pool.RunParts(2, [&](int part) {
    ran[part].Notify();
    ran[1 - part].WaitForNotification();
  });
  EXPECT_TRUE(ran[0].HasBeenNotified());
}

TEST(WorkerPoolTest, BusyThreadsLeaveThePartsToTheCaller) {
  absl::Notification go_on;
  WorkerPool pool(1, 10, InstructionSet::kBaseline);
  ASSERT_TRUE(pool.Submit(Doing([&] { go_on.WaitForNotification(); })));
  std::vector<int> done;
  pool.RunParts(5, [&](int part) { done.push_back(part); });
  EXPECT_THAT(done, ElementsAre(0, 1, 2, 3, 4));
  go_on.Notify();
}

// Loops from many threads at once, inside of work as well, among other work.
TEST(WorkerPoolTest, EveryPartRunsOnce) {
  constexpr int kLoops = 100;
  constexpr int kParts = 20;
  std::atomic<int> runs = 0;
  {
    WorkerPool pool(3, 1000, InstructionSet::kBaseline);
    const auto loop = [&] {
      std::vector<std::atomic<int>> counts(kParts);
      pool.RunParts(kParts, [&](int part) { ++counts[part]; });
      for (const std::atomic<int>& count : counts) EXPECT_EQ(count, 1);
      ++runs;
    };
    std::vector<std::thread> threads;
    for (int t = 0; t < 3; ++t) {
      threads.emplace_back([&] {
        for (int i = 0; i < kLoops; ++i) {
          loop();
          ASSERT_TRUE(pool.Submit(Doing(loop)));
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  }
  EXPECT_EQ(runs, 2 * 3 * kLoops);
}

TEST(WorkerPoolTest, TakesWorkFromManyThreads) {
  constexpr int kThreads = 4;
  constexpr int kEach = 200;
  std::atomic<int> done = 0;
  std::atomic<int> refused = 0;
  {
    WorkerPool pool(2, 50, InstructionSet::kBaseline);
    std::vector<std::thread> threads;
    for (int t = 0; t < kThreads; ++t) {
      threads.emplace_back([&] {
        for (int i = 0; i < kEach; ++i) {
          if (!pool.Submit(Doing([&done] { ++done; }))) ++refused;
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  }
  EXPECT_EQ(done + refused, kThreads * kEach);
  EXPECT_GT(done, 0);
}

}  // namespace
}  // namespace gelenk::server

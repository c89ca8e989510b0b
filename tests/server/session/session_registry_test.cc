#include "server/session/session_registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "tests/testing/example_sessions.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::ArmSessionNamed;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr absl::string_view kTheirs = "somebody-else";
constexpr absl::Duration kTtl = absl::Minutes(10);  // of an arm session
const absl::Time kNow = absl::FromUnixSeconds(1000);

class SessionRegistryTest : public ::testing::Test {
 protected:
  absl::StatusOr<std::shared_ptr<Session>> Create(
      absl::string_view id, absl::string_view request_id = "",
      absl::Time now = kNow, absl::string_view tenant = kDefaultTenant) {
    return registry_.Create(tenant, id, request_id, now,
                            [now](std::string name) {
                              return absl::StatusOr<std::shared_ptr<Session>>(
                                  ArmSessionNamed(std::move(name), now));
                            });
  }
  absl::StatusCode Find(absl::string_view name, absl::Time now = kNow,
                        absl::string_view tenant = kDefaultTenant) {
    return registry_.Find(tenant, name, now).status().code();
  }
  std::vector<std::string> Names(absl::string_view after, size_t limit,
                                 absl::Time now = kNow,
                                 absl::string_view tenant = kDefaultTenant) {
    std::vector<std::string> names;
    for (const auto& session : registry_.List(tenant, after, limit, now)) {
      names.push_back(session->name());
    }
    return names;
  }

  uint64_t random_ = 0xabc;
  SessionRegistry registry_{4, [this] { return random_++; }};
};

TEST_F(SessionRegistryTest, KeepsWhatItMade) {
  const auto created = Create("hand");
  ASSERT_TRUE(created.ok());
  EXPECT_EQ((*created)->name(), "sessions/hand");
  EXPECT_EQ(registry_.Find(kDefaultTenant, "sessions/hand", kNow).value(),
            *created);
  EXPECT_EQ(registry_.size(), 1);
}

TEST_F(SessionRegistryTest, NamesThoseWithoutAnId) {
  EXPECT_EQ((*Create(""))->name(), "sessions/s-0000000000000abc");
  EXPECT_EQ((*Create(""))->name(), "sessions/s-0000000000000abd");
}

TEST_F(SessionRegistryTest, RefusesANameThatIsTaken) {
  ASSERT_TRUE(Create("hand").ok());
  const absl::Status again = Create("hand").status();
  EXPECT_EQ(again.code(), absl::StatusCode::kAlreadyExists);
  EXPECT_THAT(std::string(again.message()), HasSubstr("sessions/hand"));
}

TEST_F(SessionRegistryTest, GivesTheNameOfAnExpiredOneAgain) {
  const auto first = Create("hand").value();
  const absl::Time later = kNow + kTtl;
  const auto second = Create("hand", "", later);
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_NE(*second, first);
  EXPECT_EQ(first->ended().code(), absl::StatusCode::kNotFound)
      << "whoever drives the first is told";
  EXPECT_TRUE((*second)->ended().ok());
}

TEST_F(SessionRegistryTest, KeepsNothingThatCouldNotBeMade) {
  const absl::Status bad = absl::InvalidArgumentError("no such skeleton");
  const auto fails = [&bad](std::string) {
    return absl::StatusOr<std::shared_ptr<Session>>(bad);
  };
  EXPECT_EQ(
      registry_.Create(kDefaultTenant, "hand", "request", kNow, fails).status(),
      bad);
  EXPECT_EQ(registry_.size(), 0);
  EXPECT_TRUE(Create("hand", "request").ok()) << "a corrected retry is taken";
}

TEST_F(SessionRegistryTest, RefusesMoreThanItsLimit) {
  for (const char* id : {"s1", "s2", "s3", "s4"}) {
    ASSERT_TRUE(Create(id).ok());
  }
  const absl::Status fifth = Create("s5").status();
  EXPECT_EQ(fifth.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(fifth.message()), HasSubstr("4 sessions"));
  ASSERT_TRUE(registry_.Delete(kDefaultTenant, "sessions/s2").ok());
  EXPECT_TRUE(Create("s5").ok());
}

// --- Retries ---

TEST_F(SessionRegistryTest, ARepeatedRequestAnswersTheFirstResult) {
  const auto first = Create("", "request").value();
  EXPECT_EQ(Create("", "request").value(), first);
  EXPECT_EQ(registry_.size(), 1);
  EXPECT_NE(Create("", "another").value(), first);
}

TEST_F(SessionRegistryTest, ARepeatedRequestMayNameItsSession) {
  const auto first = Create("hand", "request").value();
  EXPECT_EQ(Create("hand", "request").value(), first);
}

TEST_F(SessionRegistryTest, ARepeatAtTheLimitIsAnswered) {
  const auto first = Create("s1", "request").value();
  for (const char* id : {"s2", "s3", "s4"}) ASSERT_TRUE(Create(id).ok());
  EXPECT_EQ(Create("s1", "request").value(), first);
}

TEST_F(SessionRegistryTest, ARequestWhoseSessionIsGoneMakesANewOne) {
  const auto first = Create("", "request").value();
  ASSERT_TRUE(registry_.Delete(kDefaultTenant, first->name()).ok());
  const auto second = Create("", "request").value();
  EXPECT_NE(second->name(), first->name());
  EXPECT_EQ(Create("", "request").value(), second);
}

// --- Expiry ---

TEST_F(SessionRegistryTest, FindsNothingExpired) {
  ASSERT_TRUE(Create("hand").ok());
  EXPECT_EQ(Find("sessions/hand", kNow + kTtl - absl::Nanoseconds(1)),
            absl::StatusCode::kOk);
  EXPECT_EQ(Find("sessions/hand", kNow + kTtl), absl::StatusCode::kNotFound);
}

TEST_F(SessionRegistryTest, SweepsWhatHasExpired) {
  const auto old = Create("old-one").value();
  const auto young = Create("young-one", "", kNow + absl::Minutes(5)).value();
  EXPECT_EQ(registry_.Sweep(kNow), 0);
  EXPECT_EQ(registry_.Sweep(kNow + kTtl), 1);
  EXPECT_EQ(registry_.size(), 1);
  EXPECT_EQ(old->ended().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(old->ended().message()), HasSubstr("expired"));
  EXPECT_TRUE(young->ended().ok());
}

TEST_F(SessionRegistryTest, EndsWhatIsDeleted) {
  const auto session = Create("hand").value();
  ASSERT_TRUE(registry_.Delete(kDefaultTenant, "sessions/hand").ok());
  EXPECT_THAT(std::string(session->ended().message()), HasSubstr("deleted"));
  EXPECT_EQ(Find("sessions/hand"), absl::StatusCode::kNotFound);
  EXPECT_EQ(registry_.Delete(kDefaultTenant, "sessions/hand").code(),
            absl::StatusCode::kNotFound);
}

// --- Lists ---

TEST_F(SessionRegistryTest, ListsPageByPageInOrderOfName) {
  for (const char* id : {"cc", "aa", "dd", "bb"}) ASSERT_TRUE(Create(id).ok());
  EXPECT_THAT(Names("", 3),
              ElementsAre("sessions/aa", "sessions/bb", "sessions/cc"));
  EXPECT_THAT(Names("sessions/cc", 3), ElementsAre("sessions/dd"));
  EXPECT_THAT(Names("sessions/dd", 3), IsEmpty());
}

TEST_F(SessionRegistryTest, PagesGoOnBehindADeletedOne) {
  for (const char* id : {"aa", "bb", "cc"}) ASSERT_TRUE(Create(id).ok());
  ASSERT_TRUE(registry_.Delete(kDefaultTenant, "sessions/bb").ok());
  EXPECT_THAT(Names("sessions/bb", 3), ElementsAre("sessions/cc"));
}

TEST_F(SessionRegistryTest, ListsNothingExpired) {
  ASSERT_TRUE(Create("old-one").ok());
  ASSERT_TRUE(Create("young-one", "", kNow + absl::Minutes(5)).ok());
  EXPECT_THAT(Names("", 9, kNow + kTtl), ElementsAre("sessions/young-one"));
}

// --- Tenants ---

TEST_F(SessionRegistryTest, TenantsDoNotSeeEachOther) {
  const auto ours = Create("hand", "request").value();
  EXPECT_EQ(Find("sessions/hand", kNow, kTheirs), absl::StatusCode::kNotFound);
  EXPECT_EQ(registry_.Delete(kTheirs, "sessions/hand").code(),
            absl::StatusCode::kNotFound);
  const auto theirs = Create("hand", "request", kNow, kTheirs);
  ASSERT_TRUE(theirs.ok()) << "neither names nor requests collide";
  EXPECT_NE(*theirs, ours);
  EXPECT_THAT(Names("", 9, kNow, kTheirs), ElementsAre("sessions/hand"));
  EXPECT_THAT(Names("", 9), ElementsAre("sessions/hand"));
  ASSERT_TRUE(registry_.Delete(kTheirs, "sessions/hand").ok());
  EXPECT_EQ(Find("sessions/hand"), absl::StatusCode::kOk);
}

TEST_F(SessionRegistryTest, AnotherTenantsNameIsToldFromNoneByNothing) {
  ASSERT_TRUE(Create("hand").ok());
  EXPECT_EQ(registry_.Find(kTheirs, "sessions/hand", kNow).status(),
            SessionRegistry(4, [] { return 0; })
                .Find(kTheirs, "sessions/hand", kNow)
                .status());
}

TEST_F(SessionRegistryTest, RemovesOnlySkeletonsThatNoSessionIsOn) {
  int removed = 0;
  const auto remove = [&](absl::string_view tenant, absl::string_view skeleton,
                          absl::Time now) {
    return registry_.RemoveUnused(tenant, skeleton, now, [&removed] {
      ++removed;
      return absl::NotFoundError("said by what removes");
    });
  };
  const auto expect_removed = [&](const absl::Status& status) {
    EXPECT_TRUE(absl::IsNotFound(status)) << status;
    EXPECT_EQ(std::exchange(removed, 0), 1);
  };
  expect_removed(remove(kDefaultTenant, "skeletons/arm", kNow));
  ASSERT_TRUE(Create("hand").ok());
  const absl::Status used = remove(kDefaultTenant, "skeletons/arm", kNow);
  EXPECT_TRUE(absl::IsFailedPrecondition(used));
  EXPECT_EQ(used.message(), "name: sessions/hand is on skeletons/arm");
  EXPECT_EQ(removed, 0);
  expect_removed(remove(kDefaultTenant, "skeletons/leg", kNow));
  expect_removed(remove(kTheirs, "skeletons/arm", kNow));
  // Expired, though not swept yet.
  expect_removed(
      remove(kDefaultTenant, "skeletons/arm", kNow + absl::Minutes(10)));
}

// --- Many at once ---

TEST_F(SessionRegistryTest, ServesThreads) {
  constexpr int kThreads = 4;
  constexpr int kRounds = 50;
  SessionRegistry registry(kThreads * kRounds, [] { return 0; });
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([t, &registry] {
      for (int i = 0; i < kRounds; ++i) {
        const std::string id = absl::StrCat("s-", t, "-", i);
        const auto session =
            registry.Create(kDefaultTenant, id, id, kNow, [](std::string name) {
              return absl::StatusOr<std::shared_ptr<Session>>(
                  ArmSessionNamed(std::move(name), kNow));
            });
        EXPECT_TRUE(session.ok());
        EXPECT_TRUE(
            registry.Find(kDefaultTenant, (*session)->name(), kNow).ok());
        registry.List(kDefaultTenant, "", 10, kNow);
        registry.Sweep(kNow);
        if (i % 2 == 0) {
          EXPECT_TRUE(registry.Delete(kDefaultTenant, (*session)->name()).ok());
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(registry.size(), kThreads * kRounds / 2);
}

}  // namespace
}  // namespace gelenk::server

#include "server/store/skeleton_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/testing/example_skeletons.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::PandaArm;
using ::gelenk::testing::PlanarChain;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr absl::string_view kTheirs = "somebody-else";
constexpr size_t kPlenty = 1 << 20;

StoredSkeleton Panda() {
  StoredSkeleton skeleton;
  skeleton.display_name = "Panda";
  skeleton.warnings = {"no limits"};
  skeleton.create_time = absl::FromUnixSeconds(1000);
  skeleton.skeleton = PandaArm();
  return skeleton;
}

class SkeletonStoreTest : public ::testing::Test {
 protected:
  SkeletonStore StoreOf(SkeletonStore::Bounds bounds) {
    return {bounds, [this] { return random_++; }};
  }
  absl::StatusOr<StoredSkeleton> Create(
      absl::string_view id, absl::string_view request_id = "",
      absl::string_view tenant = kDefaultTenant) {
    return store_.Create(tenant, id, request_id, Panda());
  }
  std::vector<std::string> Names(absl::string_view after, size_t limit,
                                 absl::string_view tenant = kDefaultTenant) {
    std::vector<std::string> names;
    for (const StoredSkeleton& stored : store_.List(tenant, after, limit)) {
      names.push_back(stored.name);
    }
    return names;
  }

  uint64_t random_ = 0xabc;
  SkeletonStore store_{{4, kPlenty}, [this] { return random_++; }};
};

TEST_F(SkeletonStoreTest, KeepsWhatItWasGiven) {
  const StoredSkeleton created = Create("panda").value();
  EXPECT_EQ(created.name, "skeletons/panda");
  const StoredSkeleton found =
      store_.Find(kDefaultTenant, "skeletons/panda").value();
  EXPECT_EQ(found.skeleton, created.skeleton) << "one copy";
  EXPECT_EQ(found.trees, created.trees) << "one set of trees";
  EXPECT_EQ(found.trees->skeleton(), found.skeleton);
  EXPECT_EQ(found.display_name, "Panda");
  EXPECT_THAT(found.warnings, ElementsAre("no limits"));
  EXPECT_EQ(found.create_time, absl::FromUnixSeconds(1000));
}

TEST_F(SkeletonStoreTest, NamesThoseWithoutAnId) {
  EXPECT_EQ(Create("")->name, "skeletons/k-0000000000000abc");
}

TEST_F(SkeletonStoreTest, RefusesANameThatIsTaken) {
  ASSERT_TRUE(Create("panda").ok());
  const absl::Status again = Create("panda").status();
  EXPECT_EQ(again.code(), absl::StatusCode::kAlreadyExists);
  EXPECT_THAT(std::string(again.message()), HasSubstr("skeletons/panda"));
}

TEST_F(SkeletonStoreTest, ARepeatedRequestAnswersTheFirstResult) {
  const StoredSkeleton first = Create("", "request").value();
  EXPECT_EQ(Create("", "request")->name, first.name);
  EXPECT_NE(Create("", "another")->name, first.name);
  EXPECT_NE(Create("", "request", kTheirs)->name, first.name);
}

TEST_F(SkeletonStoreTest, ARequestWhoseSkeletonIsGoneMakesANewOne) {
  const StoredSkeleton first = Create("", "request").value();
  ASSERT_TRUE(store_.Delete(kDefaultTenant, first.name).ok());
  const StoredSkeleton second = Create("", "request").value();
  EXPECT_NE(second.name, first.name);
  EXPECT_EQ(Create("", "request")->name, second.name);
}

TEST_F(SkeletonStoreTest, RefusesMoreThanItsCount) {
  for (const char* id : {"aa", "bb", "cc", "dd"}) ASSERT_TRUE(Create(id).ok());
  const absl::Status fifth = Create("ee").status();
  EXPECT_EQ(fifth.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(fifth.message()), HasSubstr("4 skeletons"));
  ASSERT_TRUE(store_.Delete(kDefaultTenant, "skeletons/bb").ok());
  EXPECT_TRUE(Create("ee").ok());
}

TEST_F(SkeletonStoreTest, RefusesMoreThanItsBytes) {
  const size_t bytes = PandaArm()->ByteSize();
  SkeletonStore exact = StoreOf({100, 2 * bytes});
  EXPECT_TRUE(exact.Create(kDefaultTenant, "aa", "", Panda()).ok());
  EXPECT_TRUE(exact.Create(kDefaultTenant, "bb", "", Panda()).ok());
  EXPECT_EQ(exact.Create(kDefaultTenant, "cc", "", Panda()).status().code(),
            absl::StatusCode::kResourceExhausted);
  ASSERT_TRUE(exact.Delete(kDefaultTenant, "skeletons/aa").ok());
  EXPECT_TRUE(exact.Create(kDefaultTenant, "cc", "", Panda()).ok());

  SkeletonStore small = StoreOf({100, 2 * bytes - 1});
  EXPECT_TRUE(small.Create(kDefaultTenant, "aa", "", Panda()).ok());
  EXPECT_EQ(small.Create(kDefaultTenant, "bb", "", Panda()).status().code(),
            absl::StatusCode::kResourceExhausted);
}

TEST_F(SkeletonStoreTest, ARefusedSkeletonTakesNoBytes) {
  const size_t bytes = PandaArm()->ByteSize();
  SkeletonStore store = StoreOf({100, 2 * bytes});
  ASSERT_TRUE(store.Create(kDefaultTenant, "aa", "", Panda()).ok());
  ASSERT_FALSE(store.Create(kDefaultTenant, "aa", "", Panda()).ok());
  EXPECT_TRUE(store.Create(kDefaultTenant, "bb", "", Panda()).ok());
}

TEST_F(SkeletonStoreTest, CountsMoreForLargerSkeletons) {
  const auto small = PlanarChain(Eigen::Vector3d::Zero(), {1});
  const auto large =
      PlanarChain(Eigen::Vector3d::Zero(), std::vector<double>(50, 1.0));
  EXPECT_GT(large->ByteSize(), 10 * small->ByteSize());
}

TEST_F(SkeletonStoreTest, ASkeletonInUseOutlivesItsDeletion) {
  const StoredSkeleton created = Create("panda").value();
  ASSERT_TRUE(store_.Delete(kDefaultTenant, "skeletons/panda").ok());
  EXPECT_EQ(created.skeleton->joint_count(), 7);
  EXPECT_EQ(store_.Delete(kDefaultTenant, "skeletons/panda").code(),
            absl::StatusCode::kNotFound);
}

TEST_F(SkeletonStoreTest, ListsPageByPageInOrderOfName) {
  for (const char* id : {"cc", "aa", "dd", "bb"}) ASSERT_TRUE(Create(id).ok());
  EXPECT_THAT(Names("", 3),
              ElementsAre("skeletons/aa", "skeletons/bb", "skeletons/cc"));
  EXPECT_THAT(Names("skeletons/cc", 3), ElementsAre("skeletons/dd"));
  EXPECT_THAT(Names("skeletons/dd", 3), IsEmpty());
}

TEST_F(SkeletonStoreTest, TenantsDoNotSeeEachOther) {
  ASSERT_TRUE(Create("panda").ok());
  EXPECT_EQ(store_.Find(kTheirs, "skeletons/panda").status().code(),
            absl::StatusCode::kNotFound);
  EXPECT_EQ(store_.Delete(kTheirs, "skeletons/panda").code(),
            absl::StatusCode::kNotFound);
  EXPECT_THAT(Names("", 9, kTheirs), IsEmpty());
  EXPECT_TRUE(Create("panda", "", kTheirs).ok());
  EXPECT_THAT(Names("", 9, kTheirs), ElementsAre("skeletons/panda"));
  EXPECT_THAT(Names("", 9), ElementsAre("skeletons/panda"));
}

TEST_F(SkeletonStoreTest, BundledSkeletonsAreThereForEverybodyAndStay) {
  const auto ours = store_.Find(kDefaultTenant, "skeletons/humanoid");
  ASSERT_TRUE(ours.ok()) << ours.status();
  EXPECT_EQ(ours->skeleton->joint_count(), 22);
  EXPECT_EQ(store_.Find(kTheirs, "skeletons/humanoid")->skeleton,
            ours->skeleton);
  EXPECT_EQ(Create("humanoid").status().code(),
            absl::StatusCode::kAlreadyExists);
  EXPECT_EQ(store_.Delete(kDefaultTenant, "skeletons/humanoid").code(),
            absl::StatusCode::kFailedPrecondition);
  EXPECT_TRUE(store_.Find(kDefaultTenant, "skeletons/humanoid").ok());
  EXPECT_THAT(Names("", 10), IsEmpty());
}

}  // namespace
}  // namespace gelenk::server

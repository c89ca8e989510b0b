#include "server/store/skin_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "gelenk/skin/example_shapes.h"
#include "gelenk/skin/weighted_skin.h"
#include "tests/testing/status_matchers.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::Fails;
using ::testing::ElementsAre;

constexpr absl::string_view kTheirs = "somebody-else";
constexpr size_t kPlenty = 1 << 26;

// A small one; each call makes another.
std::shared_ptr<const Skin> Tube() {
  const SkinShape shape = MakeSkinShape("cylinder", 100).value();
  return WeightedSkin::Create(
             shape.skeleton, shape.mesh,
             RigidWeights(static_cast<int>(shape.mesh.positions.size()), 0), {})
      .value();
}

StoredSkin OnArm() {
  StoredSkin skin;
  skin.display_name = "Tube";
  skin.skeleton_name = "skeletons/arm";
  skin.create_time = absl::FromUnixSeconds(1000);
  skin.revision.skin = Tube();
  return skin;
}

absl::Status IsThere() { return absl::OkStatus(); }

class SkinStoreTest : public ::testing::Test {
 protected:
  SkinStore StoreOf(SkinStore::Bounds bounds) {
    return {bounds, [this] { return random_++; }};
  }
  absl::StatusOr<StoredSkin> Create(absl::string_view id,
                                    absl::string_view request_id = "",
                                    absl::string_view tenant = kDefaultTenant) {
    return store_.Create(tenant, id, request_id, OnArm(), IsThere);
  }
  absl::StatusOr<StoredSkin> Edit(SkinStore& store,
                                  std::optional<int64_t> expected,
                                  absl::string_view request_id = "") {
    SkinRevision revision;
    revision.base = expected.value_or(1);
    revision.skin = Tube();
    return store.AddRevision(kDefaultTenant, "skins/tube", request_id, expected,
                             std::move(revision));
  }
  std::vector<std::string> Names(absl::string_view after, size_t limit) {
    std::vector<std::string> names;
    for (const StoredSkin& skin : store_.List(kDefaultTenant, after, limit)) {
      names.push_back(skin.name);
    }
    return names;
  }

  uint64_t random_ = 0xabc;
  SkinStore store_{{4, kPlenty, 3}, [this] { return random_++; }};
};

TEST_F(SkinStoreTest, KeepsWhatItWasGiven) {
  const StoredSkin created = Create("tube").value();
  EXPECT_EQ(created.name, "skins/tube");
  EXPECT_EQ(created.revision.number, 1);
  EXPECT_EQ(created.byte_size, created.revision.skin->ByteSize());
  const StoredSkin found =
      store_.Find(kDefaultTenant, "skins/tube", std::nullopt).value();
  EXPECT_EQ(found.revision.skin, created.revision.skin) << "one copy";
  EXPECT_EQ(found.display_name, "Tube");
  EXPECT_THAT(store_.Find(kTheirs, "skins/tube", std::nullopt).status(),
              Fails(absl::StatusCode::kNotFound, "skins/tube"));
}

TEST_F(SkinStoreTest, MakesNamesAndRefusesThoseThatAreTaken) {
  EXPECT_EQ(Create("").value().name, "skins/n-0000000000000abc");
  ASSERT_TRUE(Create("tube").ok());
  EXPECT_THAT(Create("tube").status(),
              Fails(absl::StatusCode::kAlreadyExists, "skin_id: skins/tube"));
  EXPECT_TRUE(Create("tube", "", kTheirs).ok());
}

TEST_F(SkinStoreTest, ARepeatedCreateAnswersTheFirst) {
  const StoredSkin first = Create("", "once").value();
  EXPECT_EQ(Create("", "once").value().revision.skin, first.revision.skin);
  EXPECT_EQ(store_.FindCreated(kDefaultTenant, "once")->name, first.name);
  EXPECT_FALSE(store_.FindCreated(kTheirs, "once"));
  EXPECT_FALSE(store_.FindCreated(kDefaultTenant, ""));
}

TEST_F(SkinStoreTest, TakesNothingWhoseSkeletonHasGone) {
  const absl::Status gone = absl::NotFoundError("skeletons/arm");
  EXPECT_EQ(
      store_
          .Create(kDefaultTenant, "tube", "", OnArm(), [&gone] { return gone; })
          .status(),
      gone);
  EXPECT_THAT(Names("", 9), ElementsAre());
}

TEST_F(SkinStoreTest, HoldsSoManyAndNoMore) {
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(Create("").ok());
  EXPECT_THAT(Create("").status(),
              Fails(absl::StatusCode::kResourceExhausted, "4 skins"));
  ASSERT_TRUE(store_.Delete(kDefaultTenant, Names("", 1)[0]).ok());
  EXPECT_TRUE(Create("").ok());
}

TEST_F(SkinStoreTest, HoldsSoManyBytesAndNoMore) {
  const size_t one = Tube()->ByteSize();
  SkinStore store = StoreOf({100, 2 * one, 3});
  const auto create = [&store] {
    return store.Create(kDefaultTenant, "", "", OnArm(), IsThere).status();
  };
  EXPECT_EQ(create(), absl::OkStatus());
  EXPECT_EQ(create(), absl::OkStatus());
  EXPECT_EQ(create().code(), absl::StatusCode::kResourceExhausted);
}

TEST_F(SkinStoreTest, EditsMakeRevisions) {
  const StoredSkin first = Create("tube").value();
  const StoredSkin second = Edit(store_, 1).value();
  EXPECT_EQ(second.revision.number, 2);
  EXPECT_EQ(second.revision.base, 1);
  EXPECT_EQ(second.byte_size, 2 * first.byte_size);
  EXPECT_EQ(store_.Find(kDefaultTenant, "skins/tube", 1).value().revision.skin,
            first.revision.skin);
  EXPECT_EQ(store_.Find(kDefaultTenant, "skins/tube", std::nullopt)
                .value()
                .revision.number,
            2);
  EXPECT_THAT(store_.Find(kDefaultTenant, "skins/tube", 3).status(),
              Fails(absl::StatusCode::kNotFound, "skins/tube@3"));
}

TEST_F(SkinStoreTest, TheSecondOfTwoEditsOfOneRevisionIsTold) {
  ASSERT_TRUE(Create("tube").ok());
  ASSERT_TRUE(Edit(store_, 1).ok());
  EXPECT_THAT(Edit(store_, 1).status(),
              Fails(absl::StatusCode::kAborted, "revision 2"));
  EXPECT_EQ(Edit(store_, std::nullopt).value().revision.number, 3)
      << "from an older one on purpose";
}

TEST_F(SkinStoreTest, ARepeatedEditIsFound) {
  ASSERT_TRUE(Create("tube").ok());
  ASSERT_TRUE(Edit(store_, 1, "once").ok());
  ASSERT_TRUE(Edit(store_, 2).ok());
  const auto found = store_.FindAdded(kDefaultTenant, "skins/tube", "once");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->revision.number, 2);
  EXPECT_FALSE(store_.FindAdded(kDefaultTenant, "skins/other", "once"));
  EXPECT_FALSE(store_.FindAdded(kDefaultTenant, "skins/tube", "twice"));
  EXPECT_FALSE(store_.FindAdded(kDefaultTenant, "skins/tube", ""));
}

TEST_F(SkinStoreTest, TheOldestRevisionsGo) {
  ASSERT_TRUE(Create("tube").ok());
  for (int i = 1; i <= 4; ++i) ASSERT_TRUE(Edit(store_, i).ok());
  for (int gone : {1, 2}) {
    EXPECT_EQ(store_.Find(kDefaultTenant, "skins/tube", gone).status().code(),
              absl::StatusCode::kNotFound);
  }
  const StoredSkin oldest =
      store_.Find(kDefaultTenant, "skins/tube", 3).value();
  EXPECT_EQ(oldest.byte_size, 3 * oldest.revision.skin->ByteSize());
}

TEST_F(SkinStoreTest, RevisionsMakeRoomForThemselvesOnly) {
  const size_t one = Tube()->ByteSize();
  SkinStore store = StoreOf({100, 3 * one, 3});
  ASSERT_TRUE(store.Create(kDefaultTenant, "tube", "", OnArm(), IsThere).ok());
  ASSERT_TRUE(store.Create(kDefaultTenant, "other", "", OnArm(), IsThere).ok());
  ASSERT_TRUE(Edit(store, 1).ok());
  ASSERT_TRUE(Edit(store, 2).ok());
  EXPECT_FALSE(store.Find(kDefaultTenant, "skins/tube", 1).ok());
  EXPECT_TRUE(store.Find(kDefaultTenant, "skins/tube", 2).ok());
  // With one more of another, only the newest is left: it is not given up.
  SkinStore full = StoreOf({100, 2 * one, 3});
  ASSERT_TRUE(full.Create(kDefaultTenant, "tube", "", OnArm(), IsThere).ok());
  ASSERT_TRUE(full.Create(kDefaultTenant, "other", "", OnArm(), IsThere).ok());
  EXPECT_THAT(Edit(full, 1).status(),
              Fails(absl::StatusCode::kResourceExhausted, "no room"));
  EXPECT_TRUE(full.Find(kDefaultTenant, "skins/tube", 1).ok());
}

TEST_F(SkinStoreTest, ListsInPages) {
  for (const char* id : {"cccc", "aaaa", "bbbb"}) ASSERT_TRUE(Create(id).ok());
  EXPECT_THAT(Names("", 2), ElementsAre("skins/aaaa", "skins/bbbb"));
  EXPECT_THAT(Names("skins/bbbb", 2), ElementsAre("skins/cccc"));
}

TEST_F(SkinStoreTest, ASkeletonInUseStays) {
  ASSERT_TRUE(Create("tube").ok());
  int removed = 0;
  const auto remove = [&removed] {
    ++removed;
    return absl::OkStatus();
  };
  EXPECT_THAT(store_.RemoveUnused(kDefaultTenant, "skeletons/arm", remove),
              Fails(absl::StatusCode::kFailedPrecondition, "skins/tube"));
  EXPECT_EQ(removed, 0);
  EXPECT_TRUE(store_.RemoveUnused(kTheirs, "skeletons/arm", remove).ok());
  ASSERT_TRUE(store_.Delete(kDefaultTenant, "skins/tube").ok());
  EXPECT_TRUE(
      store_.RemoveUnused(kDefaultTenant, "skeletons/arm", remove).ok());
  EXPECT_EQ(removed, 2);
}

}  // namespace
}  // namespace gelenk::server

#include "server/store/clip_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/motion/pose_part.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/status_matchers.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::Fails;
using ::gelenk::testing::PandaArm;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr absl::string_view kTheirs = "somebody-else";
constexpr size_t kPlenty = 1 << 20;

class ClipStoreTest : public ::testing::Test {
 protected:
  void SetUp() override {
    StoredSkeleton skeleton;
    skeleton.skeleton = panda_;
    ASSERT_TRUE(
        skeletons_.Create(kDefaultTenant, "panda", "", std::move(skeleton))
            .ok());
  }

  // Its first joint turns to `angle_rad` in a second.
  StoredClip Turn(double angle_rad = 1) const {
    JointTrack track;
    track.joint = PosePartsOf(*panda_)[0].joint;
    track.kind = PosePartKind::kNumbers;
    track.times_s = {0, 1};
    track.values = Eigen::RowVector2d(0, angle_rad);
    return StoredClip{.skeleton_name = "skeletons/panda",
                      .clip = MotionClip::Create(panda_, {track}).value()};
  }
  absl::StatusOr<StoredClip> Create(absl::string_view id,
                                    absl::string_view request_id = "",
                                    absl::string_view tenant = kDefaultTenant) {
    return store_.Create(tenant, id, request_id, Turn());
  }
  absl::StatusOr<StoredClip> Revise(absl::string_view id, int newest,
                                    double angle_rad,
                                    absl::string_view request_id = "") {
    StoredClip clip = Turn(angle_rad);
    clip.name = absl::StrCat("clips/", id);
    return store_.AddRevision(kDefaultTenant, request_id, newest,
                              std::move(clip));
  }
  absl::StatusOr<StoredClip> Find(absl::string_view name) const {
    return store_.Find(kDefaultTenant,
                       ParseRevisionName("name", kClips, name).value());
  }
  static double Angle(const StoredClip& clip) {
    return clip.clip.track(0).values(0, 1);
  }

  const std::shared_ptr<const Skeleton> panda_ = PandaArm();
  uint64_t random_ = 0xabc;
  SkeletonStore skeletons_{{4, kPlenty}, [this] { return random_++; }};
  ClipStore store_{{3, kPlenty, 3}, skeletons_, [this] { return random_++; }};
};

TEST_F(ClipStoreTest, KeepsWhatItWasGiven) {
  const auto created = Create("turn");
  ASSERT_TRUE(created.ok()) << created.status();
  EXPECT_EQ(created->name, "clips/turn");
  EXPECT_EQ(created->revision, 1);
  EXPECT_EQ(Find("clips/turn")->clip.track_count(), 1);
  EXPECT_EQ(Find("clips/turn@1")->revision, 1);
  EXPECT_THAT(Find("clips/other").status(),
              Fails(absl::StatusCode::kNotFound, "clips/other"));
}

TEST_F(ClipStoreTest, EveryRevisionStaysWhatItIs) {
  ASSERT_TRUE(Create("turn").ok());
  ASSERT_TRUE(Revise("turn", 1, 2).ok());
  const auto third = Revise("turn", 2, 3);
  ASSERT_TRUE(third.ok()) << third.status();
  EXPECT_EQ(third->revision, 3);
  for (int i = 1; i <= 3; ++i) {
    EXPECT_EQ(Angle(*Find(absl::StrCat("clips/turn@", i))), i);
  }
  EXPECT_EQ(Find("clips/turn")->revision, 3);
  EXPECT_THAT(Revise("turn", 2, 9).status(),
              Fails(absl::StatusCode::kAborted, "is 3 by now, not 2"));
}

TEST_F(ClipStoreTest, TheOldestRevisionsGo) {
  ASSERT_TRUE(Create("turn").ok());
  for (int i = 1; i < 5; ++i) ASSERT_TRUE(Revise("turn", i, i + 1).ok());
  const auto newest = Find("clips/turn");
  EXPECT_EQ(newest->oldest_revision, 3);
  EXPECT_EQ(newest->newest_revision, 5);
  EXPECT_THAT(Find("clips/turn@2").status(),
              Fails(absl::StatusCode::kNotFound, "revisions 3 to 5 are kept"));
  EXPECT_FALSE(Find("clips/turn@6").ok());
}

TEST_F(ClipStoreTest, ARepeatedRequestAnswersItsFirstResult) {
  ASSERT_TRUE(Create("turn", "first").ok());
  EXPECT_EQ(Create("other", "first")->name, "clips/turn");
  ASSERT_TRUE(Revise("turn", 1, 2, "second").ok());
  ASSERT_TRUE(Revise("turn", 2, 3).ok());
  const auto repeated = Revise("turn", 1, 9, "second");
  ASSERT_TRUE(repeated.ok()) << repeated.status();
  EXPECT_EQ(repeated->revision, 2);
  EXPECT_EQ(Angle(*repeated), 2);
  EXPECT_EQ(store_.FindRequest(kDefaultTenant, "second")->revision, 2);
  EXPECT_FALSE(store_.FindRequest(kTheirs, "second").has_value());
}

TEST_F(ClipStoreTest, NamesAreTakenOnceInATenant) {
  ASSERT_TRUE(Create("turn").ok());
  EXPECT_THAT(Create("turn").status(),
              Fails(absl::StatusCode::kAlreadyExists, "clips/turn exists"));
  EXPECT_THAT(store_.List(kTheirs, "", 9), IsEmpty());
  EXPECT_FALSE(
      store_
          .Find(kTheirs,
                ParseRevisionName("name", kClips, "clips/turn").value())
          .ok());
}

TEST_F(ClipStoreTest, HoldsNoMoreThanItsBounds) {
  for (const char* id : {"turn-a", "turn-b", "turn-c"}) {
    ASSERT_TRUE(Create(id).ok());
  }
  EXPECT_THAT(Create("turn-d").status(),
              Fails(absl::StatusCode::kResourceExhausted, "3 clips are held"));
  ASSERT_TRUE(store_.Delete(kDefaultTenant, "clips/turn-b").ok());
  EXPECT_TRUE(Create("turn-d").ok());
}

TEST_F(ClipStoreTest, BytesAreThoseOfAllRevisions) {
  const size_t each = Turn().ByteSize();
  ClipStore small({9, 2 * each + each / 2, 2}, skeletons_,
                  [this] { return random_++; });
  ASSERT_TRUE(small.Create(kDefaultTenant, "turn", "", Turn()).ok());
  StoredClip next = Turn();
  next.name = "clips/turn";
  ASSERT_TRUE(small.AddRevision(kDefaultTenant, "", 1, next).ok());
  EXPECT_THAT(small.Create(kDefaultTenant, "more", "", Turn()).status(),
              Fails(absl::StatusCode::kResourceExhausted, "are left"));
  // The oldest goes for the next one, which so has room.
  EXPECT_TRUE(small.AddRevision(kDefaultTenant, "", 2, next).ok());
  ASSERT_TRUE(small.Delete(kDefaultTenant, "clips/turn").ok());
  EXPECT_TRUE(small.Create(kDefaultTenant, "more", "", Turn()).ok());
}

TEST_F(ClipStoreTest, ListsTheNewestInOrderOfName) {
  for (const char* id : {"turn-b", "turn-a"}) ASSERT_TRUE(Create(id).ok());
  ASSERT_TRUE(Revise("turn-a", 1, 2).ok());
  std::vector<std::string> names;
  for (const StoredClip& clip : store_.List(kDefaultTenant, "", 9)) {
    names.push_back(RevisionText(clip.name, clip.revision));
  }
  EXPECT_THAT(names, ElementsAre("clips/turn-a@2", "clips/turn-b@1"));
  EXPECT_EQ(store_.List(kDefaultTenant, "clips/turn-a", 9).size(), 1u);
}

TEST_F(ClipStoreTest, ASkeletonStaysBelowItsClips) {
  ASSERT_TRUE(Create("turn").ok());
  bool ran = false;
  const auto remove = [&ran] {
    ran = true;
    return absl::OkStatus();
  };
  EXPECT_THAT(store_.RemoveUnused(kDefaultTenant, "skeletons/panda", remove),
              Fails(absl::StatusCode::kFailedPrecondition, "clips/turn"));
  EXPECT_FALSE(ran);
  ASSERT_TRUE(store_.Delete(kDefaultTenant, "clips/turn").ok());
  EXPECT_TRUE(
      store_.RemoveUnused(kDefaultTenant, "skeletons/panda", remove).ok());
  EXPECT_TRUE(ran);
}

TEST_F(ClipStoreTest, NoClipWithoutItsSkeleton) {
  StoredClip clip = Turn();
  clip.skeleton_name = "skeletons/gone";
  EXPECT_THAT(store_.Create(kDefaultTenant, "turn", "", clip).status(),
              Fails(absl::StatusCode::kNotFound, "skeletons/gone"));
  clip.skeleton_name = "skeletons/panda";
  clip.clip = MotionClip::Create(PandaArm(), {}).value();
  EXPECT_THAT(store_.Create(kDefaultTenant, "turn", "", clip).status(),
              Fails(absl::StatusCode::kAborted, "replaced"));
}

TEST(ClipNameTest, ReadsNamesWithAndWithoutRevision) {
  const RevisionedName plain =
      ParseRevisionName("name", kClips, "clips/walk").value();
  EXPECT_EQ(plain.name, "clips/walk");
  EXPECT_FALSE(plain.revision.has_value());
  const RevisionedName third =
      ParseRevisionName("name", kClips, "clips/walk@3").value();
  EXPECT_EQ(third.name, "clips/walk");
  EXPECT_EQ(third.revision, 3);
}

TEST(ClipNameTest, RefusesWhatIsNone) {
  for (const char* name :
       {"", "walk", "clips/", "clips/walk@", "clips/walk@0", "clips/walk@-1",
        "clips/walk@x", "clips/walk@1@2", "clips/walk@01",
        "clips/walk@99999999999999999999", "skeletons/walk", "clips/Walk"}) {
    EXPECT_THAT(ParseRevisionName("clip", kClips, name).status(),
                Fails(absl::StatusCode::kInvalidArgument, "clip: "))
        << name;
  }
}

}  // namespace
}  // namespace gelenk::server

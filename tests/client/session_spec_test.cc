#include "gelenk/client/session_spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gelenk::client {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

SessionSpec FullSpec() {
  SessionSpec spec;
  spec.skeleton.mutable_skeleton();
  spec.session.mutable_session();
  return spec;
}

class SessionSpecTest : public ::testing::Test {
 protected:
  std::mt19937_64 random_{1};
};

TEST_F(SessionSpecTest, ChoosesIdsThatTheContractTakes) {
  std::vector<SessionSpec> specs = {FullSpec()};
  ASSERT_TRUE(Complete(&specs, random_).ok());
  EXPECT_THAT(specs[0].skeleton.skeleton_id(),
              MatchesRegex("[a-z][a-z0-9-]{3,62}"));
  EXPECT_THAT(specs[0].session.session_id(),
              MatchesRegex("[a-z][a-z0-9-]{3,62}"));
  EXPECT_FALSE(specs[0].session.request_id().empty());
  EXPECT_EQ(specs[0].session.session().skeleton(),
            "skeletons/" + specs[0].skeleton.skeleton_id());
}

TEST_F(SessionSpecTest, KeepsWhatTheCallerChose) {
  std::vector<SessionSpec> specs = {FullSpec()};
  specs[0].skeleton.set_skeleton_id("panda");
  specs[0].skeleton.set_request_id("first");
  specs[0].session.set_session_id("left-arm");
  specs[0].session.set_request_id("second");
  specs[0].session.mutable_session()->set_skeleton("skeletons/other");
  ASSERT_TRUE(Complete(&specs, random_).ok());
  EXPECT_EQ(specs[0].skeleton.skeleton_id(), "panda");
  EXPECT_EQ(specs[0].skeleton.request_id(), "first");
  EXPECT_EQ(specs[0].session.request_id(), "second");
  EXPECT_EQ(specs[0].session.session().skeleton(), "skeletons/other");
  EXPECT_EQ(SessionName(specs[0]), "sessions/left-arm");
}

TEST_F(SessionSpecTest, AffinityIsTheSessionIdUnlessGiven) {
  SessionSpec spec = FullSpec();
  spec.session.set_session_id("left-arm");
  EXPECT_EQ(AffinityKey(spec), "left-arm");
  spec.session.mutable_session()->set_affinity_key("robot-7");
  EXPECT_EQ(AffinityKey(spec), "robot-7");
}

TEST_F(SessionSpecTest, ASourceSkeletonIsNamedToo) {
  std::vector<SessionSpec> specs = {FullSpec()};
  specs[0].source_skeleton.mutable_skeleton();
  specs[0].session.mutable_session()->mutable_retargeting();
  ASSERT_TRUE(Complete(&specs, random_).ok());
  const std::string& source = specs[0].source_skeleton.skeleton_id();
  EXPECT_NE(source, specs[0].skeleton.skeleton_id());
  EXPECT_FALSE(specs[0].source_skeleton.request_id().empty());
  EXPECT_EQ(specs[0].session.session().retargeting().source_skeleton(),
            "skeletons/" + source);
}

TEST_F(SessionSpecTest, SessionsOfOneSkeletonRepeatOneRequest) {
  std::vector<SessionSpec> specs(2, FullSpec());
  for (SessionSpec& spec : specs) {
    spec.skeleton.set_skeleton_id("panda");
    spec.session.mutable_session()->set_affinity_key("stage");
  }
  ASSERT_TRUE(Complete(&specs, random_).ok());
  EXPECT_EQ(specs[0].skeleton.request_id(), specs[1].skeleton.request_id());
  EXPECT_NE(specs[0].session.request_id(), specs[1].session.request_id());
}

TEST_F(SessionSpecTest, RefusesWhatDoesNotFitTogether) {
  std::vector<SessionSpec> none;
  EXPECT_THAT(Complete(&none, random_).ToString(), HasSubstr("a session"));

  std::vector<SessionSpec> nameless(1);
  EXPECT_THAT(Complete(&nameless, random_).ToString(),
              HasSubstr("specs[0].session: neither"));

  std::vector<SessionSpec> twins(2, FullSpec());
  for (SessionSpec& spec : twins) spec.session.set_session_id("left-arm");
  EXPECT_THAT(Complete(&twins, random_).ToString(),
              HasSubstr("\"left-arm\" is there twice"));

  std::vector<SessionSpec> strangers(2, FullSpec());
  EXPECT_THAT(Complete(&strangers, random_).ToString(),
              HasSubstr("specs[1].session.session.affinity_key"));
}

}  // namespace
}  // namespace gelenk::client

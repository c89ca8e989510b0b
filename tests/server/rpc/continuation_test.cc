#include "server/rpc/continuation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "gelenk/internal/v1/continuation.pb.h"
#include "server/version.h"
#include "tests/testing/example_sessions.h"
#include "tests/testing/violation_lines.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::ArmSession;
using ::gelenk::testing::kAim;
using ::gelenk::testing::ReachFrame;
using ::gelenk::testing::StateOf;
using ::gelenk::testing::ViolationLines;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr InstructionSet kHere = InstructionSet::kBaseline;
constexpr InstructionSet kElsewhere = InstructionSet::kAvx2;
const absl::Time kNow = absl::FromUnixSeconds(1000);

// A session that is not as it was declared.
std::shared_ptr<Session> DriftedSession() {
  const auto session = ArmSession(kNow);
  InputFrame frame = ReachFrame(1, 1.0 / 3, 2.0 / 7);
  frame.updates.push_back({kAim, {}, 0.1});
  frame.world_from_skeleton = RigidTransform{
      Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY())),
      {1.0 / 9, -1, 5}};
  EXPECT_TRUE(session->Apply(kUnaryDriver, frame, kNow).ok());
  return session;
}

internal::v1::SessionContinuation Opened(const std::string& bytes) {
  internal::v1::SessionContinuation proto;
  EXPECT_TRUE(proto.ParseFromString(bytes));
  return proto;
}

TEST(ContinuationTest, ComesRoundExactly) {
  const auto drifted = DriftedSession();
  const auto read = ReadContinuation(WriteContinuation(*drifted, kHere), kHere);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->inexact_because, "");

  const auto other = ArmSession(kNow);
  ASSERT_TRUE(other->Claim(1, false, kNow).ok());
  Eigen::VectorXd positions;
  drifted->CopyPositions(positions);
  ASSERT_TRUE(other
                  ->Resume(1, {positions, drifted->sequence_number(),
                               &read->goals, &read->world_from_skeleton})
                  .ok());
  // The etag counts changes, which are not the same.
  const auto without_etag = [](std::string state) {
    const size_t begin = state.find("etag");
    return state.erase(begin, state.find('\n', begin) - begin);
  };
  EXPECT_EQ(without_etag(StateOf(*other)), without_etag(StateOf(*drifted)));
}

TEST(ContinuationTest, IsSmall) {
  EXPECT_LT(WriteContinuation(*DriftedSession(), kHere).size(), 500);
}

TEST(ContinuationTest, OfAnotherInstructionSetIsNotExact) {
  const auto read =
      ReadContinuation(WriteContinuation(*DriftedSession(), kElsewhere), kHere);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->inexact_because,
            "not exact: instruction set avx2 before, baseline here");
  EXPECT_EQ(read->goals.size(), 3) << "goals are taken all the same";
}

TEST(ContinuationTest, OfAnotherBuildIsNotExact) {
  auto proto = Opened(WriteContinuation(*DriftedSession(), kHere));
  EXPECT_EQ(proto.build(), BuildId());
  proto.set_build("older");
  const auto read = ReadContinuation(proto.SerializeAsString(), kHere);
  ASSERT_TRUE(read.ok());
  EXPECT_THAT(
      read->inexact_because,
      AllOf(StartsWith("not exact: build older before"), HasSubstr(BuildId())));
}

TEST(ContinuationTest, OfAnotherFormatIsRefused) {
  auto proto = Opened(WriteContinuation(*DriftedSession(), kHere));
  proto.set_format(proto.format() + 1);
  EXPECT_THAT(ViolationLines(
                  ReadContinuation(proto.SerializeAsString(), kHere).status()),
              ElementsAre("resume_from.continuation: want format 1, got 2"));
}

TEST(ContinuationTest, GarbageIsRefused) {
  const std::string good = WriteContinuation(*DriftedSession(), kHere);
  for (const std::string& bytes :
       {std::string("garbage"), std::string(100, '\xff'),
        good.substr(0, good.size() - 1), good + '\x0a'}) {
    EXPECT_THAT(ViolationLines(ReadContinuation(bytes, kHere).status()),
                ElementsAre(StartsWith("resume_from.continuation: ")));
  }
}

TEST(ContinuationTest, EveryTruncationIsRefusedOrRead) {
  const std::string good = WriteContinuation(*DriftedSession(), kHere);
  for (size_t size = 0; size < good.size(); ++size) {
    const auto read = ReadContinuation(good.substr(0, size), kHere);
    if (!read.ok()) {
      EXPECT_EQ(read.status().code(), absl::StatusCode::kInvalidArgument);
    }
  }
}

TEST(ContinuationTest, AGoalThatWishesNothingIsRefused) {
  auto proto = Opened(WriteContinuation(*DriftedSession(), kHere));
  proto.mutable_goals(1)->clear_kind();
  EXPECT_THAT(
      ViolationLines(
          ReadContinuation(proto.SerializeAsString(), kHere).status()),
      ElementsAre(HasSubstr("goals[1].kind: goal \"aim\" wishes nothing")));
}

}  // namespace
}  // namespace gelenk::server

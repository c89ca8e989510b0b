// The unary calls of sessions over the wire: create, get, list, update, delete,
// solve.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/internal/v1/error_details.pb.h"
#include "tests/integration/service_test.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using ::testing::AllOf;
using testing::ArmSessionRequest;
using testing::AttachRequest;
using ::testing::ElementsAre;
using testing::Fails;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kPatience;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;
using testing::WholeFrame;

using Stub = v1::SessionService::Stub;

// "field: description" of the google.rpc.BadRequest in the details.
std::vector<std::string> Violations(const grpc::Status& status) {
  internal::v1::RpcStatus details;
  EXPECT_TRUE(details.ParseFromString(status.error_details()));
  EXPECT_EQ(details.code(), status.error_code());
  std::vector<std::string> lines;
  for (const auto& any : details.details()) {
    EXPECT_EQ(any.type_url(), "type.googleapis.com/google.rpc.BadRequest");
    internal::v1::BadRequest bad_request;
    EXPECT_TRUE(bad_request.ParseFromString(any.value()));
    for (const auto& violation : bad_request.field_violations()) {
      lines.push_back(
          absl::StrCat(violation.field(), ": ", violation.description()));
    }
  }
  return lines;
}

int64_t Nanos(const google::protobuf::Timestamp& time) {
  return time.seconds() * 1000000000 + time.nanos();
}

class SessionCallsTest : public ServiceTest {
 protected:
  static absl::StatusOr<v1::Session> Create(
      const v1::CreateSessionRequest& request) {
    return Call(&Stub::CreateSession, request);
  }
  static absl::StatusOr<v1::Session> Get(const std::string& name) {
    v1::GetSessionRequest request;
    request.set_name(name);
    return Call(&Stub::GetSession, request);
  }
  static absl::Status Delete(const std::string& name,
                             bool allow_missing = false) {
    v1::DeleteSessionRequest request;
    request.set_name(name);
    request.set_allow_missing(allow_missing);
    return Call(&Stub::DeleteSession, request).status();
  }
  static absl::StatusOr<v1::SolveSessionResponse> Solve(
      const std::string& name) {
    v1::SolveSessionRequest request;
    request.set_name(name);
    return Call(&Stub::SolveSession, request);
  }

  // The call as gRPC gives it, with its details.
  template <class Request>
  static grpc::Status Raw(grpc::Status (Stub::*method)(grpc::ClientContext*,
                                                       const Request&,
                                                       v1::Session*),
                          const Request& request) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() +
                         absl::ToChronoMicroseconds(kPatience));
    v1::Session response;
    return (connection().sessions().*method)(&context, request, &response);
  }
};

// --- Create ---

TEST_F(SessionCallsTest, CreateAnswersEverything) {
  const auto session = Create(ArmSessionRequest("robot"));
  ASSERT_TRUE(session.ok()) << session.status();
  EXPECT_EQ(session->name(), "sessions/robot");
  EXPECT_EQ(session->skeleton(), "skeletons/planar-arm");
  EXPECT_EQ(session->affinity_key(), "robot");
  EXPECT_THAT(session->goals(), SizeIs(2));
  EXPECT_THAT(session->pose().positions(), ElementsAre(0.1, 0.2, 0.3));
  EXPECT_EQ(session->idle_ttl().seconds(), 600);
  EXPECT_EQ(session->state(), v1::Session::STATE_ACTIVE);
  EXPECT_THAT(session->etag(), Not(IsEmpty()));
  EXPECT_EQ(Nanos(session->expire_time()) - Nanos(session->create_time()),
            600'000'000'000);
  EXPECT_EQ(Get("sessions/robot")->DebugString(), session->DebugString());
}

TEST_F(SessionCallsTest, IdsThatNobodyChoseAreAllDifferent) {
  std::set<std::string> names;
  for (int i = 0; i < 50; ++i) names.insert(CreateSession());
  EXPECT_THAT(names, SizeIs(50));
  EXPECT_THAT(*names.begin(), MatchesRegex("sessions/[a-z][a-z0-9-]+"));
}

TEST_F(SessionCallsTest, IdsHaveAForm) {
  const std::string longest = "a" + std::string(62, '9');
  for (const std::string& id : {std::string("a-b9"), longest}) {
    EXPECT_TRUE(Create(ArmSessionRequest(id)).ok()) << id;
  }
  for (const std::string& id :
       {std::string("abc"), longest + "9", std::string("Robot"),
        std::string("9robot"), std::string("-robot"), std::string("rob_ot"),
        std::string("rob/ot"), std::string("robot\xC3\xA4")}) {
    const auto session = Create(ArmSessionRequest(id));
    EXPECT_THAT(session.status(),
                Fails(absl::StatusCode::kInvalidArgument, "session_id: "))
        << id;
  }
}

TEST_F(SessionCallsTest, AnIdIsTakenOnce) {
  v1::CreateSessionRequest request = ArmSessionRequest("taken");
  request.set_request_id("first");
  ASSERT_TRUE(Create(request).ok());
  request.set_request_id("second");
  const auto again = Create(request);
  EXPECT_THAT(again.status(),
              Fails(absl::StatusCode::kAlreadyExists, "sessions/taken"));
  request.clear_request_id();
  EXPECT_THAT(Create(request).status(),
              Fails(absl::StatusCode::kAlreadyExists, ""));
}

TEST_F(SessionCallsTest, ARepeatedRequestAnswersTheFirstResult) {
  for (const char* id : {"", "repeated"}) {
    v1::CreateSessionRequest request = ArmSessionRequest(id);
    request.set_request_id(absl::StrCat("request of ", id));
    const auto first = Create(request);
    ASSERT_TRUE(first.ok()) << first.status();
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(Create(request)->DebugString(), first->DebugString());
    }
    // What the first one made is gone: so is its result.
    ASSERT_EQ(Delete(first->name()), absl::OkStatus());
    const auto second = Create(request);
    ASSERT_TRUE(second.ok()) << second.status();
    EXPECT_GT(Nanos(second->create_time()), Nanos(first->create_time()));
  }
}

TEST_F(SessionCallsTest, RequestIdsAreOf64BytesAtMost) {
  v1::CreateSessionRequest request = ArmSessionRequest();
  request.set_request_id(std::string(64, 'r'));
  EXPECT_TRUE(Create(request).ok());
  request.set_request_id(std::string(65, 'r'));
  EXPECT_THAT(Create(request).status(),
              Fails(absl::StatusCode::kInvalidArgument, "request_id: "));
}

TEST_F(SessionCallsTest, EveryViolationIsListedAtOnce) {
  v1::CreateSessionRequest request = ArmSessionRequest("Bad Id");
  request.set_request_id(std::string(65, 'r'));
  v1::Session* session = request.mutable_session();
  session->set_affinity_key("with space");
  session->mutable_goals(0)->mutable_position()->set_end_effector_id("nose");
  session->mutable_goals(1)->set_goal_id("reach");
  session->mutable_solver_options()->set_max_iterations(-1);
  session->mutable_pose()->add_positions(4);
  session->mutable_world_from_skeleton()->mutable_rotation()->set_w(3);
  session->mutable_idle_ttl()->set_seconds(-1);
  const grpc::Status status = Raw(&Stub::CreateSession, request);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  const std::vector<std::string> lines = Violations(status);
  EXPECT_THAT(
      lines,
      UnorderedElementsAre(
          StartsWith("session_id: "), StartsWith("request_id: "),
          StartsWith("session.affinity_key: "),
          AllOf(StartsWith("session.goals[0].position.end_effector_id: "),
                HasSubstr("\"nose\"")),
          AllOf(StartsWith("session.goals[1].goal_id: "),
                HasSubstr("\"reach\"")),
          AllOf(StartsWith("session.solver_options.max_iterations: "),
                HasSubstr("-1")),
          AllOf(StartsWith("session.pose.positions: "), HasSubstr("4")),
          StartsWith("session.world_from_skeleton.rotation: "),
          AllOf(StartsWith("session.idle_ttl: "), HasSubstr("-1s"))));
  for (const std::string& line : lines) {
    EXPECT_THAT(status.error_message(), HasSubstr(line));
  }
  EXPECT_THAT(Get("sessions/Bad Id").status(),
              Fails(absl::StatusCode::kInvalidArgument, ""));
}

TEST_F(SessionCallsTest, TheSkeletonMustBeThere) {
  v1::CreateSessionRequest request = ArmSessionRequest();
  request.mutable_session()->set_skeleton("skeletons/none");
  EXPECT_THAT(Create(request).status(),
              Fails(absl::StatusCode::kNotFound, "skeletons/none"));
  for (const char* name :
       {"", "planar-arm", "sessions/planar-arm", "skeletons/"}) {
    request.mutable_session()->set_skeleton(name);
    EXPECT_THAT(
        Create(request).status(),
        Fails(absl::StatusCode::kInvalidArgument, "session.skeleton: "));
  }
}

TEST_F(SessionCallsTest, AffinityKeysTravelAsAHeader) {
  v1::CreateSessionRequest request = ArmSessionRequest();
  request.mutable_session()->set_affinity_key(std::string(128, '~'));
  EXPECT_EQ(Create(request)->affinity_key(), std::string(128, '~'));
  for (const std::string& key :
       {std::string(129, 'k'), std::string("two words"), std::string("k\n"),
        std::string("\xC3\xA4")}) {
    request.mutable_session()->set_affinity_key(key);
    EXPECT_THAT(
        Create(request).status(),
        Fails(absl::StatusCode::kInvalidArgument, "session.affinity_key: "));
  }
}

// --- Get, delete ---

TEST_F(SessionCallsTest, WhatIsNotThereIsNotFound) {
  EXPECT_THAT(Get("sessions/nobody").status(),
              Fails(absl::StatusCode::kNotFound, "sessions/nobody"));
  EXPECT_THAT(Solve("sessions/nobody").status(),
              Fails(absl::StatusCode::kNotFound, ""));
  EXPECT_THAT(Delete("sessions/nobody"),
              Fails(absl::StatusCode::kNotFound, ""));
  EXPECT_EQ(Delete("sessions/nobody", /*allow_missing=*/true),
            absl::OkStatus());
  for (const char* name : {"", "nobody", "skeletons/nobody", "sessions/"}) {
    EXPECT_THAT(Get(name).status(),
                Fails(absl::StatusCode::kInvalidArgument, "name: "));
    EXPECT_THAT(Delete(name, true),
                Fails(absl::StatusCode::kInvalidArgument, ""));
  }
}

TEST_F(SessionCallsTest, WhatIsDeletedIsGone) {
  const std::string name = CreateSession(ArmSessionRequest("short-life"));
  EXPECT_EQ(Delete(name), absl::OkStatus());
  EXPECT_THAT(Get(name).status(), Fails(absl::StatusCode::kNotFound, ""));
  EXPECT_THAT(Delete(name), Fails(absl::StatusCode::kNotFound, ""));
  EXPECT_EQ(CreateSession(ArmSessionRequest("short-life")), name);
}

// --- Update ---

v1::UpdateSessionRequest UpdateOf(const std::string& name) {
  v1::UpdateSessionRequest request;
  v1::Session* session = request.mutable_session();
  session->set_name(name);
  v1::Goal* goal = session->add_goals();
  goal->set_goal_id("only");
  goal->mutable_position()->set_end_effector_id("tip");
  session->mutable_solver_options()->set_max_iterations(7);
  for (double angle_rad : {0.7, 0.8, 0.9}) {
    session->mutable_pose()->add_positions(angle_rad);
  }
  session->mutable_world_from_skeleton()->mutable_translation()->set_z(4);
  session->mutable_idle_ttl()->set_seconds(60);
  return request;
}

// Which parts of `session` are those of UpdateOf.
std::set<std::string> Updated(const v1::Session& session) {
  std::set<std::string> parts;
  if (session.goals_size() == 1) parts.insert("goals");
  if (session.solver_options().max_iterations() == 7) {
    parts.insert("solver_options");
  }
  if (session.pose().positions(0) == 0.7) parts.insert("pose");
  if (session.world_from_skeleton().translation().z() == 4) {
    parts.insert("world_from_skeleton");
  }
  if (session.idle_ttl().seconds() == 60) parts.insert("idle_ttl");
  return parts;
}

const char* const kParts[] = {"goals", "solver_options", "pose",
                              "world_from_skeleton", "idle_ttl"};

TEST_F(SessionCallsTest, UpdateReplacesWhatTheMaskNames) {
  for (const char* part : kParts) {
    const std::string name = CreateSession();
    v1::UpdateSessionRequest request = UpdateOf(name);
    request.mutable_update_mask()->add_paths(part);
    const auto session = Call(&Stub::UpdateSession, request);
    ASSERT_TRUE(session.ok()) << session.status();
    EXPECT_THAT(Updated(*session), ElementsAre(part));
    EXPECT_THAT(Updated(*Get(name)), ElementsAre(part));
  }
}

TEST_F(SessionCallsTest, UpdateWithoutMaskReplacesWhatIsPopulated) {
  v1::UpdateSessionRequest request = UpdateOf(CreateSession());
  request.mutable_session()->clear_pose();
  request.mutable_session()->clear_goals();
  EXPECT_THAT(Updated(*Call(&Stub::UpdateSession, request)),
              UnorderedElementsAre("solver_options", "world_from_skeleton",
                                   "idle_ttl"));
}

TEST_F(SessionCallsTest, UpdateOfAStarReplacesEverything) {
  v1::UpdateSessionRequest request = UpdateOf(CreateSession());
  request.mutable_update_mask()->add_paths("*");
  EXPECT_THAT(Updated(*Call(&Stub::UpdateSession, request)), SizeIs(5));
  // Also by nothing: defaults.
  const std::string name = request.session().name();
  request.mutable_session()->Clear();
  request.mutable_session()->set_name(name);
  const auto session = Call(&Stub::UpdateSession, request);
  ASSERT_TRUE(session.ok()) << session.status();
  EXPECT_THAT(session->goals(), IsEmpty());
  EXPECT_THAT(session->pose().positions(), ElementsAre(0, 0, 0));
  EXPECT_EQ(session->idle_ttl().seconds(), 600);
}

TEST_F(SessionCallsTest, ABadUpdateListsEveryViolationAndChangesNothing) {
  const std::string name = CreateSession();
  const v1::Session before = *Get(name);
  v1::UpdateSessionRequest request = UpdateOf(name);
  v1::Session* session = request.mutable_session();
  session->mutable_goals(0)->mutable_position()->set_end_effector_id("nose");
  session->mutable_pose()->add_positions(4);
  session->mutable_idle_ttl()->set_seconds(0);
  request.mutable_update_mask()->add_paths("*");
  request.mutable_update_mask()->add_paths("skeleton");
  const grpc::Status status = Raw(&Stub::UpdateSession, request);
  EXPECT_THAT(Violations(status),
              UnorderedElementsAre(
                  StartsWith("session.goals[0].position.end_effector_id: "),
                  StartsWith("session.pose.positions: "),
                  StartsWith("session.idle_ttl: ")));
  request.mutable_update_mask()->clear_paths();
  for (const char* path : {"goals", "skeleton", "pose.positions"}) {
    request.mutable_update_mask()->add_paths(path);
  }
  EXPECT_THAT(
      Violations(Raw(&Stub::UpdateSession, request)),
      UnorderedElementsAre(
          AllOf(StartsWith("update_mask: "), HasSubstr("\"skeleton\"")),
          AllOf(StartsWith("update_mask: "), HasSubstr("\"pose.positions\"")),
          StartsWith("session.goals[0].position.end_effector_id: ")));
  EXPECT_EQ(Get(name)->DebugString(), before.DebugString());
}

TEST_F(SessionCallsTest, AnOldEtagIsAborted) {
  const std::string name = CreateSession();
  const v1::Session seen = *Get(name);
  v1::UpdateSessionRequest request = UpdateOf(name);
  request.mutable_session()->set_etag(seen.etag());
  const auto first = Call(&Stub::UpdateSession, request);
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_NE(first->etag(), seen.etag());
  EXPECT_THAT(Call(&Stub::UpdateSession, request).status(),
              Fails(absl::StatusCode::kAborted, ""));
  request.mutable_session()->set_etag(first->etag());
  EXPECT_TRUE(Call(&Stub::UpdateSession, request).ok());
  request.mutable_session()->set_etag("W/\"x\"");
  EXPECT_THAT(Call(&Stub::UpdateSession, request).status(),
              Fails(absl::StatusCode::kInvalidArgument, ""));
}

TEST_F(SessionCallsTest, TheEtagIsOfEverythingButThePose) {
  const std::string name = CreateSession();
  const std::string etag = Get(name)->etag();
  ASSERT_TRUE(Solve(name).ok());
  EXPECT_EQ(Get(name)->etag(), etag);
}

// --- Solve ---

TEST_F(SessionCallsTest, SolveGoesOnFromTheLastPose) {
  const std::string name = CreateSession();
  v1::SolveSessionRequest request;
  request.set_name(name);
  request.set_include_joint_frames(true);
  v1::Goal* goal = request.mutable_goal_patch()->add_goals();
  goal->set_goal_id("reach");
  goal->mutable_position()->set_end_effector_id("tip");
  goal->mutable_position()->mutable_world_position()->set_x(0.6);
  goal->mutable_position()->mutable_world_position()->set_y(0.6);
  const auto solved = Call(&Stub::SolveSession, request);
  ASSERT_TRUE(solved.ok()) << solved.status();
  EXPECT_THAT(solved->joint_frames().world_translations(), SizeIs(9));
  EXPECT_THAT(solved->report().position_errors_m(), SizeIs(2));
  const v1::Session session = *Get(name);
  EXPECT_EQ(session.pose().DebugString(), solved->pose().DebugString());
  EXPECT_EQ(session.goals(0).position().world_position().y(), 0.6);
  EXPECT_EQ(session.goals(0).weight(), 1) << "kept";
}

TEST_F(SessionCallsTest, ADrivenSessionIsTheStreams) {
  const std::string name = CreateSession();
  auto stream = OpenStream({AttachRequest(name)});
  EXPECT_THAT(Solve(name).status(),
              Fails(absl::StatusCode::kFailedPrecondition, ""));
  EXPECT_THAT(Call(&Stub::UpdateSession, UpdateOf(name)).status(),
              Fails(absl::StatusCode::kFailedPrecondition, ""));
  EXPECT_TRUE(Get(name).ok());
  stream->HalfClose();
  ASSERT_EQ(stream->Finish(), absl::OkStatus());
  EXPECT_TRUE(Solve(name).ok());
}

// --- Skeletons of sessions ---

TEST_F(SessionCallsTest, ASkeletonInUseStays) {
  v1::CreateSkeletonRequest leg = testing::ArmSkeletonRequest();
  leg.set_skeleton_id("leg-1");
  ASSERT_TRUE(Call(&v1::KinematicsService::Stub::CreateSkeleton, leg).ok());
  v1::CreateSessionRequest request = ArmSessionRequest();
  request.mutable_session()->set_skeleton("skeletons/leg-1");
  const std::string name = CreateSession(request);
  v1::DeleteSkeletonRequest remove;
  remove.set_name("skeletons/leg-1");
  const auto delete_skeleton = [&] {
    return Call(&v1::KinematicsService::Stub::DeleteSkeleton, remove).status();
  };
  EXPECT_THAT(delete_skeleton(),
              Fails(absl::StatusCode::kFailedPrecondition, "skeletons/leg-1"));
  ASSERT_EQ(Delete(name), absl::OkStatus());
  EXPECT_EQ(delete_skeleton(), absl::OkStatus());
  EXPECT_THAT(delete_skeleton(), Fails(absl::StatusCode::kNotFound, ""));
  EXPECT_THAT(Create(request).status(), Fails(absl::StatusCode::kNotFound, ""));
}

// --- List ---

class ListSessionsTest : public SessionCallsTest {
 protected:
  static void SetUpTestSuite() {
    StartServer({});
    for (int i = 9; i >= 1; --i) {
      CreateSession(ArmSessionRequest(absl::StrCat("actor-", i)));
    }
  }

  // The sizes of all pages; the names go to `names`.
  static std::vector<int> PageSizes(int page_size,
                                    std::vector<std::string>& names) {
    std::vector<int> sizes;
    v1::ListSessionsRequest request;
    request.set_page_size(page_size);
    do {
      const auto page = Call(&Stub::ListSessions, request);
      if (!page.ok()) {
        ADD_FAILURE() << page.status();
        break;
      }
      sizes.push_back(page->sessions_size());
      for (const v1::Session& session : page->sessions()) {
        names.push_back(session.name());
      }
      request.set_page_token(page->next_page_token());
    } while (!request.page_token().empty() && sizes.size() < 20);
    return sizes;
  }
};

TEST_F(ListSessionsTest, PagesHoldEverySessionOnce) {
  const std::vector<std::pair<int, std::vector<int>>> cases = {
      {0, {9}},
      {1, {1, 1, 1, 1, 1, 1, 1, 1, 1}},
      {2, {2, 2, 2, 2, 1}},
      {3, {3, 3, 3}},
      {8, {8, 1}},
      {9, {9}},
      {10, {9}},
      {1 << 30, {9}}};
  for (const auto& [page_size, sizes] : cases) {
    std::vector<std::string> names;
    EXPECT_EQ(PageSizes(page_size, names), sizes) << page_size;
    EXPECT_THAT(names, ElementsAre("sessions/actor-1", "sessions/actor-2",
                                   "sessions/actor-3", "sessions/actor-4",
                                   "sessions/actor-5", "sessions/actor-6",
                                   "sessions/actor-7", "sessions/actor-8",
                                   "sessions/actor-9"));
  }
}

TEST_F(ListSessionsTest, APageAfterADeletionGoesOn) {
  CreateSession(ArmSessionRequest("actor-3a"));
  v1::ListSessionsRequest request;
  request.set_page_size(4);
  auto page = Call(&Stub::ListSessions, request);
  ASSERT_TRUE(page.ok());
  EXPECT_EQ(page->next_page_token().empty(), false);
  // The one that the token stands on.
  ASSERT_EQ(Delete("sessions/actor-3a"), absl::OkStatus());
  request.set_page_token(page->next_page_token());
  page = Call(&Stub::ListSessions, request);
  ASSERT_TRUE(page.ok());
  EXPECT_EQ(page->sessions(0).name(), "sessions/actor-4");
}

TEST_F(ListSessionsTest, SizesAreNotNegative) {
  v1::ListSessionsRequest request;
  request.set_page_size(-1);
  const absl::Status status = Call(&Stub::ListSessions, request).status();
  EXPECT_THAT(status, Fails(absl::StatusCode::kInvalidArgument,
                            "page_size: want 0 or more, got -1"));
}

// --- Limits ---

class FullServerTest : public SessionCallsTest {
 protected:
  static void SetUpTestSuite() {
    StartServer({"--max-sessions", "3", "--max-slots", "2"});
  }
};

TEST_F(FullServerTest, RefusesMoreAndTakesAgainAfterADeletion) {
  v1::CreateSessionRequest request = ArmSessionRequest("one-1");
  request.set_request_id("one");
  ASSERT_TRUE(Create(request).ok());
  ASSERT_TRUE(Create(ArmSessionRequest("two-2")).ok());
  ASSERT_TRUE(Create(ArmSessionRequest("three-3")).ok());
  const auto fourth = Create(ArmSessionRequest("four-4"));
  EXPECT_THAT(fourth.status(),
              Fails(absl::StatusCode::kResourceExhausted, "3 sessions"));
  EXPECT_TRUE(Create(request).ok()) << "a repeat makes nothing";
  EXPECT_THAT(Create(ArmSessionRequest("two-2")).status(),
              Fails(absl::StatusCode::kAlreadyExists, ""));
  ASSERT_EQ(Delete("sessions/two-2"), absl::OkStatus());
  EXPECT_TRUE(Create(ArmSessionRequest("four-4")).ok());
}

}  // namespace
}  // namespace gelenk

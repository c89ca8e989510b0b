#include "server/rpc/session_message.h"

#include <algorithm>
#include <set>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "convert/duration.h"
#include "convert/geometry.h"
#include "convert/goal.h"
#include "convert/pose.h"
#include "convert/solver.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"
#include "server/rpc/input_message.h"

namespace gelenk::server {
namespace {

constexpr char kEtagPrefix[] = "r";

absl::Status SetGoals(const v1::Session& proto, const Skeleton& skeleton,
                      SessionState& state) {
  absl::StatusOr<std::vector<Goal>> goals =
      convert::FromProto(proto.goals(), &skeleton);
  if (goals.ok()) state.goals = std::move(*goals);
  return goals.status();
}

absl::Status SetOptions(const v1::Session& proto, SessionState& state) {
  absl::StatusOr<SolverOptions> options =
      convert::FromProto(proto.solver_options());
  if (options.ok()) {
    state.options = *options;
    return absl::OkStatus();
  }
  Violations violations;
  violations.AddStatus("solver_options", options.status());
  return violations.ToStatus();
}

absl::Status SetPose(const v1::Session& proto, const Skeleton& skeleton,
                     SessionState& state) {
  if (!proto.has_pose()) {
    state.positions = skeleton.rest_positions();
    state.cold = true;
    return absl::OkStatus();
  }
  absl::StatusOr<Eigen::VectorXd> positions =
      convert::FromProto(skeleton, proto.pose());
  if (positions.ok()) {
    state.positions = *std::move(positions);
    state.cold = false;
    return absl::OkStatus();
  }
  Violations violations;
  violations.AddStatus("pose", positions.status());
  return violations.ToStatus();
}

absl::Status SetPlace(const v1::Session& proto, SessionState& state) {
  RigidTransform place = convert::FromProto(proto.world_from_skeleton());
  Violations violations;
  CheckAndNormalize("world_from_skeleton", place, violations);
  if (violations.empty()) state.world_from_skeleton = place;
  return violations.ToStatus();
}

absl::Status SetIdleTtl(const v1::Session& proto, const Limits& limits,
                        SessionState& state) {
  state.idle_ttl = std::min(limits.default_idle_ttl, limits.max_idle_ttl);
  if (!proto.has_idle_ttl()) return absl::OkStatus();
  const absl::Duration ttl = convert::FromProto(proto.idle_ttl());
  if (ttl > absl::ZeroDuration()) {
    state.idle_ttl = std::min(ttl, limits.max_idle_ttl);
    return absl::OkStatus();
  }
  Violations violations;
  violations.Add("idle_ttl", absl::StrCat("want more than 0, got ",
                                          absl::FormatDuration(ttl)));
  return violations.ToStatus();
}

}  // namespace

void ToProto(absl::Time time, google::protobuf::Timestamp* proto) {
  const int64_t nanos = absl::ToUnixNanos(time);
  proto->set_seconds(nanos / 1000000000);
  proto->set_nanos(static_cast<int>(nanos % 1000000000));
}

void ToProto(const Session& session, bool draining, v1::Session* proto) {
  const SessionSnapshot snapshot = session.Snapshot();
  const SessionState& state = snapshot.state;
  proto->set_name(session.name());
  proto->set_skeleton(session.skeleton_name());
  convert::ToProto(state.goals, proto->mutable_goals());
  convert::ToProto(state.options, proto->mutable_solver_options());
  convert::ToProto(state.positions, proto->mutable_pose());
  convert::ToProto(state.world_from_skeleton,
                   proto->mutable_world_from_skeleton());
  InputToProto(session.input(), proto);
  proto->set_affinity_key(session.affinity_key());
  convert::ToProto(state.idle_ttl, proto->mutable_idle_ttl());
  ToProto(snapshot.expire_time, proto->mutable_expire_time());
  ToProto(session.create_time(), proto->mutable_create_time());
  proto->set_state(draining ? v1::Session::STATE_DRAINING
                            : v1::Session::STATE_ACTIVE);
  proto->set_etag(absl::StrCat(kEtagPrefix, snapshot.revision));
}

absl::Status StateFromProto(const v1::Session& proto, const Skeleton& skeleton,
                            const Limits& limits, SessionState& state) {
  Violations violations;
  violations.AddStatus("", SetGoals(proto, skeleton, state));
  violations.AddStatus("", SetOptions(proto, state));
  violations.AddStatus("", SetPose(proto, skeleton, state));
  violations.AddStatus("", SetPlace(proto, state));
  violations.AddStatus("", SetIdleTtl(proto, limits, state));
  return violations.ToStatus();
}

absl::Status UpdateState(const v1::UpdateSessionRequest& request,
                         const Skeleton& skeleton, const Limits& limits,
                         SessionState& state) {
  const v1::Session& proto = request.session();
  const std::set<std::string> known = {"goals", "solver_options", "pose",
                                       "world_from_skeleton", "idle_ttl"};
  Violations violations;
  std::set<std::string> paths(request.update_mask().paths().begin(),
                              request.update_mask().paths().end());
  if (paths.empty()) {
    if (proto.goals_size() > 0) paths.insert("goals");
    if (proto.has_solver_options()) paths.insert("solver_options");
    if (proto.has_pose()) paths.insert("pose");
    if (proto.has_world_from_skeleton()) paths.insert("world_from_skeleton");
    if (proto.has_idle_ttl()) paths.insert("idle_ttl");
  } else if (paths.contains("*")) {
    paths = known;
  }
  for (const std::string& path : paths) {
    if (known.contains(path)) continue;
    violations.Add("update_mask",
                   absl::StrCat("no field \"", path, "\" can be updated"));
  }
  const auto note = [&violations](const absl::Status& status) {
    violations.AddStatus("session", status);
  };
  if (paths.contains("goals")) note(SetGoals(proto, skeleton, state));
  if (paths.contains("solver_options")) note(SetOptions(proto, state));
  if (paths.contains("pose")) note(SetPose(proto, skeleton, state));
  if (paths.contains("world_from_skeleton")) note(SetPlace(proto, state));
  if (paths.contains("idle_ttl")) note(SetIdleTtl(proto, limits, state));
  return violations.ToStatus();
}

absl::StatusOr<std::optional<int64_t>> RevisionOf(const std::string& etag) {
  if (etag.empty()) return std::optional<int64_t>();
  absl::string_view digits = etag;
  int64_t revision = 0;
  if (absl::ConsumePrefix(&digits, kEtagPrefix) &&
      absl::SimpleAtoi(digits, &revision)) {
    return std::optional<int64_t>(revision);
  }
  Violations violations;
  violations.Add("session.etag", "is none of this server's");
  return violations.ToStatus();
}

}  // namespace gelenk::server

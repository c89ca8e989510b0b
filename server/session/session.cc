#include "server/session/session.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/skeleton/pose.h"
#include "server/clock.h"

namespace gelenk::server {
namespace {

absl::Status CheckSequence(std::optional<int64_t> number, int64_t newest) {
  if (!number || *number > newest) return absl::OkStatus();
  Violations violations;
  violations.Add("sequence_number",
                 absl::StrCat("want more than ", newest, ", got ", *number));
  return violations.ToStatus();
}

// Checks every update of `frame` against `problem`, normalising as it goes.
absl::Status CheckUpdates(const IkProblem& problem, InputFrame& frame) {
  Violations violations;
  for (size_t i = 0; i < frame.updates.size(); ++i) {
    GoalUpdate& update = frame.updates[i];
    absl::Status status = absl::OkStatus();
    if (update.target) {
      status = problem.CheckTarget(update.goal_index, *update.target);
    } else {
      GoalTarget none;
      if (update.goal_index < 0 ||
          update.goal_index >= static_cast<int>(problem.goals().size())) {
        status = problem.CheckTarget(update.goal_index, none);
      }
    }
    if (status.ok() && update.weight) {
      status = IkProblem::CheckWeight(*update.weight);
    }
    if (!status.ok()) {
      violations.AddStatus(absl::StrCat("targets[", i, "]"), status);
    }
  }
  if (frame.world_from_skeleton) {
    CheckAndNormalize("world_from_skeleton", *frame.world_from_skeleton,
                      violations);
  }
  return violations.ToStatus();
}

void CheckMotion(const Skeleton& skeleton, const JointMotion& motion,
                 Violations& violations) {
  if (!motion.capture_time) return;
  if (motion.velocity.size() == skeleton.velocity_count() &&
      motion.velocity.allFinite()) {
    return;
  }
  violations.Add("velocity",
                 absl::StrCat("want ", skeleton.velocity_count(),
                              " finite numbers, got ", motion.velocity.size()));
}

}  // namespace

Session::Session(std::string name, std::string skeleton_name,
                 std::string affinity_key, std::shared_ptr<SharedTrees> trees,
                 IkProblem problem, SessionState state, absl::Time now,
                 SessionInput input)
    : name_(std::move(name)),
      skeleton_name_(std::move(skeleton_name)),
      affinity_key_(std::move(affinity_key)),
      trees_(std::move(trees)),
      create_time_(now),
      input_(std::move(input)),
      problem_(std::move(problem)),
      options_(state.options),
      positions_(std::move(state.positions)),
      cold_(state.cold),
      idle_ttl_(state.idle_ttl),
      last_driven_(now) {
  problem_.SetWorldFromSkeleton(state.world_from_skeleton);
}

absl::Status Session::Claim(DriverId driver, bool take_over, absl::Time now) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (!ended_.ok()) return ended_;
  if (driver_ && *driver_ != driver && !take_over) {
    return absl::FailedPreconditionError(absl::StrCat(
        "session: ", name_, " has a driver; attach with take_over to take it"));
  }
  input_.ForgetTime();
  driver_ = driver;
  last_driven_ = now;
  return absl::OkStatus();
}

void Session::Release(DriverId driver) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (driver_ == driver) driver_.reset();
}

absl::Status Session::CheckDriver(DriverId driver) const {
  std::lock_guard<std::mutex> lock(mutex_);
  return CheckDriverLocked(driver);
}

absl::Status Session::CheckDriverLocked(DriverId driver) const {
  if (!ended_.ok()) return ended_;
  if (driver == kUnaryDriver) {
    if (!driver_) return absl::OkStatus();
    return absl::FailedPreconditionError(
        absl::StrCat("name: ", name_, " is driven by a stream"));
  }
  if (driver_ == driver) return absl::OkStatus();
  return absl::AbortedError(
      absl::StrCat("session: ", name_, " was taken over by another driver"));
}

absl::Status Session::Resume(DriverId driver, const ResumeState& state) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (absl::Status status = CheckDriverLocked(driver); !status.ok()) {
    return status;
  }
  RigidTransform place = state.world_from_skeleton != nullptr
                             ? *state.world_from_skeleton
                             : problem_.world_from_skeleton();
  Violations violations;
  CheckAndNormalize("world_from_skeleton", place, violations);
  if (state.motion != nullptr) {
    CheckMotion(skeleton(), *state.motion, violations);
  }
  if (!violations.empty()) return violations.ToStatus();
  std::optional<IkProblem> resumed;
  if (state.goals != nullptr) {
    absl::StatusOr<IkProblem> problem =
        trees_->CreateProblem(*state.goals, options_);
    if (!problem.ok()) return problem.status();
    resumed = *std::move(problem);
  }
  if (!input_.empty()) {
    absl::Status status =
        input_.Resume(resumed ? resumed->goals() : problem_.goals(),
                      state.positions, state.memory);
    if (!status.ok()) {
      input_.SetGoals(problem_.goals());
      return status;
    }
  }
  if (resumed) {
    problem_ = *std::move(resumed);
    // The driver cannot know these from its create request.
    drifted_ = true;
    ++revision_;
  }
  problem_.SetWorldFromSkeleton(place);
  positions_ = state.positions;
  sequence_number_ = state.sequence_number;
  motion_ = state.motion != nullptr ? *state.motion : JointMotion();
  cold_ = false;
  ++version_;
  return absl::OkStatus();
}

absl::Status Session::TakeNumberLocked(DriverId driver,
                                       std::optional<int64_t> sequence_number,
                                       absl::Time now) {
  if (absl::Status status = CheckDriverLocked(driver); !status.ok()) {
    return status;
  }
  if (absl::Status status = CheckSequence(sequence_number, sequence_number_);
      !status.ok()) {
    return status;
  }
  if (sequence_number) sequence_number_ = *sequence_number;
  last_driven_ = now;
  return absl::OkStatus();
}

absl::Status Session::Skip(DriverId driver, int64_t sequence_number,
                           absl::Time now) {
  std::lock_guard<std::mutex> lock(mutex_);
  return TakeNumberLocked(driver, sequence_number, now);
}

absl::Status Session::Apply(DriverId driver, InputFrame& frame,
                            absl::Time now) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (absl::Status status =
          TakeNumberLocked(driver, frame.sequence_number, now);
      !status.ok()) {
    return status;
  }

  std::optional<IkProblem> patched;
  if (frame.patch) {
    absl::StatusOr<std::vector<Goal>> goals = frame.patch(problem_.goals());
    if (!goals.ok()) return goals.status();
    absl::StatusOr<IkProblem> problem =
        trees_->CreateProblem(*std::move(goals), options_);
    if (!problem.ok()) return problem.status();
    patched = *std::move(problem);
    patched->SetWorldFromSkeleton(problem_.world_from_skeleton());
    patched->KeepPlants(problem_);
  }
  if (absl::Status status = CheckUpdates(patched ? *patched : problem_, frame);
      !status.ok()) {
    return status;
  }
  if (!input_.empty() || frame.has_source_pose) {
    if (absl::Status status =
            input_.CheckFrame(patched ? *patched : problem_, frame);
        !status.ok()) {
      return status;
    }
  }

  // Nothing can fail from here on.
  capture_time_ = frame.capture_time;
  if (patched) {
    problem_ = *std::move(patched);
    drifted_ = true;
    ++revision_;
  }
  if (frame.patch) input_.SetGoals(problem_.goals());
  const bool conditions_targets = input_.ConditionsTargets();
  // Counted, not compared one by one: a goal named twice and another one not at
  // all would be a strange client, and gets a continuation too few.
  size_t named = 0;
  for (const GoalUpdate& update : frame.updates) {
    if (update.target) {
      if (!conditions_targets || !TargetRig::Takes(*update.target)) {
        problem_.SetTarget(update.goal_index, *update.target);
      }
      ++named;
    }
    if (update.weight) {
      problem_.SetWeight(update.goal_index, *update.weight);
      drifted_ = true;
    }
  }
  partly_named_ = named < problem_.goals().size();
  if (frame.world_from_skeleton) {
    problem_.SetWorldFromSkeleton(*frame.world_from_skeleton);
    drifted_ = true;
  }
  if (!input_.empty()) input_.Take(frame, now);
  return absl::OkStatus();
}

bool Session::IsHeavy() const {
  // Following a source is always warm.
  if (input_.source != nullptr) return false;
  std::lock_guard<std::mutex> lock(mutex_);
  const SolveStart start = cold_ ? SolveStart::kCold : SolveStart::kWarm;
  return RestartBudget(options_, start) > 0 ||
         options_.detail == ReportDetail::kDiagnosis;
}

absl::Status Session::Solve(DriverId driver, IkSolver& solver, bool whole,
                            SolvedFrame& frame) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (absl::Status status = CheckDriverLocked(driver); !status.ok()) {
    return status;
  }
  if (!input_.empty()) {
    const absl::Status status = input_.Sample(problem_);
    if (input_.conditioning != nullptr) {
      frame.live = input_.conditioning->status();
      frame.latency = input_.conditioning->latency();
    }
    if (!status.ok()) return status;
    if (input_.source != nullptr) {
      FollowSourceLocked(frame);
      return absl::OkStatus();
    }
  }
  SolverOptions options = options_;
  if (!whole) options.detail = ReportDetail::kBrief;
  const absl::Time begin = Now();
  const StepBounds* bounds = SpeedBoundsLocked(frame);
  problem_.CapturePlants(positions_);
  solver.Solve(problem_, options, cold_ ? SolveStart::kCold : SolveStart::kWarm,
               positions_, frame.report, bounds);
  frame.end_time = Now();
  frame.solve_duration = frame.end_time - begin;
  cold_ = false;
  ++version_;
  frame.positions = positions_;
  frame.detail = options.detail;
  frame.needs_continuation =
      drifted_ || partly_named_ || options_.limit_speed || !input_.empty();
  if (options_.limit_speed) NoteMotionLocked(frame);
  RecordLocked(frame);
  return absl::OkStatus();
}

void Session::RecordLocked(const SolvedFrame& frame) {
  if (!recording_) return;
  recording_->Note(capture_time_, frame.end_time, positions_);
}

void Session::FollowSourceLocked(SolvedFrame& frame) {
  const absl::Time begin = Now();
  input_.source->Step(problem_, positions_);
  frame.end_time = Now();
  frame.solve_duration = frame.end_time - begin;
  cold_ = false;
  ++version_;
  frame.positions = positions_;
  frame.needs_continuation = true;
  frame.retarget_report = input_.source->report();
  RecordLocked(frame);
}

const StepBounds* Session::SpeedBoundsLocked(SolvedFrame& frame) const {
  if (!options_.limit_speed) return nullptr;
  frame.start = positions_;
  if (!capture_time_ || !motion_.capture_time || cold_) return nullptr;
  SpeedLimits(skeleton(), *capture_time_ - *motion_.capture_time,
              motion_.velocity, frame.bounds);
  return &frame.bounds;
}

void Session::NoteMotionLocked(SolvedFrame& frame) {
  const std::optional<absl::Duration> before = motion_.capture_time;
  motion_.velocity.setZero(skeleton().velocity_count());
  motion_.capture_time = capture_time_;
  if (!before || !capture_time_ || *capture_time_ <= *before) return;
  Difference(skeleton(), frame.start, positions_, motion_.velocity);
  motion_.velocity /= absl::ToDoubleSeconds(*capture_time_ - *before);
}

void Session::CopyPositions(Eigen::VectorXd& positions) const {
  std::lock_guard<std::mutex> lock(mutex_);
  positions = positions_;
}

int64_t Session::sequence_number() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return sequence_number_;
}

SessionSnapshot Session::Snapshot() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return {StateLocked(), last_driven_ + idle_ttl_, revision_, motion_,
          StateOf(input_)};
}

SessionState Session::StateLocked() const {
  SessionState state;
  state.goals.assign(problem_.goals().begin(), problem_.goals().end());
  state.options = options_;
  state.positions = positions_;
  state.cold = cold_;
  state.world_from_skeleton = problem_.world_from_skeleton();
  state.idle_ttl = idle_ttl_;
  return state;
}

absl::Status Session::Update(
    const std::function<absl::Status(SessionState&)>& change,
    std::optional<int64_t> revision, absl::Time now) {
  // Held all along, so that no solve in between is lost; nobody waits, for
  // nobody drives.
  std::lock_guard<std::mutex> lock(mutex_);
  if (absl::Status status = CheckDriverLocked(kUnaryDriver); !status.ok()) {
    return status;
  }
  if (revision && *revision != revision_) {
    return absl::AbortedError(
        absl::StrCat("etag: ", name_, " was changed meanwhile"));
  }
  SessionState state = StateLocked();
  if (absl::Status status = change(state); !status.ok()) return status;
  absl::StatusOr<IkProblem> problem =
      trees_->CreateProblem(std::move(state.goals), state.options);
  if (!problem.ok()) return problem.status();
  if (absl::Status status = input_.CheckGoals(problem->goals()); !status.ok()) {
    return status;
  }
  input_.SetGoals(problem->goals());
  input_.Reset();
  problem->SetWorldFromSkeleton(state.world_from_skeleton);
  problem->KeepPlants(problem_);

  problem_ = *std::move(problem);
  options_ = state.options;
  positions_ = std::move(state.positions);
  cold_ = state.cold;
  motion_ = JointMotion();
  idle_ttl_ = state.idle_ttl;
  last_driven_ = now;
  drifted_ = true;
  ++revision_;
  ++version_;
  return absl::OkStatus();
}

bool Session::CopyIfNewer(uint64_t& version, Eigen::VectorXd& positions,
                          RigidTransform& world_from_skeleton,
                          int64_t& sequence_number) const {
  std::lock_guard<std::mutex> lock(mutex_);
  if (version_ == version) return false;
  version = version_;
  positions = positions_;
  world_from_skeleton = problem_.world_from_skeleton();
  sequence_number =
      sequence_number_ > 0 ? sequence_number_ : static_cast<int64_t>(version_);
  return true;
}

absl::Status Session::StartRecording(
    std::shared_ptr<SessionRecording> recording) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (!ended_.ok()) return ended_;
  if (recording_) {
    return absl::FailedPreconditionError(
        absl::StrCat("session: ", name_, " is recorded already"));
  }
  recording_ = std::move(recording);
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<SessionRecording>> Session::StopRecording() {
  std::lock_guard<std::mutex> lock(mutex_);
  if (!recording_) {
    return absl::FailedPreconditionError(
        absl::StrCat("session: ", name_, " is not recorded"));
  }
  return std::exchange(recording_, nullptr);
}

void Session::End(absl::Status why) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (ended_.ok()) ended_ = std::move(why);
}

absl::Status Session::ended() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return ended_;
}

bool Session::IsExpired(absl::Time now) const {
  std::lock_guard<std::mutex> lock(mutex_);
  return now >= last_driven_ + idle_ttl_;
}

size_t Session::ByteSize() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return sizeof(*this) + name_.capacity() + skeleton_name_.capacity() +
         affinity_key_.capacity() + problem_.ByteSize() - sizeof(problem_) +
         (positions_.size() + motion_.velocity.size()) * sizeof(double) +
         input_.ByteSize();
}

}  // namespace gelenk::server

#include "server/session/session.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"
#include "server/clock.h"
#include "server/session/frame_check.h"

namespace gelenk::server {

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
  if (absl::Status status = seat_.Claim(driver, take_over, name_);
      !status.ok()) {
    return status;
  }
  input_.ForgetTime();
  last_driven_ = now;
  return absl::OkStatus();
}

void Session::Release(DriverId driver) {
  std::lock_guard<std::mutex> lock(mutex_);
  seat_.Release(driver);
}

absl::Status Session::CheckDriver(DriverId driver) const {
  std::lock_guard<std::mutex> lock(mutex_);
  return seat_.Check(driver, name_);
}

absl::Status Session::Resume(DriverId driver, const ResumeState& state) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (absl::Status status = seat_.Check(driver, name_); !status.ok()) {
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
  seat_.SetNumber(state.sequence_number);
  motion_ = state.motion != nullptr ? *state.motion : JointMotion();
  cold_ = false;
  ++version_;
  return absl::OkStatus();
}

absl::Status Session::TakeNumberLocked(DriverId driver,
                                       std::optional<int64_t> sequence_number,
                                       absl::Time now) {
  if (absl::Status status = seat_.Check(driver, name_); !status.ok()) {
    return status;
  }
  if (absl::Status status = seat_.TakeNumber(sequence_number); !status.ok()) {
    return status;
  }
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
          frame.is_fill ? seat_.Check(driver, name_)
                        : TakeNumberLocked(driver, frame.sequence_number, now);
      !status.ok()) {
    return status;
  }
  input_.SetTimes(now, frame);

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
  if (absl::Status status = CheckFrame(patched ? *patched : problem_, frame);
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
  motion_time_ = frame.motion_time;
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
  if (absl::Status status = seat_.Check(driver, name_); !status.ok()) {
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
  if (options_.limit_speed) {
    NoteMotion(skeleton(), motion_time_, frame.start, positions_, motion_);
  }
  RecordLocked(frame);
  return absl::OkStatus();
}

void Session::RecordLocked(const SolvedFrame& frame) {
  if (!recording_) return;
  recording_->Note(motion_time_, frame.end_time, positions_);
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
  if (cold_) return nullptr;
  const bool bounded =
      BoundSpeed(skeleton(), motion_, motion_time_, frame.bounds);
  return bounded ? &frame.bounds : nullptr;
}

void Session::CopyPositions(Eigen::VectorXd& positions) const {
  std::lock_guard<std::mutex> lock(mutex_);
  positions = positions_;
}

int64_t Session::sequence_number() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return seat_.sequence_number();
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
  if (absl::Status status = seat_.Check(kUnaryDriver, name_); !status.ok()) {
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
  const int64_t newest = seat_.sequence_number();
  sequence_number = newest > 0 ? newest : static_cast<int64_t>(version_);
  return true;
}

absl::Status Session::StartRecording(
    std::shared_ptr<SessionRecording> recording) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (!seat_.ended().ok()) return seat_.ended();
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
  seat_.End(std::move(why));
}

absl::Status Session::ended() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return seat_.ended();
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

// A warm solver: one skeleton, its goals and its current pose.
//
// Thread-safe; a driver solves on its own thread, everybody else gets copies.
// Time is passed in. Errors are absl::Status naming field and value; after any
// error the session is as it was.
#ifndef GELENK_SERVER_SESSION_SESSION_H_
#define GELENK_SERVER_SESSION_SESSION_H_

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/ik_solver.h"
#include "gelenk/skeleton/skeleton.h"
#include "server/session/driver_seat.h"
#include "server/session/input_frame.h"
#include "server/session/joint_motion.h"
#include "server/session/session_input.h"
#include "server/session/session_recording.h"
#include "server/session/shared_trees.h"

namespace gelenk::server {

// What a session is made of, and what UpdateSession replaces parts of.
struct SessionState {
  std::vector<Goal> goals;
  SolverOptions options;
  Eigen::VectorXd positions;
  // Nothing was ever solved from `positions`: the next solve is a cold start.
  bool cold = true;
  RigidTransform world_from_skeleton;
  absl::Duration idle_ttl = absl::Minutes(10);
};

// A copy of a session for those who read it.
struct SessionSnapshot {
  SessionState state;
  absl::Time expire_time;
  int64_t revision = 0;
  JointMotion motion;
  // Of its SessionInput; empty where there is nothing in it.
  std::vector<double> memory;
};

// Where a driver last saw a session.
struct ResumeState {
  Eigen::VectorXd positions;
  int64_t sequence_number = 0;
  // Null where the session's own count.
  const std::vector<Goal>* goals = nullptr;
  const RigidTransform* world_from_skeleton = nullptr;
  const JointMotion* motion = nullptr;
  // Of a SessionInput; null makes it begin anew.
  const std::vector<double>* memory = nullptr;
};

// What a solve gave; reused from frame to frame.
struct SolvedFrame {
  Eigen::VectorXd positions;
  SolveReport report;
  ReportDetail detail = ReportDetail::kBrief;
  absl::Duration solve_duration;
  absl::Time end_time;
  // Working memory for sessions with speed limits.
  Eigen::VectorXd start;
  StepBounds bounds;
  // The session holds more than a driver could tell from its last frame and its
  // create request: give it a continuation.
  bool needs_continuation = false;
  // Of sessions that follow a source.
  std::optional<RetargetReport> retarget_report;
  // Of sessions with conditioning.
  std::optional<LiveStatus> live;
  absl::Duration latency;
};

class Session {
 public:
  // `state.positions` has passed CheckPositions, `problem` was made of
  // `state.goals` by `trees`, which have passed CheckGoals of `input.source`.
  Session(std::string name, std::string skeleton_name, std::string affinity_key,
          std::shared_ptr<SharedTrees> trees, IkProblem problem,
          SessionState state, absl::Time now, SessionInput input = {});

  const std::string& name() const { return name_; }
  const std::string& skeleton_name() const { return skeleton_name_; }
  const std::string& affinity_key() const { return affinity_key_; }
  const Skeleton& skeleton() const { return *trees_->skeleton(); }
  SharedTrees& trees() const { return *trees_; }
  absl::Time create_time() const { return create_time_; }
  // For what in it never changes: names, spec, options.
  const SessionInput& input() const { return input_; }
  // Whether it is made of that skeleton.
  bool IsOn(absl::string_view skeleton_name) const {
    return skeleton_name_ == skeleton_name ||
           (input_.source != nullptr &&
            input_.source->skeleton_name() == skeleton_name);
  }

  // Makes `driver` the one who may solve. FAILED_PRECONDITION when there is
  // another one and `take_over` is not set; who loses it is told by
  // CheckDriver.
  absl::Status Claim(DriverId driver, bool take_over, absl::Time now);
  void Release(DriverId driver);

  // OK while `driver` drives; ABORTED after it was taken over; the reason after
  // End.
  absl::Status CheckDriver(DriverId driver) const;

  // Puts the session where a driver last saw it.
  absl::Status Resume(DriverId driver, const ResumeState& state);

  // Takes a frame's targets, without solving. A frame with any fault changes
  // nothing but uses up its sequence number. One that nobody sent uses up none
  // and does not make the session live longer; its capture time is filled in.
  // OUT_OF_RANGE: captured before what was shown in its place; see
  // FrameConditioning. Allocates nothing without a patch.
  absl::Status Apply(DriverId driver, InputFrame& frame, absl::Time now);

  // Uses up the sequence number of a frame with a fault.
  absl::Status Skip(DriverId driver, int64_t sequence_number, absl::Time now);

  // True when the next solve may take long enough to be no guest of an I/O
  // thread: it may restart, or diagnoses.
  bool IsHeavy() const;

  // Solves for the present targets. `whole` asks for the whole report.
  absl::Status Solve(DriverId driver, IkSolver& solver, bool whole,
                     SolvedFrame& frame);

  // The last pose, without solving.
  void CopyPositions(Eigen::VectorXd& positions) const;

  // Newest sequence number; 0 before the first.
  int64_t sequence_number() const;

  SessionSnapshot Snapshot() const;

  // Applies `change` to a copy of the state, checks it, and takes it. `change`
  // must not call the session.
  // ABORTED when `revision` is given and is not the present one,
  // FAILED_PRECONDITION while a stream drives.
  absl::Status Update(const std::function<absl::Status(SessionState&)>& change,
                      std::optional<int64_t> revision, absl::Time now);

  // For viewers: true when there is a pose newer than `version`, which is then
  // copied, with its sequence number (or the count of solves without one).
  bool CopyIfNewer(uint64_t& version, Eigen::VectorXd& positions,
                   RigidTransform& world_from_skeleton,
                   int64_t& sequence_number) const;

  // From now on `recording` takes every pose that is solved for.
  // FAILED_PRECONDITION while there is another one.
  absl::Status StartRecording(std::shared_ptr<SessionRecording> recording);
  // Takes it away. FAILED_PRECONDITION when there is none.
  absl::StatusOr<std::shared_ptr<SessionRecording>> StopRecording();

  // Ends the session for good; drivers and viewers are told `why`.
  void End(absl::Status why);
  // OK while it lives.
  absl::Status ended() const;

  bool IsExpired(absl::Time now) const;
  // Without what sessions share: skeleton and tree.
  size_t ByteSize() const;

 private:
  // OK when `driver` may bring a frame of that number now, which is then used
  // up.
  absl::Status TakeNumberLocked(DriverId driver,
                                std::optional<int64_t> sequence_number,
                                absl::Time now)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Adds the present pose, that of `frame`, to a recording.
  void RecordLocked(const SolvedFrame& frame)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Instead of a solve.
  void FollowSourceLocked(SolvedFrame& frame)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // What the speed limits leave for the next solve; null where there are none.
  const StepBounds* SpeedBoundsLocked(SolvedFrame& frame) const
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  SessionState StateLocked() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const std::string name_;
  const std::string skeleton_name_;
  const std::string affinity_key_;
  const std::shared_ptr<SharedTrees> trees_;
  const absl::Time create_time_;
  // Guarded by mutex_, but for what in it never changes.
  SessionInput input_;

  mutable std::mutex mutex_;
  IkProblem problem_ ABSL_GUARDED_BY(mutex_);
  SolverOptions options_ ABSL_GUARDED_BY(mutex_);
  Eigen::VectorXd positions_ ABSL_GUARDED_BY(mutex_);
  bool cold_ ABSL_GUARDED_BY(mutex_);
  absl::Duration idle_ttl_ ABSL_GUARDED_BY(mutex_);
  absl::Time last_driven_ ABSL_GUARDED_BY(mutex_);
  DriverSeat seat_ ABSL_GUARDED_BY(mutex_);
  uint64_t version_ ABSL_GUARDED_BY(mutex_) = 0;
  int64_t revision_ ABSL_GUARDED_BY(mutex_) = 1;
  // Of the newest frame; and what the last solved one left.
  std::optional<absl::Duration> motion_time_ ABSL_GUARDED_BY(mutex_);
  JointMotion motion_ ABSL_GUARDED_BY(mutex_);
  // Weights, goals or place were changed by frames.
  bool drifted_ ABSL_GUARDED_BY(mutex_) = false;
  // Null while nobody records.
  std::shared_ptr<SessionRecording> recording_ ABSL_GUARDED_BY(mutex_);
  // The last frame left some goal where it was.
  bool partly_named_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_SESSION_H_

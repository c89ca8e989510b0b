// One session on a stream: takes its frames, gives its answers.
//
// Touched by one thread at a time, that of its stream.
#ifndef GELENK_SERVER_RPC_STREAM_SLOT_H_
#define GELENK_SERVER_RPC_STREAM_SLOT_H_

#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "gelenk/ik/ik_solver.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/motion/live_clock.h"
#include "gelenk/v1/session_service.pb.h"
#include "server/rpc/service_state.h"
#include "server/session/fill_schedule.h"
#include "server/session/session.h"

namespace gelenk::server {

class StreamSlot {
 public:
  // Finds, claims and resumes the session that `request` names; its affinity
  // key must be that of `neighbour`, where there is one. `event` receives
  // KIND_ATTACHED. Who drives the session now keeps it when `request` has a
  // fault.
  static absl::StatusOr<std::unique_ptr<StreamSlot>> Attach(
      ServiceState& state, const v1::AttachSession& request,
      const Session* neighbour, absl::Time now, v1::StreamEvent* event);

  // Gives the session free.
  ~StreamSlot();

  bool every_frame() const { return every_frame_; }
  const Session& session() const { return *session_; }
  // Bytes of an answer, about.
  size_t answer_bytes() const;

  // Takes the frame's targets without solving; a frame with a fault changes
  // nothing.
  absl::Status Take(const v1::TargetFrame& frame, absl::Time now);

  // When to Fill, if no frame comes until then; never, where the session does
  // not want it or nothing changes any more.
  std::optional<absl::Time> fill_time() const { return schedule_.next(); }
  bool fills() const { return schedule_.is_on(); }
  // Answers for a frame that did not come. An error: there is no answer, and
  // there will be none before the next frame.
  absl::Status Fill(IkSolver& solver, absl::Time now, v1::PoseFrame* answer);

  // Frames were taken that no answer has covered.
  bool has_unanswered() const { return taken_ > 0; }
  bool IsHeavy() const { return session_->IsHeavy(); }

  // Solves for what was taken and fills the answer.
  absl::Status Answer(IkSolver& solver, absl::Time read_time,
                      v1::PoseFrame* answer);

  // OK while this slot drives its session, else why it does not.
  absl::Status CheckDriver() const { return session_->CheckDriver(driver_); }

  // The answer to a frame with a fault: the reason and the last good pose.
  void Refuse(const v1::TargetFrame& frame, const absl::Status& why,
              v1::PoseFrame* answer);

 private:
  StreamSlot(const ServiceState& state, std::shared_ptr<Session> session,
             DriverId driver, const v1::AttachSession& request);
  // By how much the newest frame came later than the fastest of late.
  void NoteAge(absl::Duration capture_time, absl::Time arrival);
  // Solves for what was taken, or for nothing new.
  absl::Status Solve(IkSolver& solver, absl::Time begin, v1::PoseFrame* answer);
  // Fills the times of an answer to frames that told theirs.
  void AddTime(v1::PoseFrame* answer);
  // Fills joint frames and continuation where they are due.
  void AddExtras(v1::PoseFrame* answer);

  const std::shared_ptr<Session> session_;
  const DriverId driver_;
  const InstructionSet level_;
  const int slot_;
  const bool every_frame_;
  const bool include_joint_frames_;
  const int report_interval_;
  const int continuation_interval_;

  InputFrame input_;
  SolvedFrame solved_;
  WorldTransforms frames_;
  // Since the last answer.
  int taken_ = 0;
  int64_t sequence_number_ = 0;
  google::protobuf::Duration capture_time_;
  bool has_capture_time_ = false;
  ClockOffset clock_offset_{kClockWindow_s};
  double age_s_ = 0;
  // Of any frame, good or bad; those that were not above it are counted.
  int64_t newest_number_ = 0;
  int64_t out_of_order_count_ = 0;
  int64_t answered_ = 0;
  FillSchedule schedule_;
  Eigen::VectorXd positions_before_;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_STREAM_SLOT_H_

// What moves a session in place of its goals: poses of another skeleton, or a
// person's trackers.
//
// Part of a session and guarded by its mutex. Errors are absl::Status naming
// field and value; after any error all is as it was.
#ifndef GELENK_SERVER_SESSION_SOURCE_MOTION_H_
#define GELENK_SERVER_SESSION_SOURCE_MOTION_H_

#include <Eigen/Core>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/types/span.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/retarget/live_retargeter.h"
#include "server/session/input_frame.h"

namespace gelenk::server {

class SourceMotion {
 public:
  // `skeleton_name` is that of the source; empty with trackers.
  SourceMotion(std::string skeleton_name,
               std::unique_ptr<LiveRetargeter> retargeter)
      : skeleton_name_(std::move(skeleton_name)),
        retargeter_(std::move(retargeter)) {}

  const std::string& skeleton_name() const { return skeleton_name_; }
  // Its spec and models never change.
  const LiveRetargeter& retargeter() const { return *retargeter_; }

  // With trackers every goal must be one; else there is none.
  absl::Status CheckGoals(absl::Span<const Goal> goals) const;

  // Whether `frame` may be taken; `problem` is as it will be but for the
  // targets and weights that the frame brings. One without a pose may be taken
  // where something else stands for it. Normalises the pose in it.
  absl::Status CheckFrame(const IkProblem& problem, bool may_be_missing,
                          InputFrame& frame) const;

  // A checked frame; the pose in it is the source's until the next.
  void Take(const InputFrame& frame);
  Eigen::VectorXd& pose() { return pose_; }

  // Moves `positions` after the source; trackers are where `problem` has them.
  void Step(const IkProblem& problem, Eigen::VectorXd& positions);
  const RetargetReport& report() const { return retargeter_->report(); }

  // Another driver has another clock.
  void ForgetTime() { retargeter_->ForgetTime(); }
  void Reset() { retargeter_->Reset(); }
  void Exchange(StateNumbers& state) { retargeter_->Exchange(state); }
  void SetPositions(const Eigen::VectorXd& positions) {
    retargeter_->SetPositions(positions);
  }

  size_t ByteSize() const { return sizeof(*this) + retargeter_->ByteSize(); }

 private:
  const std::string skeleton_name_;
  const std::unique_ptr<LiveRetargeter> retargeter_;
  // The newest one.
  Eigen::VectorXd pose_;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_SOURCE_MOTION_H_

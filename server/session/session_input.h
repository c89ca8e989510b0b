// What stands between the frames of a session and its poses where it is more
// than a solver: a source that the session follows, and the cleaning and timing
// of frames.
//
// Part of a session and guarded by its mutex, but for names, spec and options,
// which never change. Errors are absl::Status naming field and value; after any
// error all is as it was.
#ifndef GELENK_SERVER_SESSION_SESSION_INPUT_H_
#define GELENK_SERVER_SESSION_SESSION_INPUT_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "absl/types/span.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/math/state_numbers.h"
#include "server/session/frame_conditioning.h"
#include "server/session/input_frame.h"
#include "server/session/source_motion.h"

namespace gelenk::server {

struct SessionInput {
  // Null: goals are solved for.
  std::unique_ptr<SourceMotion> source;
  // Null: frames are used as they come. Of the source's poses, or of targets.
  std::unique_ptr<FrameConditioning> conditioning;

  bool empty() const { return source == nullptr && conditioning == nullptr; }
  // Targets of frames are not those that are solved for.
  bool ConditionsTargets() const {
    return conditioning != nullptr && conditioning->is_of_targets();
  }

  // Whether the session may have those goals.
  absl::Status CheckGoals(absl::Span<const Goal> goals) const;
  // It has them now: targets begin anew.
  void SetGoals(absl::Span<const Goal> goals);

  // Tells `frame`, which came at `arrival`, when in the motion it is.
  void SetTimes(absl::Time arrival, InputFrame& frame) const;

  // Whether `frame` brings what is wanted; `problem` is as it will be but for
  // the targets and weights in the frame.
  absl::Status CheckFrame(const IkProblem& problem, InputFrame& frame) const;
  // A checked frame that came at `arrival`.
  void Take(const InputFrame& frame, absl::Time arrival);

  // Makes what is conditioned ready: targets of `problem`, or the source's
  // pose. DEADLINE_EXCEEDED where there is nothing to go after.
  absl::Status Sample(IkProblem& problem);

  // Another driver has another clock.
  void ForgetTime();
  void Reset();
  // What is remembered from frame to frame.
  void Exchange(StateNumbers& state) const;
  // Puts what a driver gives back in the place of it, for a session that will
  // have `goals` and `positions`; without `memory` all begins anew.
  absl::Status Resume(absl::Span<const Goal> goals,
                      const Eigen::VectorXd& positions,
                      const std::vector<double>* memory);

  // Beside this struct and models.
  size_t ByteSize() const;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_SESSION_INPUT_H_

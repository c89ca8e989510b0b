#include "server/session/session_input.h"

#include "gelenk/base/violations.h"

namespace gelenk::server {

absl::Status SessionInput::CheckGoals(absl::Span<const Goal> goals) const {
  return source != nullptr ? source->CheckGoals(goals) : absl::OkStatus();
}

void SessionInput::SetGoals(absl::Span<const Goal> goals) {
  if (ConditionsTargets()) conditioning->SetGoals(goals);
}

void SessionInput::SetTimes(absl::Time arrival, InputFrame& frame) const {
  if (conditioning != nullptr) {
    conditioning->SetTimes(arrival, frame);
  } else {
    frame.motion_time = frame.capture_time;
  }
}

absl::Status SessionInput::CheckFrame(const IkProblem& problem,
                                      InputFrame& frame) const {
  if (source == nullptr && frame.has_source_pose) {
    Violations violations;
    violations.Add("source_pose", "the session has no retargeting");
    return violations.ToStatus();
  }
  if (conditioning != nullptr) {
    absl::Status status = conditioning->CheckInTime(frame);
    if (!status.ok()) return status;
  }
  if (source != nullptr) {
    absl::Status status =
        frame.patch ? CheckGoals(problem.goals()) : absl::OkStatus();
    if (status.ok()) {
      status = source->CheckFrame(problem, conditioning != nullptr, frame);
    }
    if (!status.ok()) return status;
  }
  return conditioning != nullptr ? conditioning->CheckFrame(frame)
                                 : absl::OkStatus();
}

void SessionInput::Take(const InputFrame& frame, absl::Time arrival) {
  if (source != nullptr) source->Take(frame);
  if (conditioning != nullptr) conditioning->Take(frame, arrival);
}

absl::Status SessionInput::Sample(IkProblem& problem) {
  if (conditioning == nullptr) return absl::OkStatus();
  return ConditionsTargets() ? conditioning->Sample(problem)
                             : conditioning->Sample(source->pose());
}

void SessionInput::ForgetTime() {
  if (source != nullptr) source->ForgetTime();
  if (conditioning != nullptr) conditioning->Reset();
}

void SessionInput::Reset() {
  if (source != nullptr) source->Reset();
  if (conditioning != nullptr) conditioning->Reset();
}

void SessionInput::Exchange(StateNumbers& state) const {
  if (source != nullptr) source->Exchange(state);
  if (conditioning != nullptr) conditioning->Exchange(state);
}

absl::Status SessionInput::Resume(absl::Span<const Goal> goals,
                                  const Eigen::VectorXd& positions,
                                  const std::vector<double>* memory) {
  if (absl::Status status = CheckGoals(goals); !status.ok()) return status;
  SetGoals(goals);
  if (memory == nullptr) {
    Reset();
    return absl::OkStatus();
  }
  if (absl::Status status = RestoreState(*memory, *this); !status.ok()) {
    return status;
  }
  if (source != nullptr) source->SetPositions(positions);
  return absl::OkStatus();
}

size_t SessionInput::ByteSize() const {
  return (source != nullptr ? source->ByteSize() : 0) +
         (conditioning != nullptr ? sizeof(*conditioning) : 0);
}

}  // namespace gelenk::server

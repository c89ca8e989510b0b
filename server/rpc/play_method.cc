#include "server/rpc/play_method.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "convert/geometry.h"
#include "convert/played_goal.h"
#include "convert/pose.h"
#include "convert/solver.h"
#include "gelenk/base/violations.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/goal_overlay.h"
#include "gelenk/motion/layer_stack.h"
#include "server/rpc/clip_steps.h"
#include "server/rpc/production_call.h"

namespace gelenk::server {
namespace {

using PlayProduction = Production<v1::PlayClipsResponse>;

// Frames in a message as fast as read: enough to make the message's own cost
// small, few enough to come at once.
constexpr int kFramesPerMessage = 16;
// Of a frame in real time; a display has no use for more.
constexpr double kLeastRealTimeFrame_s = 1e-3;

// When what of the layers is shown.
struct Timeline {
  double start_s = 0;
  // Infinite for loops without an end.
  double end_s = 0;
  double frame_time_s = 0;
  bool real_time = false;

  double TimeOf(int64_t frame) const {
    return start_s + static_cast<double>(frame) * frame_time_s;
  }
  // The last frame may be off by rounding.
  bool Has(int64_t frame) const {
    return TimeOf(frame) <= end_s + 1e-6 * frame_time_s;
  }
};

double EndOf(const std::vector<ClipLayer>& layers, const LayerStack& stack) {
  const bool has_end =
      std::any_of(layers.begin(), layers.end(), [](const ClipLayer& layer) {
        return layer.mode == PlaybackMode::kClamp && layer.speed > 0;
      });
  return has_end ? stack.end_s() : std::numeric_limits<double>::infinity();
}

absl::StatusOr<Timeline> TimelineOf(const v1::PlayClipsRequest& request,
                                    const std::vector<ClipLayer>& layers,
                                    const LayerStack& stack) {
  Violations violations;
  Timeline line;
  line.start_s = request.start_s();
  line.end_s = request.has_end_s() ? request.end_s() : EndOf(layers, stack);
  line.frame_time_s = request.frame_time_s() == 0
                          ? FrameTimeOf(layers.front().clip)
                          : request.frame_time_s();
  line.real_time = request.pace() == v1::PlayClipsRequest::PACE_REAL_TIME;
  if (!v1::PlayClipsRequest::Pace_IsValid(request.pace())) {
    violations.Add("pace", absl::StrCat("no such pace: ",
                                        static_cast<int>(request.pace())));
  }
  if (!std::isfinite(line.start_s)) {
    violations.Add("start_s",
                   absl::StrCat("want a finite number, got ", line.start_s));
  }
  if (request.has_end_s() &&
      !(std::isfinite(line.end_s) && line.end_s >= line.start_s)) {
    violations.Add("end_s",
                   absl::StrCat("want a finite number, not before start_s = ",
                                line.start_s, ", got ", line.end_s));
  }
  const double least = line.real_time ? kLeastRealTimeFrame_s : 0;
  if (!(std::isfinite(line.frame_time_s) && line.frame_time_s > 0 &&
        line.frame_time_s >= least)) {
    violations.Add(
        "frame_time_s",
        absl::StrCat("want more than 0, in real time at least ",
                     kLeastRealTimeFrame_s, ", got ", line.frame_time_s));
  }
  if (!violations.empty()) return violations.ToStatus();
  return line;
}

class ClipPlay final : public PlayProduction {
 public:
  ClipPlay(std::shared_ptr<const Skeleton> skeleton, LayerStack stack,
           std::optional<GoalOverlay> overlay,
           const RigidTransform& world_from_skeleton, const Timeline& line,
           bool include_joint_frames)
      : skeleton_(std::move(skeleton)),
        stack_(std::move(stack)),
        overlay_(std::move(overlay)),
        world_from_skeleton_(world_from_skeleton),
        line_(line),
        include_joint_frames_(include_joint_frames),
        positions_(skeleton_->rest_positions()),
        begin_(absl::Now()) {}

  absl::StatusOr<bool> Next(IkSolver& solver,
                            v1::PlayClipsResponse* response) override {
    if (line_.real_time) SkipWhatIsOver(response);
    if (!line_.Has(frame_)) return false;
    const int count = line_.real_time ? 1 : kFramesPerMessage;
    for (int i = 0; i < count && line_.Has(frame_); ++i, ++frame_) {
      Play(line_.TimeOf(frame_), solver, response->add_frames());
    }
    return true;
  }

  absl::Time due() const override {
    if (!line_.real_time || !line_.Has(frame_)) return absl::InfinitePast();
    return DueTime(frame_);
  }

 private:
  absl::Time DueTime(int64_t frame) const {
    return begin_ +
           absl::Seconds(static_cast<double>(frame) * line_.frame_time_s);
  }

  // Frames whose successor is due already, but never the last one.
  void SkipWhatIsOver(v1::PlayClipsResponse* response) {
    const absl::Time now = absl::Now();
    int skipped = 0;
    while (DueTime(frame_ + 1) <= now && line_.Has(frame_ + 1)) {
      ++frame_;
      ++skipped;
    }
    response->set_skipped_frame_count(skipped);
  }

  void Play(double time_s, IkSolver& solver, v1::PlayedFrame* frame) {
    frame->set_time_s(time_s);
    stack_.Sample(time_s, positions_);
    if (overlay_) {
      const absl::Time begin = absl::Now();
      overlay_->Apply(time_s, solver, positions_, report_);
      convert::ToProto(report_, overlay_->detail(), absl::Now() - begin,
                       frame->mutable_report());
    }
    convert::ToProto(positions_, frame->mutable_pose());
    if (!include_joint_frames_) return;
    ForwardKinematics(*skeleton_, positions_, world_from_skeleton_, frames_);
    convert::ToProto(frames_, frame->mutable_joint_frames());
  }

  const std::shared_ptr<const Skeleton> skeleton_;
  LayerStack stack_;
  std::optional<GoalOverlay> overlay_;
  const RigidTransform world_from_skeleton_;
  const Timeline line_;
  const bool include_joint_frames_;
  int64_t frame_ = 0;
  Eigen::VectorXd positions_;
  WorldTransforms frames_;
  SolveReport report_;
  const absl::Time begin_;
};

absl::StatusOr<std::optional<GoalOverlay>> OverlayOf(
    const v1::PlayClipsRequest& request,
    const std::shared_ptr<const Skeleton>& skeleton,
    const RigidTransform& world_from_skeleton) {
  if (request.goals().empty()) return std::nullopt;
  Violations violations;
  absl::StatusOr<std::vector<TimedGoal>> goals =
      convert::FromProto(request.goals());
  violations.AddStatus("", goals.status());
  const absl::StatusOr<SolverOptions> options =
      convert::FromProto(request.solver_options());
  violations.AddStatus("solver_options", options.status());
  if (!violations.empty()) return violations.ToStatus();
  absl::StatusOr<GoalOverlay> overlay = GoalOverlay::Create(
      skeleton, *std::move(goals), *options, world_from_skeleton);
  if (!overlay.ok()) return overlay.status();
  return std::optional<GoalOverlay>(*std::move(overlay));
}

absl::StatusOr<std::unique_ptr<PlayProduction>> Open(
    const ServiceState& state, const v1::PlayClipsRequest& request) {
  const absl::StatusOr<std::vector<ClipLayer>> layers =
      LayersFromProto(state, "layers", nullptr, request.layers());
  if (!layers.ok()) return layers.status();
  const std::shared_ptr<const Skeleton> skeleton =
      layers->front().clip.skeleton();
  Violations violations;
  GoalTarget place = convert::FromProto(request.world_from_skeleton());
  violations.AddStatus("world_from_skeleton", CheckAndNormalize(place));
  if (!violations.empty()) return violations.ToStatus();
  const RigidTransform& world_from_skeleton = std::get<RigidTransform>(place);
  absl::StatusOr<LayerStack> stack = LayerStack::Create(skeleton, *layers);
  if (!stack.ok()) return stack.status();
  const absl::StatusOr<Timeline> line = TimelineOf(request, *layers, *stack);
  if (!line.ok()) return line.status();
  absl::StatusOr<std::optional<GoalOverlay>> overlay =
      OverlayOf(request, skeleton, world_from_skeleton);
  if (!overlay.ok()) return overlay.status();
  return std::make_unique<ClipPlay>(skeleton, *std::move(stack),
                                    *std::move(overlay), world_from_skeleton,
                                    *line, request.include_joint_frames());
}

}  // namespace

void ServePlayClips(v1::MotionService::AsyncService* service,
                    ServiceState* state, IoThread* thread) {
  ServeProduction(
      service, &v1::MotionService::AsyncService::RequestPlayClips,
      [state](const v1::PlayClipsRequest& request) {
        return Open(*state, request);
      },
      state, thread);
}

}  // namespace gelenk::server

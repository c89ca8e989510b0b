#include "client/cli/vmc/vmc_bridge.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/cli/made_session.h"
#include "client/cli/motion/follower.h"
#include "convert/duration.h"
#include "convert/geometry.h"
#include "convert/pose.h"

namespace gelenk::cli {
namespace {

// How long one turn waits: half a frame at 240 Hz.
constexpr absl::Duration kTurn = absl::Milliseconds(2);
constexpr absl::Duration kSendTimeout = absl::Seconds(5);
// Packets that one turn looks at: a flood must not keep answers from leaving.
constexpr int kMaxPacketsATurn = 256;

}  // namespace

VmcBridge::VmcBridge(std::shared_ptr<client::Connection> connection,
                     BodyFile target, std::unique_ptr<UdpSocket> in,
                     std::unique_ptr<UdpSocket> out,
                     std::optional<VmcTrackers> trackers,
                     std::optional<absl::Duration> fill_interval)
    : connection_(std::move(connection)),
      target_(std::move(target)),
      in_(std::move(in)),
      out_(std::move(out)),
      trackers_(std::move(trackers)),
      fill_interval_(fill_interval),
      start_(absl::Now()),
      writer_(target_.model) {}

VmcBridge::~VmcBridge() { Close(); }

void VmcBridge::Close() {
  if (stream_ == nullptr) return;
  stream_.reset();
  DeleteMade(*connection_, spec_);
}

bool VmcBridge::ReceiveFrame() {
  bool is_whole = false;
  for (int i = 0; i < kMaxPacketsATurn; ++i) {
    const absl::Duration wait =
        i == 0 && !is_whole ? kTurn : absl::ZeroDuration();
    if (!in_->Receive(wait, packet_)) break;
    ++counts_.packets;
    const absl::Status read =
        ReadOscPacket(packet_, [&](const OscMessage& message) {
          if (!reader_.Take(message)) return;
          ++counts_.frames_in;
          is_whole = true;
        });
    if (!read.ok()) ++counts_.malformed_packets;
  }
  counts_.refused_messages = reader_.refused_count();
  return is_whole;
}

absl::Status VmcBridge::Open(client::SessionSpec spec) {
  spec.frame_policy = v1::FRAME_POLICY_LATEST_WINS;
  if (fill_interval_) {
    v1::StreamConditioning* conditioning =
        spec.session.mutable_session()->mutable_conditioning();
    conditioning->set_late_policy(
        v1::StreamConditioning::LATE_POLICY_EXTRAPOLATE);
    convert::ToProto(*fill_interval_, conditioning->mutable_fill_interval());
  }
  auto stream = client::SessionStream::Open(connection_, {}, {spec});
  if (!stream.ok()) return stream.status();
  stream_ = *std::move(stream);
  spec_ = std::move(spec);
  return absl::OkStatus();
}

absl::Status VmcBridge::FollowBones(const VmcFrame& frame) {
  if (stream_ != nullptr && performer_->Fits(frame)) return absl::OkStatus();
  absl::StatusOr<VmcPerformer> performer = VmcPerformer::Create(frame);
  // Not yet a body.
  if (!performer.ok()) return absl::OkStatus();
  Close();
  performer_ = *std::move(performer);
  return Open(
      FollowerSpec({performer_->skeleton(), performer_->roles(), nullptr, 0},
                   FollowedBodyOf(target_)));
}

absl::Status VmcBridge::FollowTrackers(const VmcFrame& frame) {
  if (stream_ != nullptr) return absl::OkStatus();
  TrackedBody person;
  person.height_m = trackers_->height_m;
  for (const auto& [serial, part] : trackers_->part_of_serial) {
    const auto found = frame.trackers.find(serial);
    // Not yet all.
    if (found == frame.trackers.end()) return absl::OkStatus();
    person.tracker_ids.push_back(part);
    if (trackers_->begins_in_t_pose) person.t_pose.push_back(found->second);
  }
  return Open(TrackedSpec(person, FollowedBodyOf(target_)));
}

v1::TargetFrame VmcBridge::FrameOfTrackers(const VmcFrame& frame) const {
  v1::TargetFrame targets;
  int goal = 0;
  for (const auto& [serial, part] : trackers_->part_of_serial) {
    v1::GoalTarget* target = targets.add_targets();
    target->set_goal_index(goal++);
    target->set_weight(1);
    convert::ToProto(frame.trackers.at(serial), target->mutable_world_pose());
  }
  return targets;
}

absl::Status VmcBridge::SendFrame() {
  const VmcFrame& seen = reader_.frame();
  absl::Status status = trackers_ ? FollowTrackers(seen) : FollowBones(seen);
  if (!status.ok() || stream_ == nullptr) return status;
  v1::TargetFrame frame;
  if (trackers_) {
    frame = FrameOfTrackers(seen);
  } else {
    convert::ToProto(performer_->PositionsOf(seen),
                     frame.mutable_source_pose());
  }
  convert::ToProto(absl::Now() - start_, frame.mutable_capture_time());
  return stream_->SendNext(std::move(frame), kSendTimeout).status();
}

absl::Status VmcBridge::Answer(absl::Duration timeout) {
  while (stream_ != nullptr) {
    const auto answer = stream_->Receive(timeout);
    if (!answer.ok()) return answer.status();
    if (!answer->has_value()) break;
    timeout = absl::ZeroDuration();
    if ((*answer)->status().code() != 0) {
      ++counts_.refused_frames;
      continue;
    }
    const absl::StatusOr<Eigen::VectorXd> pose =
        convert::FromProto(*target_.model->skeleton, (*answer)->pose());
    if (!pose.ok()) return pose.status();
    out_->Send(
        writer_.Write(*pose, absl::ToDoubleSeconds(absl::Now() - start_)));
    ++counts_.frames_out;
  }
  return absl::OkStatus();
}

absl::Status VmcBridge::Run(absl::Time deadline,
                            const std::atomic<bool>& stop) {
  while (!stop && absl::Now() < deadline) {
    absl::Duration patience = absl::ZeroDuration();
    if (ReceiveFrame()) {
      if (absl::Status status = SendFrame(); !status.ok()) return status;
      // Its answer is a fraction of a millisecond away.
      patience = kTurn;
    }
    if (absl::Status status = Answer(patience); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace gelenk::cli

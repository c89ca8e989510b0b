// The VMC protocol: packets as they come from a network, good and bad, and a
// body that moves by them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/cli/command.h"
#include "client/cli/motion/body_file.h"
#include "client/cli/service.h"
#include "client/cli/vmc/osc_packet.h"
#include "client/cli/vmc/udp_socket.h"
#include "client/cli/vmc/unity_axes.h"
#include "client/cli/vmc/vmc_bridge.h"
#include "client/cli/vmc/vmc_performer.h"
#include "client/cli/vmc/vmc_reader.h"
#include "client/cli/vmc/vmc_writer.h"
#include "gelenk/math/rotation.h"
#include "tests/testing/body_clips.h"
#include "tests/testing/random.h"
#include "tests/testing/status_matchers.h"
#include "tests/testing/tracked_actor.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk::cli {
namespace {

using gelenk::testing::BodyClip;
using gelenk::testing::Fails;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::vector<OscMessage> MessagesOf(const std::string& packet) {
  std::vector<OscMessage> messages;
  const absl::Status status = ReadOscPacket(
      packet, [&](const OscMessage& m) { messages.push_back(m); });
  EXPECT_TRUE(status.ok()) << status;
  return messages;
}

OscMessage BoneMessage(std::string bone, std::vector<float> numbers) {
  OscMessage message{"/VMC/Ext/Bone/Pos", {std::move(bone)}};
  for (float number : numbers) message.arguments.emplace_back(number);
  return message;
}

const OscMessage kOk = {"/VMC/Ext/OK", {1}};
const std::vector<float> kHere = {0, 1, 0, 0, 0, 0, 1};

BodyClip Walk(int frames) {
  return *gelenk::testing::BodyClipFromBvh(gelenk::testing::WalkingBvh(frames),
                                           "walk");
}

TEST(UnityAxesTest, TheirRightIsOurRight) {
  // Unity: X is right, a turn by +90 degrees about Y looks there.
  const double half = std::sqrt(0.5);
  const RigidTransform unity = {Eigen::Quaterniond(half, 0, half, 0),
                                Eigen::Vector3d(1, 2, 3)};
  const RigidTransform ours = MirrorAxes(unity);
  EXPECT_EQ(ours.translation, Eigen::Vector3d(-1, 2, 3));
  const Eigen::Vector3d ahead = ours.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_LT((ahead + Eigen::Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_EQ(MirrorAxes(ours).rotation.coeffs(), unity.rotation.coeffs());
}

TEST(OscPacketTest, BundlesComeRound) {
  const OscMessage bone = BoneMessage("Hips", kHere);
  const auto read = MessagesOf(WriteOscBundle({bone, kOk}));
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].path, bone.path);
  EXPECT_EQ(read[0].arguments, bone.arguments);
  EXPECT_EQ(read[1].arguments, kOk.arguments);
}

TEST(OscPacketTest, APacketThatIsCutOffIsMalformedOrShorter) {
  const std::string packet = WriteOscBundle({BoneMessage("Hips", kHere), kOk});
  for (size_t size = 0; size < packet.size(); ++size) {
    int count = 0;
    const absl::Status status = ReadOscPacket(
        packet.substr(0, size), [&](const OscMessage&) { ++count; });
    EXPECT_LT(count, 2) << size;
    // A bundle may end behind a whole message.
    EXPECT_TRUE(status.code() == absl::StatusCode::kInvalidArgument ||
                (status.ok() && count < 2))
        << size;
  }
}

TEST(OscPacketTest, NoiseIsNoMessage) {
  gelenk::testing::Random random(7);
  const std::string packet =
      WriteOscBundle({BoneMessage("LeftUpperLeg", kHere), kOk});
  for (int round = 0; round < 20000; ++round) {
    std::string bytes = packet;
    const int changes = 1 + round % 7;
    for (int i = 0; i < changes; ++i) {
      const int size = static_cast<int>(bytes.size());
      bytes[gelenk::testing::UniformIndex(random, size)] =
          static_cast<char>(gelenk::testing::UniformIndex(random, 256));
    }
    VmcReader reader;
    ReadOscPacket(bytes, [&](const OscMessage& m) {
      reader.Take(m);
    }).IgnoreError();
  }
}

TEST(OscPacketTest, BundlesOfBundlesEnd) {
  std::string packet("#bundle\0\0\0\0\0\0\0\0\1", 16);
  for (int depth = 0; depth < 1000; ++depth) {
    std::string outer("#bundle\0\0\0\0\0\0\0\0\1", 16);
    const auto size = static_cast<uint32_t>(packet.size());
    for (int shift : {24, 16, 8, 0}) {
      outer.push_back(static_cast<char>(size >> shift & 0xff));
    }
    packet = outer + packet;
  }
  EXPECT_THAT(ReadOscPacket(packet, [](const OscMessage&) {}),
              Fails(absl::StatusCode::kInvalidArgument, "too deep"));
}

TEST(VmcReaderTest, AFrameEndsWithOkOrABoneThatComesAgain) {
  VmcReader reader;
  EXPECT_FALSE(reader.Take(kOk));
  EXPECT_FALSE(reader.Take(BoneMessage("Hips", kHere)));
  EXPECT_TRUE(reader.Take(kOk));
  EXPECT_FALSE(reader.Take(BoneMessage("Hips", {0, 2, 0, 0, 0, 0, 1})));
  EXPECT_FALSE(reader.Take(BoneMessage("Spine", kHere)));
  EXPECT_TRUE(reader.Take(BoneMessage("Hips", {0, 3, 0, 0, 0, 0, 1})));
  EXPECT_EQ(reader.frame().bones[kHipsBone]->translation.y(), 2);
  EXPECT_EQ(reader.refused_count(), 0);
}

TEST(VmcReaderTest, WhatIsWrongIsLeftOutAndCounted) {
  VmcReader reader;
  reader.Take(BoneMessage("Tail", kHere));
  reader.Take(BoneMessage("Hips", {0, 1, 0}));
  reader.Take(BoneMessage("Hips", {0, kNan, 0, 0, 0, 0, 1}));
  reader.Take(BoneMessage("Hips", {0, 1e30F, 0, 0, 0, 0, 1}));
  reader.Take(BoneMessage("Hips", {0, 1, 0, 0, 0, 0, 7}));
  reader.Take({"/VMC/Ext/Bone/Pos", {1, 2, 3, 4, 5, 6, 7, 8}});
  reader.Take({"/VMC/Ext/Root/Pos", {}});
  reader.Take({"/VMC/Ext/Tra/Pos", {std::string("a")}});
  EXPECT_EQ(reader.refused_count(), 8);
  EXPECT_FALSE(reader.Take(kOk));
  // Another program's messages are nobody's fault.
  reader.Take({"/VMC/Ext/Blend/Val", {std::string("Joy"), 1.0F}});
  EXPECT_EQ(reader.refused_count(), 8);
}

TEST(VmcReaderTest, SerialsWithoutEndAreBounded) {
  VmcReader reader;
  for (int i = 0; i < 10000; ++i) {
    OscMessage message = BoneMessage(absl::StrCat("serial", i), kHere);
    message.path = "/VMC/Ext/Tra/Pos";
    reader.Take(message);
  }
  EXPECT_TRUE(reader.Take(kOk));
  EXPECT_EQ(reader.frame().trackers.size(), kMaxVmcTrackers);
}

TEST(VmcPerformerTest, WaitsForABody) {
  VmcFrame frame;
  EXPECT_THAT(VmcPerformer::Create(frame).status(),
              Fails(absl::StatusCode::kFailedPrecondition, "hips"));
  frame.bones[kHipsBone].emplace();
  EXPECT_THAT(VmcPerformer::Create(frame).status(),
              Fails(absl::StatusCode::kFailedPrecondition, "hands"));
}

// What a performer of that body sends at frame f.
std::string PacketOf(VmcWriter& writer, const BodyClip& clip, int f) {
  return writer.Write(clip.positions.col(f), f * clip.frame_time_s);
}

TEST(VmcWriterTest, APerformerIsReadAsItWasWritten) {
  const BodyClip clip = Walk(40);
  VmcWriter writer(clip.model);
  VmcReader reader;
  BodyPoseReader body_reader(clip.model);
  BodyPose pose;
  for (int f = 0; f < clip.frame_count(); ++f) {
    bool is_whole = false;
    // The end of a frame is told by the next one: what is first is OK.
    for (const OscMessage& message : MessagesOf(PacketOf(writer, clip, f))) {
      is_whole |= reader.Take(message);
    }
    if (f == 0) continue;
    ASSERT_TRUE(is_whole);
    body_reader.Read(clip.positions.col(f - 1), pose);
    const absl::StatusOr<VmcPerformer> performer =
        VmcPerformer::Create(reader.frame());
    ASSERT_TRUE(performer.ok()) << performer.status();
    const Skeleton& skeleton = *performer->skeleton();
    WorldTransforms places;
    ForwardKinematics(skeleton, performer->PositionsOf(reader.frame()), places);
    const std::vector<std::pair<std::string, BodyRole>> bones = {
        {"Hips", BodyRole::kPelvis},
        {"LeftHand", BodyRole::kLeftHand},
        {"RightFoot", BodyRole::kRightFoot},
        {"Head", BodyRole::kHead}};
    for (const auto& [bone, role] : bones) {
      const RigidTransform& place = places[skeleton.FindJoint(bone)];
      EXPECT_LT((place.translation - pose.position(role)).norm(), 1e-4)
          << bone << " of frame " << f;
      EXPECT_LT(AngleBetween(place.rotation, pose.rotation(role)), 1e-3);
    }
  }
}

// A bridge onto the humanoid with a performer and a receiver at its ends.
class VmcBridgeTest : public ::testing::Test {
 protected:
  void Start(std::optional<VmcTrackers> trackers = std::nullopt,
             std::optional<absl::Duration> fill_interval = std::nullopt) {
    service_ = *Service::Open("");
    receiver_ = *UdpSocket::Listen("0");
    auto in = *UdpSocket::Listen("0");
    address_ = absl::StrCat("127.0.0.1:", in->port());
    performer_ = *UdpSocket::Connect(address_);
    auto out =
        *UdpSocket::Connect(absl::StrCat("127.0.0.1:", receiver_->port()));
    bridge_ = std::make_unique<VmcBridge>(
        service_->connection(), *ReadBodyFile("humanoid", std::nullopt),
        std::move(in), std::move(out), std::move(trackers), fill_interval);
    thread_ = std::thread([this] {
      status_ = bridge_->Run(absl::Now() + absl::Seconds(60), stop_);
    });
  }

  void Stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  void TearDown() override { Stop(); }

  // The frame that comes out next; none after a while.
  std::optional<VmcFrame> NextFrame() {
    std::string packet;
    while (receiver_->Receive(absl::Seconds(2), packet)) {
      VmcReader reader;
      for (const OscMessage& message : MessagesOf(packet)) {
        reader.Take(message);
      }
      if (reader.Take(kOk)) return reader.frame();
    }
    return std::nullopt;
  }

  std::unique_ptr<Service> service_;
  std::string address_;
  std::unique_ptr<UdpSocket> performer_;
  std::unique_ptr<UdpSocket> receiver_;
  std::unique_ptr<VmcBridge> bridge_;
  std::atomic<bool> stop_ = false;
  absl::Status status_;
  std::thread thread_;
};

TEST_F(VmcBridgeTest, ABodyMovesByPacketsGoodAndBad) {
  const BodyClip clip = Walk(60);
  VmcWriter writer(clip.model);
  Start();
  const std::string bad_rotation =
      WriteOscBundle({BoneMessage("Hips", {0, 1, 0, 0, 0, 0, 9})});
  std::vector<VmcFrame> frames;
  // What is first in a packet tells that the frame before is whole.
  performer_->Send(PacketOf(writer, clip, 0));
  for (int f = 0; f < clip.frame_count(); ++f) {
    const std::string packet = PacketOf(writer, clip, f);
    performer_->Send(packet);
    performer_->Send(packet.substr(0, packet.size() / 2 + 1));
    performer_->Send("#bundle");
    performer_->Send(bad_rotation);
    performer_->Send(WriteOscBundle({BoneMessage("Tail", kHere), kOk}));
    if (const auto frame = NextFrame()) frames.push_back(*frame);
  }
  Stop();
  EXPECT_TRUE(status_.ok()) << status_;
  ASSERT_GE(frames.size(), 50u);
  EXPECT_GE(bridge_->counts().malformed_packets, 60);
  EXPECT_GE(bridge_->counts().refused_messages, 60);
  EXPECT_EQ(bridge_->counts().refused_frames, 0);
  // Forward, along +Z, as far as the legs are longer; the head stays above.
  const auto hips = [&](const VmcFrame& frame) {
    return frame.bones[kHipsBone]->translation;
  };
  EXPECT_GT((hips(frames.back()) - hips(frames.front())).z(), 0.3);
  EXPECT_NEAR(hips(frames.back()).y(), 0.95, 0.1);
  // Legs swing against each other.
  const int left = FindHumanBone("LeftUpperLeg");
  const int right = FindHumanBone("RightUpperLeg");
  double apart = 0;
  for (const VmcFrame& frame : frames) {
    apart = std::max(apart, AngleBetween(frame.bones[left]->rotation,
                                         frame.bones[right]->rotation));
  }
  EXPECT_GT(apart, 0.3);
  // The left one is to the left.
  EXPECT_GT(frames[0].bones[left]->translation.x(), 0);
}

TEST_F(VmcBridgeTest, AFloodDoesNotKeepFramesFromLeaving) {
  const BodyClip clip = Walk(20);
  VmcWriter writer(clip.model);
  Start();
  std::atomic<bool> enough = false;
  std::thread flood([&] {
    const auto socket = *UdpSocket::Connect(address_);
    while (!enough) socket->Send("no OSC at all");
  });
  int count = 0;
  for (int f = 0; f < 20 && count == 0; ++f) {
    performer_->Send(PacketOf(writer, clip, f));
    performer_->Send(PacketOf(writer, clip, f));
    if (NextFrame()) ++count;
  }
  enough = true;
  flood.join();
  Stop();
  EXPECT_TRUE(status_.ok()) << status_;
  EXPECT_GT(count, 0);
}

// Headset and controllers on the actor at a frame.
std::string TrackerPacket(const gelenk::testing::Actor& actor, int frame) {
  const TrackerFrame seen = gelenk::testing::TrackersOn(
      *actor.model, actor.positions.col(frame), false);
  std::vector<OscMessage> messages;
  const auto add = [&](const char* path, const char* serial,
                       const RigidTransform& ours) {
    const RigidTransform place = MirrorAxes(ours);
    OscMessage message{path, {std::string(serial)}};
    for (double n : place.translation) {
      message.arguments.emplace_back(static_cast<float>(n));
    }
    for (double n : place.rotation.coeffs()) {
      message.arguments.emplace_back(static_cast<float>(n));
    }
    messages.push_back(message);
  };
  add("/VMC/Ext/Hmd/Pos", "hmd", *seen.head);
  add("/VMC/Ext/Con/Pos", "con0", *seen.hands[0]);
  add("/VMC/Ext/Con/Pos", "con1", *seen.hands[1]);
  messages.push_back(kOk);
  return WriteOscBundle(messages);
}

TEST_F(VmcBridgeTest, TrackersMoveABody) {
  const gelenk::testing::Actor actor = gelenk::testing::WalkingActor(40);
  VmcTrackers trackers;
  trackers.part_of_serial = {
      {"hmd", "head"}, {"con0", "left_hand"}, {"con1", "right_hand"}};
  Start(trackers);
  std::vector<VmcFrame> frames;
  for (int f = 0; f < 40; ++f) {
    performer_->Send(TrackerPacket(actor, f));
    if (const auto frame = NextFrame()) frames.push_back(*frame);
  }
  Stop();
  EXPECT_TRUE(status_.ok()) << status_;
  ASSERT_GE(frames.size(), 30u);
  EXPECT_GT((frames.back().bones[kHipsBone]->translation -
             frames.front().bones[kHipsBone]->translation)
                .z(),
            0.2);
}

TEST_F(VmcBridgeTest, TheCommandFollowsTheTrackersThatItIsTold) {
  const gelenk::testing::Actor actor = gelenk::testing::WalkingActor(2);
  receiver_ = *UdpSocket::Listen("0");
  const std::string port = absl::StrCat((*UdpSocket::Listen("0"))->port());
  performer_ = *UdpSocket::Connect(absl::StrCat("127.0.0.1:", port));
  CLI::App app;
  const Command command = AddBridgeCommand(app);
  app.parse(absl::StrCat("bridge vmc --listen ", port, " --onto humanoid",
                         " --send 127.0.0.1:", receiver_->port(),
                         " --tracker hmd=head --tracker con0=left_hand",
                         " --tracker con1=right_hand --seconds 3",
                         " --format json"));
  std::string output;
  std::atomic<bool> ended = false;
  thread_ = std::thread([&] {
    status_ = command.run(GlobalOptions(), &output);
    ended = true;
  });
  const std::string packet = TrackerPacket(actor, 0);
  bool came_out = false;
  std::string answer;
  while (!ended && !came_out) {
    performer_->Send(packet);
    came_out = receiver_->Receive(absl::Milliseconds(10), answer);
  }
  thread_.join();
  EXPECT_TRUE(status_.ok()) << status_;
  EXPECT_TRUE(came_out) << output;
}

TEST_F(VmcBridgeTest, ASilentPerformerComesToRest) {
  const BodyClip clip = Walk(30);
  VmcWriter writer(clip.model);
  Start({}, absl::Milliseconds(20));
  for (int f = 0; f < clip.frame_count(); ++f) {
    performer_->Send(PacketOf(writer, clip, f));
  }
  std::vector<VmcFrame> frames;
  while (const auto frame = NextFrame()) frames.push_back(*frame);
  Stop();
  EXPECT_TRUE(status_.ok()) << status_;
  EXPECT_EQ(bridge_->counts().refused_frames, 0);
  ASSERT_GE(frames.size(), 3u);
  const int leg = FindHumanBone("LeftUpperLeg");
  const auto turn = [&](const VmcFrame& a, const VmcFrame& b) {
    return AngleBetween(a.bones[leg]->rotation, b.bones[leg]->rotation);
  };
  EXPECT_GT(turn(frames.front(), frames.back()), 0.1);
  EXPECT_LT(turn(*(frames.end() - 2), frames.back()), 0.02);
}

TEST(UdpSocketTest, BadAddressesAreNamed) {
  EXPECT_THAT(UdpSocket::Connect("nowhere").status(),
              Fails(absl::StatusCode::kInvalidArgument, "\"nowhere\""));
  EXPECT_THAT(UdpSocket::Listen("99999").status(),
              Fails(absl::StatusCode::kInvalidArgument, "a port up to 65535"));
  const auto taken = *UdpSocket::Listen("0");
  EXPECT_THAT(UdpSocket::Listen(absl::StrCat(taken->port())).status(),
              Fails(absl::StatusCode::kUnavailable, "in use"));
}

}  // namespace
}  // namespace gelenk::cli

#include "gelenk/contact/contact_detector.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/core/contact/stepping_feet.h"

namespace gelenk {
namespace {

constexpr int kLeft = 0;

// Fed frame by frame; the contacts of the left heel.
std::vector<Contact> LeftHeel(ContactDetector& detector,
                              const std::vector<FootPoints>& frames,
                              double frame_time_s) {
  std::vector<Contact> contacts;
  for (const FootPoints& frame : frames) {
    contacts.push_back(detector.Update(frame, frame_time_s)[kLeft][kHeel]);
  }
  return contacts;
}

TEST(ContactDetectorTest, StandsStepsAndStandsAtAnyFrameRate) {
  for (double frame_time : {1.0 / 24, 1.0 / 60, 1.0 / 120, 1.0 / 1000}) {
    SCOPED_TRACE(frame_time);
    ContactDetector detector({});
    const std::vector<Contact> heel =
        LeftHeel(detector, OneStep(frame_time), frame_time);
    const auto at = [&](double time) {
      return heel[static_cast<size_t>(time / frame_time)];
    };
    EXPECT_EQ(heel[0], Contact::kPlanted);  // Low: speed is not known yet.
    EXPECT_EQ(at(0.5), Contact::kPlanted);
    EXPECT_EQ(at(1.25), Contact::kNone);
    EXPECT_EQ(at(2.0), Contact::kPlanted);
  }
}

TEST(ContactDetectorTest, FindsTheFloorWhereverItIs) {
  for (double floor : {-3.0, 0.0, 1.2}) {
    ContactDetector detector({});
    for (const FootPoints& frame : OneStep(0.01, floor)) {
      detector.Update(frame, 0.01);
    }
    // A step's way up and down pulls it by millimetres.
    EXPECT_NEAR(detector.FloorAt(Eigen::Vector3d::Zero()), floor, 0.01);
  }
}

TEST(ContactDetectorTest, AFootOnARaisedGroundIsInContactOnlyWithThatGround) {
  std::vector<FootPoints> standing(50, OneStep(0.01, 0.5)[0]);
  ContactDetector on_it({}, std::make_shared<FlatGround>(0.5));
  ContactDetector above({}, std::make_shared<FlatGround>(0.3));
  EXPECT_EQ(LeftHeel(on_it, standing, 0.01).back(), Contact::kPlanted);
  EXPECT_EQ(LeftHeel(above, standing, 0.01).back(), Contact::kNone);
}

TEST(ContactDetectorTest, HysteresisFromBothSides) {
  const ContactThresholds limits;
  const auto ground = std::make_shared<FlatGround>();
  const auto foot_at = [](double height) {
    const auto foot = FlatFoot({0, height, 0});
    return FootPoints{foot, foot};
  };
  const double between = (limits.max_height_on + limits.max_height_off) / 2;
  ContactDetector from_above({}, ground);
  ContactDetector from_below({}, ground);
  for (int f = 0; f < 5; ++f) {
    from_above.Update(foot_at(between), 0.05);
    from_below.Update(foot_at(0), 0.05);
  }
  EXPECT_EQ(from_above.contacts()[kLeft][kHeel], Contact::kNone);
  // 4 cm in half a second: slow enough.
  for (int f = 1; f <= 10; ++f)
    from_below.Update(foot_at(f * between / 10), .05);
  EXPECT_EQ(from_below.contacts()[kLeft][kHeel], Contact::kPlanted);
  from_below.Update(foot_at(limits.max_height_off + 1e-6), 0.05);
  EXPECT_EQ(from_below.contacts()[kLeft][kHeel], Contact::kNone);
}

TEST(ContactDetectorTest, AFootThatTurnsOnItsBallIsHeldByTheBallOnly) {
  ContactDetector detector({}, std::make_shared<FlatGround>());
  FootContacts contacts = {};
  const Eigen::Vector3d ball(0, 0, 0.18);
  for (int f = 0; f < 60; ++f) {
    // 60 degrees a second about the ball: the heel goes at 0.19 m/s.
    const double yaw = f * 0.01 * std::numbers::pi / 3;
    const Eigen::Vector3d ahead(std::sin(yaw), 0, std::cos(yaw));
    const auto foot = FlatFoot(ball - 0.18 * ahead, yaw);
    contacts = detector.Update({foot, FlatFoot({1, 0, 0})}, 0.01);
  }
  EXPECT_EQ(contacts[kLeft][kBall], Contact::kPlanted);
  EXPECT_EQ(contacts[kLeft][kHeel], Contact::kTurning);
  EXPECT_EQ(contacts[1][kHeel], Contact::kPlanted);
}

TEST(ContactDetectorTest, ThresholdsGrowWithTheLeg) {
  // 4 cm above the ground: not for a man, but for a giant.
  const auto foot = FlatFoot({0, 0.04, 0});
  const FootPoints feet = {foot, foot};
  ContactDetector man({}, std::make_shared<FlatGround>());
  FeetGeometry big;
  big.leg_length_m = 2 * kReferenceLegM;
  ContactDetector giant(big, std::make_shared<FlatGround>());
  for (int f = 0; f < 5; ++f) {
    man.Update(feet, 0.01);
    giant.Update(feet, 0.01);
  }
  EXPECT_EQ(man.contacts()[kLeft][kHeel], Contact::kNone);
  EXPECT_EQ(giant.contacts()[kLeft][kHeel], Contact::kPlanted);
}

// Noise of 2 mm is a speed of 0.15 m/s over two frames at 60 Hz.
TEST(ContactDetectorTest, TremblingFeetStandAndStep) {
  for (double frame_time : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
    SCOPED_TRACE(frame_time);
    ContactDetector detector({});
    const FootPoints standing = OneStep(frame_time)[0];
    const int settled = static_cast<int>(1 / frame_time);
    const std::vector<Contact> heel = LeftHeel(
        detector,
        Trembling(std::vector<FootPoints>(10 * settled, standing), 2e-3),
        frame_time);
    EXPECT_EQ(std::count(heel.begin() + settled, heel.end(), Contact::kNone),
              0);
    detector.Reset();
    const std::vector<Contact> step =
        LeftHeel(detector, Trembling(OneStep(frame_time), 2e-3), frame_time);
    EXPECT_EQ(step[static_cast<size_t>(1.25 / frame_time)], Contact::kNone);
    EXPECT_NE(step.back(), Contact::kNone);
  }
}

TEST(PointNoiseTest, TellsNoiseFromMotion) {
  for (double frame_time : {1.0 / 30, 1.0 / 120}) {
    for (double deviation : {0.0, 1e-3, 2e-3, 5e-3}) {
      PointNoise noise;
      // The right foot stands while the left one steps.
      for (const FootPoints& frame :
           Trembling(OneStep(frame_time), deviation)) {
        noise.Update(frame, frame_time);
      }
      EXPECT_NEAR(noise.deviation_m(), deviation, 0.3 * deviation + 1e-9);
    }
  }
}

TEST(ContactDetectorTest, ResetForgets) {
  ContactDetector detector({});
  const std::vector<FootPoints> frames = OneStep(0.01);
  const std::vector<Contact> first = LeftHeel(detector, frames, 0.01);
  detector.Reset();
  EXPECT_EQ(LeftHeel(detector, frames, 0.01), first);
}

}  // namespace
}  // namespace gelenk

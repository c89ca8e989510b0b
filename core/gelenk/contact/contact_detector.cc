#include "gelenk/contact/contact_detector.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "gelenk/contact/floor_rules.h"

namespace gelenk {
namespace {

// How fast the estimated floor follows: in general, when a point is clearly
// below it, and the bias of one point; s.
constexpr double kFloorTime_s = 1;
constexpr double kSinkTime_s = 0.05;
constexpr double kBiasTime_s = 0.5;
constexpr double kClearlyBelow = 0.03;
// Noise below this is as good as none, m: what is left of fast motion looks
// like it. Thresholds are this many deviations above the rest.
constexpr double kNoNoise = 0.5e-3;
constexpr double kNoiseMargin = 3;

// The part of the way that an exponential approach goes in `dt_s`.
double Approach(double dt_s, double time_s) {
  return 1 - std::exp(-dt_s / time_s);
}

}  // namespace

void FootContactState::Update(
    const ContactThresholds& thresholds,
    const std::array<double, kFootPointCount>& heights,
    const std::array<Eigen::Vector3d, kFootPointCount>& velocities,
    const Eigen::Vector3d& ball_from_heel) {
  for (int point = 0; point < kFootPointCount; ++point) {
    const double speed = velocities[point].norm();
    Contact& contact = contacts_[point];
    if (contact == Contact::kNone) {
      if (heights[point] < thresholds.max_height_on &&
          speed < thresholds.max_speed_on) {
        contact = Contact::kPlanted;
      }
    } else if (heights[point] > thresholds.max_height_off ||
               speed > thresholds.max_speed_off) {
      contact = Contact::kNone;
    }
  }
  FindTurning(thresholds, velocities, ball_from_heel);
}

void FootContactState::FindTurning(
    const ContactThresholds& thresholds,
    const std::array<Eigen::Vector3d, kFootPointCount>& velocities,
    const Eigen::Vector3d& ball_from_heel) {
  Contact& heel = contacts_[kHeel];
  Contact& ball = contacts_[kBall];
  if (heel == Contact::kNone || ball == Contact::kNone) {
    if (heel == Contact::kTurning) heel = Contact::kPlanted;
    if (ball == Contact::kTurning) ball = Contact::kPlanted;
    return;
  }
  const Eigen::Vector3d ahead = Horizontal(ball_from_heel).stableNormalized();
  const Eigen::Vector3d across(ahead.z(), 0, -ahead.x());
  const double turning =
      std::abs(across.dot(velocities[kBall] - velocities[kHeel]));
  const double heel_speed = Horizontal(velocities[kHeel]).norm();
  const double ball_speed = Horizontal(velocities[kBall]).norm();
  const bool was_turning =
      heel == Contact::kTurning || ball == Contact::kTurning;
  const double least = was_turning ? thresholds.min_turning_speed_off
                                   : thresholds.min_turning_speed_on;
  const bool turns = turning > least && std::min(heel_speed, ball_speed) <
                                            thresholds.max_still_part * turning;
  const bool about_ball = ball_speed <= heel_speed;
  heel = turns && about_ball ? Contact::kTurning : Contact::kPlanted;
  ball = turns && !about_ball ? Contact::kTurning : Contact::kPlanted;
}

ContactDetector::ContactDetector(const FeetGeometry& feet,
                                 std::shared_ptr<const Ground> ground,
                                 const ContactThresholds& thresholds)
    : feet_(feet),
      ground_(std::move(ground)),
      thresholds_(thresholds),
      size_(feet.leg_length_m / kReferenceLegM) {}

void ContactDetector::Reset() {
  history_count_ = 0;
  history_next_ = 0;
  time_s_ = 0;
  floor_m_ = 0;
  bias_m_ = {};
  noise_.Reset();
  states_ = {};
  contacts_ = {};
}

double ContactDetector::FloorAt(const Eigen::Vector3d& point) const {
  return ground_ != nullptr ? ground_->HeightAt(point) : floor_m_;
}

double ContactDetector::HeightOf(const FootPoints& points, int side,
                                 int point) const {
  const Eigen::Vector3d& at = points[side][point];
  return at.y() - feet_.planted_heights[side][point] - FloorAt(at);
}

int ContactDetector::WindowStart() const {
  // From the newest to the oldest; times differ by rounding from multiples of
  // the frame time.
  constexpr double kRounding_s = 1e-4;
  int index = history_next_;
  for (int i = 0; i < history_count_; ++i) {
    index = (index + kHistory - 1) % kHistory;
    if (time_s_ - history_[index].time_s >=
        thresholds_.speed_window_s - kRounding_s) {
      break;
    }
  }
  return index;
}

int ContactDetector::LiveCount() const {
  if (history_count_ == 0) return 0;
  const int back =
      (history_next_ + kHistory - 1 - WindowStart() + kHistory) % kHistory;
  // Remember compares the latest with the one before.
  return std::min(history_count_, std::max(back + 1, 2));
}

void ContactDetector::Exchange(StateNumbers& state) {
  int count = LiveCount();
  state.Count(count, 0, kHistory);
  if (state.is_reading()) {
    history_count_ = count;
    history_next_ = count % kHistory;
  }
  for (int i = 0; i < count; ++i) {
    Moment& moment =
        history_[(history_next_ + kHistory - count + i) % kHistory];
    state.Number(moment.time_s);
    for (auto& foot : moment.points) {
      for (Eigen::Vector3d& point : foot) state.Vector(point);
    }
  }
  state.Number(time_s_);
  state.Number(floor_m_);
  for (auto& foot : bias_m_) {
    for (double& bias : foot) state.Number(bias);
  }
  noise_.Exchange(state);
  for (int side = 0; side < 2; ++side) {
    states_[side].Exchange(state);
    contacts_[side] = states_[side].contacts();
  }
}

void ContactDetector::Remember(const FootPoints& points) {
  // Frames that come faster than the history can hold replace the newest one.
  if (history_count_ > 1) {
    const int newest = (history_next_ + kHistory - 1) % kHistory;
    const int before = (newest + kHistory - 1) % kHistory;
    if (time_s_ - history_[before].time_s <
        thresholds_.speed_window_s / (kHistory - 2)) {
      history_[newest] = {time_s_, points};
      return;
    }
  }
  history_[history_next_] = {time_s_, points};
  history_next_ = (history_next_ + 1) % kHistory;
  history_count_ = std::min(history_count_ + 1, kHistory);
}

void ContactDetector::StartFloor(const FootPoints& points) {
  double lowest = points[0][kHeel].y();
  PerFootPoint<double> heights;
  for (int side = 0; side < 2; ++side) {
    for (int point = 0; point < kFootPointCount; ++point) {
      heights[side][point] =
          points[side][point].y() - feet_.planted_heights[side][point];
      lowest = std::min(lowest, heights[side][point]);
    }
  }
  double sum = 0;
  int count = 0;
  for (const auto& foot : heights) {
    for (double height : foot) {
      if (height > lowest + kFloorBand * size_) continue;
      sum += height;
      ++count;
    }
  }
  floor_m_ = sum / count;
}

void ContactDetector::FollowFloor(const FootPoints& points,
                                  const PerFootPoint<double>& speeds,
                                  double dt_s) {
  double lowest = HeightOf(points, 0, kHeel);
  for (int side = 0; side < 2; ++side) {
    for (int point = 0; point < kFootPointCount; ++point) {
      lowest = std::min(lowest, HeightOf(points, side, point));
    }
  }
  const double below = lowest + kClearlyBelow * size_;
  if (below < 0) floor_m_ += below * Approach(dt_s, kSinkTime_s);

  double sum = 0;
  int count = 0;
  for (int side = 0; side < 2; ++side) {
    for (int point = 0; point < kFootPointCount; ++point) {
      const double height = HeightOf(points, side, point);
      if (speeds[side][point] > kFloorMaxSpeed || height > kFloorBand * size_) {
        continue;
      }
      sum += height;
      ++count;
    }
  }
  if (count > 0) floor_m_ += sum / count * Approach(dt_s, kFloorTime_s);

  for (int side = 0; side < 2; ++side) {
    for (int point = 0; point < kFootPointCount; ++point) {
      const double height = HeightOf(points, side, point);
      if (speeds[side][point] > kFloorMaxSpeed ||
          std::abs(height) > kFloorBand * size_) {
        continue;
      }
      const double most = kMaxFloorBias * size_;
      double& bias = bias_m_[side][point];
      bias += (std::clamp(height, -most, most) - bias) *
              Approach(dt_s, kBiasTime_s);
    }
  }
}

ContactThresholds ContactDetector::ThresholdsInNoise(double window_s) const {
  const double noise = std::max(0.0, noise_.deviation_m() - kNoNoise * size_);
  const double speed =
      kNoiseMargin * std::numbers::sqrt2 * noise / (window_s * size_);
  ContactThresholds thresholds = thresholds_;
  for (double* most :
       {&thresholds.max_speed_on, &thresholds.max_speed_off,
        &thresholds.min_turning_speed_on, &thresholds.min_turning_speed_off}) {
    *most += speed;
  }
  return thresholds;
}

const FootContacts& ContactDetector::Update(const FootPoints& points,
                                            double dt_s) {
  const bool is_first = history_count_ == 0;
  if (!is_first) time_s_ += dt_s;
  PerFootPoint<Eigen::Vector3d> velocities;
  PerFootPoint<double> speeds = {};
  for (auto& foot : velocities) foot.fill(Eigen::Vector3d::Zero());
  ContactThresholds thresholds = thresholds_;
  noise_.Update(points, dt_s);
  if (!is_first) {
    const Moment& start = history_[WindowStart()];
    thresholds = ThresholdsInNoise(time_s_ - start.time_s);
    const double scale = 1 / ((time_s_ - start.time_s) * size_);
    for (int side = 0; side < 2; ++side) {
      for (int point = 0; point < kFootPointCount; ++point) {
        velocities[side][point] =
            (points[side][point] - start.points[side][point]) * scale;
        speeds[side][point] = velocities[side][point].norm();
      }
    }
  }
  if (ground_ == nullptr) {
    if (is_first) StartFloor(points);
    FollowFloor(points, speeds, is_first ? 0 : dt_s);
  }
  for (int side = 0; side < 2; ++side) {
    std::array<double, kFootPointCount> heights;
    for (int point = 0; point < kFootPointCount; ++point) {
      heights[point] =
          (HeightOf(points, side, point) - bias_m_[side][point]) / size_;
    }
    states_[side].Update(thresholds, heights, velocities[side],
                         points[side][kBall] - points[side][kHeel]);
    contacts_[side] = states_[side].contacts();
  }
  Remember(points);
  return contacts_;
}

}  // namespace gelenk

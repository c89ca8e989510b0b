#include "gelenk/contact/contact_labels.h"

#include <algorithm>
#include <cmath>

#include "gelenk/contact/floor_rules.h"

namespace gelenk {
namespace {

// Contacts this far apart are one, and those that short none; s.
constexpr double kMaxGap_s = 0.05;
constexpr double kMinContact_s = 0.06;

constexpr double kLowestQuantile = 0.02;
// Planted points are seen from above: noise lifts them more than it sinks them.
constexpr double kBiasQuantile = 0.4;
constexpr size_t kMinFloorSamples = 8;
constexpr size_t kMinBiasSamples = 5;

double Quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(
                           part * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

class ContactLabeller {
 public:
  ContactLabeller(absl::Span<const FootPoints> frames, double frame_time_s,
                  const FeetGeometry& feet, const Ground* ground,
                  const ContactThresholds& thresholds)
      : frames_(frames),
        frame_time_s_(frame_time_s),
        feet_(feet),
        ground_(ground),
        thresholds_(thresholds),
        size_(feet.leg_length_m / kReferenceLegM) {}

  ContactLabels Label() {
    labels_.frames.resize(frames_.size());
    if (frames_.size() < kMinContactFrames) return std::move(labels_);
    TakeVelocities();
    if (ground_ == nullptr) FindFloor();
    for (int side = 0; side < 2; ++side) {
      FootContactState state;
      for (size_t f = 0; f < frames_.size(); ++f) {
        std::array<double, kFootPointCount> heights;
        for (int point = 0; point < kFootPointCount; ++point) {
          heights[point] =
              (HeightOf(f, side, point) - labels_.bias_m[side][point]) / size_;
        }
        const auto& foot = frames_[f][side];
        state.Update(thresholds_, heights, velocities_[f][side],
                     foot[kBall] - foot[kHeel]);
        labels_.frames[f][side] = state.contacts();
      }
      for (int point = 0; point < kFootPointCount; ++point) {
        FillGaps(side, point);
        DropFlickers(side, point);
      }
    }
    return std::move(labels_);
  }

 private:
  void TakeVelocities() {
    const int window =
        std::max(1, static_cast<int>(std::lround(thresholds_.speed_window_s /
                                                 frame_time_s_)));
    const int half = std::max(1, window / 2);
    const int count = static_cast<int>(frames_.size());
    velocities_.resize(frames_.size());
    for (int f = 0; f < count; ++f) {
      const int from = std::max(0, f - half);
      const int to = std::min(count - 1, f + half);
      const double scale = 1 / ((to - from) * frame_time_s_ * size_);
      for (int side = 0; side < 2; ++side) {
        for (int point = 0; point < kFootPointCount; ++point) {
          velocities_[f][side][point] =
              (frames_[to][side][point] - frames_[from][side][point]) * scale;
        }
      }
    }
  }

  double HeightOf(size_t frame, int side, int point) const {
    const Eigen::Vector3d& at = frames_[frame][side][point];
    const double ground =
        ground_ != nullptr ? ground_->HeightAt(at) : labels_.floor_m;
    return at.y() - feet_.planted_heights[side][point] - ground;
  }

  // Heights of points, of the slow ones only or of all.
  std::vector<double> Heights(bool slow_only) const {
    std::vector<double> heights;
    for (size_t f = 0; f < frames_.size(); ++f) {
      for (int side = 0; side < 2; ++side) {
        for (int point = 0; point < kFootPointCount; ++point) {
          if (slow_only &&
              velocities_[f][side][point].norm() >= kFloorMaxSpeed) {
            continue;
          }
          heights.push_back(HeightOf(f, side, point));
        }
      }
    }
    return heights;
  }

  void FindFloor() {
    std::vector<double> heights = Heights(true);
    if (heights.size() < kMinFloorSamples) heights = Heights(false);
    const double highest =
        Quantile(heights, kLowestQuantile) + kFloorBand * size_;
    std::erase_if(heights, [highest](double h) { return h >= highest; });
    labels_.floor_m = Quantile(std::move(heights), 0.5);

    for (int side = 0; side < 2; ++side) {
      for (int point = 0; point < kFootPointCount; ++point) {
        std::vector<double> near_floor;
        for (size_t f = 0; f < frames_.size(); ++f) {
          if (velocities_[f][side][point].norm() >= kFloorMaxSpeed) continue;
          const double height = HeightOf(f, side, point);
          if (std::abs(height) < kFloorBand * size_) {
            near_floor.push_back(height);
          }
        }
        if (near_floor.size() < kMinBiasSamples) continue;
        const double most = kMaxFloorBias * size_;
        labels_.bias_m[side][point] = std::clamp(
            Quantile(std::move(near_floor), kBiasQuantile), -most, most);
      }
    }
  }

  Contact& At(int frame, int side, int point) {
    return labels_.frames[frame][side][point];
  }

  // Calls `change(first, end)` for every run of frames that are in contact or
  // not, as asked.
  template <typename Change>
  void ForRuns(int side, int point, bool in_contact, const Change& change) {
    const int count = static_cast<int>(frames_.size());
    const auto is_on = [&](int f) {
      return At(f, side, point) != Contact::kNone;
    };
    for (int first = 0; first < count;) {
      int end = first + 1;
      while (end < count && is_on(end) == is_on(first)) ++end;
      if (is_on(first) == in_contact) change(first, end);
      first = end;
    }
  }

  int Frames(double time_s) const {
    return static_cast<int>(std::lround(time_s / frame_time_s_));
  }

  void FillGaps(int side, int point) {
    const int count = static_cast<int>(frames_.size());
    ForRuns(side, point, false, [&](int first, int end) {
      if (first == 0 || end == count || end - first > Frames(kMaxGap_s)) return;
      for (int f = first; f < end; ++f) {
        At(f, side, point) = At(first - 1, side, point);
      }
    });
  }

  void DropFlickers(int side, int point) {
    ForRuns(side, point, true, [&](int first, int end) {
      if (end - first > Frames(kMinContact_s)) return;
      for (int f = first; f < end; ++f) At(f, side, point) = Contact::kNone;
    });
  }

  absl::Span<const FootPoints> frames_;
  double frame_time_s_;
  const FeetGeometry& feet_;
  const Ground* ground_;
  const ContactThresholds& thresholds_;
  double size_;
  std::vector<PerFootPoint<Eigen::Vector3d>> velocities_;
  ContactLabels labels_;
};

}  // namespace

double ContactLabels::ContactRatio() const {
  size_t on = 0;
  for (const FootContacts& frame : frames) {
    for (const auto& foot : frame) {
      on += foot[kHeel] != Contact::kNone;
      on += foot[kBall] != Contact::kNone;
    }
  }
  return frames.empty() ? 0
                        : static_cast<double>(on) /
                              (4 * static_cast<double>(frames.size()));
}

ContactLabels LabelContacts(absl::Span<const FootPoints> frames,
                            double frame_time_s, const FeetGeometry& feet,
                            const Ground* ground,
                            const ContactThresholds& thresholds) {
  return ContactLabeller(frames, frame_time_s, feet, ground, thresholds)
      .Label();
}

}  // namespace gelenk

#include "gelenk/retarget/foot_plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gelenk/math/rotation.h"

namespace gelenk {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

// Corrections fade out and in within this time, s.
constexpr double kFadeTime_s = 0.15;
// A contact whose foot wants to be farther than this from its mean place is
// two, m.
constexpr double kMaxDrift = 0.1;
constexpr double kNoLength = 1e-9;
constexpr int kNoContact = -1;

// From 0 to 1 with two continuous derivatives.
double SmoothStep(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (x * (6 * x - 15) + 10);
}

// How much of the corrections before and after a gap count in it.
struct Fade {
  double before;
  double after;
};

// At `frame` of the gap [first, end) in a clip of `count` frames.
Fade FadeAt(int frame, int first, int end, int count, double frame_time_s) {
  const double since = (frame - first + 1) * frame_time_s;
  const double until = (end - frame) * frame_time_s;
  const double gap = (end - first + 1) * frame_time_s;
  const bool has_before = first > 0;
  const bool has_after = end < count;
  if (has_before && has_after && gap < 2 * kFadeTime_s) {
    const double part = SmoothStep(since / gap);
    return {1 - part, part};
  }
  const double time = std::min(kFadeTime_s, gap);
  return {has_before ? 1 - SmoothStep(since / time) : 0,
          has_after ? 1 - SmoothStep(until / time) : 0};
}

// Calls `fill(first, end)` for every run of frames that are not `known`.
template <typename Fill>
void ForGaps(const std::vector<char>& known, const Fill& fill) {
  const int count = static_cast<int>(known.size());
  for (int first = 0; first < count;) {
    if (known[first]) {
      ++first;
      continue;
    }
    int end = first;
    while (end < count && !known[end]) ++end;
    fill(first, end);
    first = end;
  }
}

// One point that stands from `first` to before `end`.
struct Standing {
  int point;
  int first;
  int end;
  Vector3d place;
};

class FootPlanMaker {
 public:
  FootPlanMaker(const FootOnGround& foot, double size, double frame_time_s,
                absl::Span<const FootPose> goals,
                absl::Span<const std::array<Contact, kFootPointCount>> contacts)
      : foot_(foot),
        size_(size),
        frame_time_s_(frame_time_s),
        goals_(goals),
        contacts_(contacts),
        count_(static_cast<int>(goals.size())) {}

  PlannedFoot Plan(absl::Span<const Quaterniond> toes) {
    for (int point : {kHeel, kBall}) FindStandings(point);
    std::sort(
        standings_.begin(), standings_.end(),
        [](const Standing& a, const Standing& b) { return a.first < b.first; });
    RelateStandings();
    TurnFeet();
    MoveFeet();
    PlanToes(toes);
    return std::move(plan_);
  }

 private:
  const Vector3d& PointOf(int point) const {
    return point == kHeel ? foot_.shape.heel : foot_.shape.ball;
  }

  void FindStandings(int point) {
    for (int f = 0; f < count_;) {
      if (contacts_[f][point] != Contact::kPlanted) {
        ++f;
        continue;
      }
      Standing standing = {point, f, f, goals_[f] * PointOf(point)};
      int samples = 1;
      for (++f; f < count_ && contacts_[f][point] == Contact::kPlanted; ++f) {
        const Vector3d at = goals_[f] * PointOf(point);
        if (Horizontal(at - standing.place).norm() > kMaxDrift * size_) break;
        ++samples;
        standing.place += (at - standing.place) / samples;
      }
      standing.end = f;
      standing.place.y() = foot_.PlantedHeight(point, standing.place);
      standings_.push_back(standing);
    }
  }

  // Notes which standing holds each point at each frame, and keeps heel and
  // ball that stand together as far apart as they are.
  void RelateStandings() {
    for (auto& held : held_) held.assign(count_, kNoContact);
    for (size_t i = 0; i < standings_.size(); ++i) {
      Standing& standing = standings_[i];
      for (int f = standing.first; f < standing.end; ++f) {
        held_[standing.point][f] = static_cast<int>(i);
      }
      const int other_point = standing.point == kHeel ? kBall : kHeel;
      int other = kNoContact;
      for (int f = standing.first; f < standing.end && other < 0; ++f) {
        other = held_[other_point][f];
      }
      if (other >= 0) PutBeside(standings_[other], standing);
    }
  }

  void PutBeside(const Standing& anchor, Standing& standing) const {
    const Vector3d arm = PointOf(standing.point) - PointOf(anchor.point);
    Vector3d direction = Vector3d::Zero();
    const int first = std::max(anchor.first, standing.first);
    const int end = std::min(anchor.end, standing.end);
    for (int f = first; f < end; ++f) {
      direction += goals_[f].orientation * arm;
    }
    direction = Horizontal(direction);
    if (direction.norm() < kNoLength) {
      direction = Horizontal(standing.place - anchor.place);
    }
    if (direction.norm() < kNoLength) return;
    const double rise = foot_.planted_heights[standing.point] -
                        foot_.planted_heights[anchor.point];
    const double ahead =
        std::sqrt(std::max(0.0, arm.squaredNorm() - rise * rise));
    standing.place = anchor.place + ahead * direction.normalized();
    standing.place.y() = foot_.PlantedHeight(standing.point, standing.place);
  }

  bool Holds(int point, int frame) const { return held_[point][frame] >= 0; }
  const Vector3d& PlaceOf(int point, int frame) const {
    return standings_[held_[point][frame]].place;
  }

  void TurnFeet() {
    turned_.assign(count_, Quaterniond::Identity());
    std::vector<char> known(count_, false);
    const Vector3d arm = PointOf(kBall) - PointOf(kHeel);
    for (int f = 0; f < count_; ++f) {
      if (!Holds(kHeel, f) || !Holds(kBall, f)) continue;
      const Vector3d wanted = PlaceOf(kBall, f) - PlaceOf(kHeel, f);
      if (wanted.norm() < kNoLength || arm.norm() < kNoLength) continue;
      turned_[f] = ShortestRotation((goals_[f].orientation * arm).normalized(),
                                    wanted.normalized());
      known[f] = true;
    }
    ForGaps(known, [&](int first, int end) {
      const Quaterniond before =
          first > 0 ? turned_[first - 1] : Quaterniond::Identity();
      const Quaterniond after =
          end < count_ ? turned_[end] : Quaterniond::Identity();
      for (int f = first; f < end; ++f) {
        const Fade fade = FadeAt(f, first, end, count_, frame_time_s_);
        turned_[f] = Quaterniond::Identity().slerp(fade.after, after) *
                     Quaterniond::Identity().slerp(fade.before, before);
      }
    });
  }

  void MoveFeet() {
    plan_.feet.resize(count_);
    std::vector<Vector3d> moved(count_, Vector3d::Zero());
    std::vector<char> known(count_, false);
    for (int f = 0; f < count_; ++f) {
      FootPose& pose = plan_.feet[f];
      pose.orientation = (turned_[f] * goals_[f].orientation).normalized();
      const bool heel = Holds(kHeel, f);
      const bool ball = Holds(kBall, f);
      if (!heel && !ball) continue;
      const int point = heel ? kHeel : kBall;
      pose.ankle = PlaceOf(point, f) - pose.orientation * PointOf(point);
      if (!heel || !ball) LiftFoot(foot_, point, pose);
      moved[f] = pose.ankle - goals_[f].ankle;
      known[f] = true;
    }
    ForGaps(known, [&](int first, int end) {
      const Vector3d before = first > 0 ? moved[first - 1] : Vector3d::Zero();
      const Vector3d after = end < count_ ? moved[end] : Vector3d::Zero();
      for (int f = first; f < end; ++f) {
        const Fade fade = FadeAt(f, first, end, count_, frame_time_s_);
        plan_.feet[f].ankle =
            goals_[f].ankle + fade.before * before + fade.after * after;
        LiftFoot(foot_, kNothingLocked, plan_.feet[f]);
      }
    });
  }

  void PlanToes(absl::Span<const Quaterniond> toes) {
    ToePlanter planter(foot_);
    for (int f = 0; f < count_; ++f) {
      FootPose& pose = plan_.feet[f];
      const Quaterniond turned =
          pose.orientation * goals_[f].orientation.conjugate();
      plan_.toes.push_back(
          planter.Plant({turned, Holds(kBall, f), Holds(kHeel, f)}, toes[f],
                        contacts_[f][kTip], frame_time_s_, pose));
    }
  }

  const FootOnGround& foot_;
  double size_;
  double frame_time_s_;
  absl::Span<const FootPose> goals_;
  absl::Span<const std::array<Contact, kFootPointCount>> contacts_;
  int count_;
  std::vector<Standing> standings_;
  // Of heel and ball, the standing that holds it at each frame.
  std::array<std::vector<int>, 2> held_;
  std::vector<Quaterniond> turned_;
  PlannedFoot plan_;
};

}  // namespace

PlannedFoot PlanFoot(
    const FootOnGround& foot, double size, double frame_time_s,
    absl::Span<const FootPose> goals, absl::Span<const Quaterniond> toes,
    absl::Span<const std::array<Contact, kFootPointCount>> contacts) {
  return FootPlanMaker(foot, size, frame_time_s, goals, contacts).Plan(toes);
}

}  // namespace gelenk

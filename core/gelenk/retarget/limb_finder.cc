#include "gelenk/retarget/limb_finder.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numeric>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/string_view.h"

namespace gelenk {
namespace {

// Each bone of a limb is at least this part of it.
constexpr double kMinBone = 0.2;

// How the bones of people relate, and how much weight the length has that a
// pair leaves over: clavicles are long, hips are not.
struct Proportions {
  double lower_by_upper;
  double left_over_weight;
};
constexpr Proportions kLegProportions = {0.98, 0.6};
constexpr Proportions kArmProportions = {0.93, 0.3};

constexpr double kSkippedJointScore = 0.3;
// A ball on the straight line between its neighbours may share a bone's twist.
constexpr double kStraightJointScore = 0.1;
// Nearer than this part of its length to the trunk's joint a limb does not
// begin: hips and shoulders are beside it, what is there is a helper.
constexpr double kMinBeside = 0.02;
constexpr double kNotBesideScore = 0.3;
// How much longer the way over a joint is than the straight one, of the whole.
constexpr double kMaxDetour = 1e-3;
// Of equal pairs that nearer to the end.
constexpr double kChainLengthScore = 0.001;
constexpr double kLastHingeScore = 1e-4;

// Letters and digits of the name behind its scope, in small letters: "lowerarm"
// for "DEF-lower_arm".
std::string PlainName(absl::string_view name) {
  const size_t scope = name.find_last_of(":|");
  if (scope != absl::string_view::npos) name.remove_prefix(scope + 1);
  std::string plain;
  for (char c : name) {
    if (absl::ascii_isalnum(c)) plain += absl::ascii_tolower(c);
  }
  return plain;
}

bool HasAny(absl::string_view name,
            std::initializer_list<absl::string_view> words) {
  return std::any_of(words.begin(), words.end(), [name](auto word) {
    return absl::StrContains(name, word);
  });
}

bool IsForearm(absl::string_view name) {
  return HasAny(name, {"forearm", "lowerarm", "lowarm", "elbow"});
}

// `next` is the joint below the upper one.
double ArmNameScore(absl::string_view upper, absl::string_view next,
                    absl::string_view middle) {
  double score = 0;
  if (HasAny(upper, {"collar", "clav"})) score += 0.8;
  if (HasAny(upper, {"shoulder"}) && HasAny(next, {"arm"}) &&
      !HasAny(next, {"shoulder"}) && !IsForearm(next)) {
    score += 0.8;
  }
  if (HasAny(upper, {"upperarm", "uparm", "shldr"})) score -= 0.15;
  if (IsForearm(middle)) score -= 0.3;
  // Robots have several joints at a shoulder and at a wrist.
  if (IsForearm(upper) || HasAny(middle, {"wrist", "shoulder"})) score += 0.5;
  return score;
}

double LegNameScore(absl::string_view upper, absl::string_view middle) {
  double score = 0;
  if (HasAny(upper, {"buttock", "hipjoint"})) score += 0.5;
  if (HasAny(upper, {"upleg", "upperleg", "thigh"})) score -= 0.1;
  if (HasAny(middle, {"knee", "shin", "calf", "lowerleg", "lowleg"})) {
    score -= 0.3;
  }
  if (HasAny(upper, {"knee"}) || HasAny(middle, {"ankle"})) score += 0.5;
  return score;
}

// A helper that shares a limb's twist; the rolls of robots are joints like
// others.
bool IsTwist(const Skeleton& skeleton, int joint, absl::string_view name) {
  return VelocityCount(skeleton.joint(joint).type) > 1 &&
         HasAny(name, {"twist", "roll"});
}

double LengthOf(absl::Span<const Eigen::Vector3d> points,
                absl::Span<const int> chain, size_t from, size_t to) {
  double length = 0;
  for (size_t i = from; i < to; ++i) {
    length += (points[chain[i + 1]] - points[chain[i]]).norm();
  }
  return length;
}

bool IsStraight(const Skeleton& skeleton,
                absl::Span<const Eigen::Vector3d> points,
                absl::Span<const int> chain, size_t i) {
  if (VelocityCount(skeleton.joint(chain[i]).type) == 1) return false;
  const double before = (points[chain[i]] - points[chain[i - 1]]).norm();
  const double behind = (points[chain[i + 1]] - points[chain[i]]).norm();
  const double straight = (points[chain[i + 1]] - points[chain[i - 1]]).norm();
  return before > 0 && behind > 0 &&
         before + behind - straight <= kMaxDetour * straight;
}

}  // namespace

std::vector<int> ChainBelow(const Skeleton& skeleton, int top, int end) {
  std::vector<int> chain;
  int joint = end;
  for (; joint >= 0 && joint != top; joint = skeleton.span(joint).parent) {
    chain.push_back(joint);
  }
  if (joint != top) return {};
  std::reverse(chain.begin(), chain.end());
  return chain;
}

std::optional<LimbJoints> FindLimb(const Skeleton& skeleton,
                                   absl::Span<const Eigen::Vector3d> points,
                                   int top, int end, LimbKind kind) {
  const std::vector<int> chain = ChainBelow(skeleton, top, end);
  if (chain.size() < 3) return std::nullopt;
  const size_t last = chain.size() - 1;
  std::vector<std::string> names;
  for (int joint : chain) {
    names.push_back(PlainName(skeleton.joint(joint).id));
  }
  const Proportions& proportions =
      kind == LimbKind::kLeg ? kLegProportions : kArmProportions;
  const double total = LengthOf(points, chain, 0, last);
  if (!(total > 0)) return std::nullopt;

  // What leaving a joint out of the limb costs.
  std::vector<double> skipped(chain.size(), kSkippedJointScore);
  for (size_t i = 1; i < last; ++i) {
    if (IsTwist(skeleton, chain[i], names[i])) {
      skipped[i] = 0;
    } else if (IsStraight(skeleton, points, chain, i)) {
      skipped[i] = kStraightJointScore;
    }
  }
  LimbJoints best;
  best.score = kMaxLimbScore;
  for (size_t i = 0; i + 1 < last; ++i) {
    for (size_t k = i + 1; k < last; ++k) {
      const double upper = LengthOf(points, chain, i, k);
      const double lower = LengthOf(points, chain, k, last);
      if (upper < kMinBone * total || lower < kMinBone * total) continue;
      double score =
          std::abs(std::log(upper / lower * proportions.lower_by_upper)) +
          proportions.left_over_weight * (total - upper - lower) / total +
          std::accumulate(skipped.begin() + i + 1, skipped.begin() + last,
                          -skipped[k]) +
          kChainLengthScore * static_cast<double>(last - i);
      score += kind == LimbKind::kLeg
                   ? LegNameScore(names[i], names[k])
                   : ArmNameScore(names[i], names[i + 1], names[k]);
      if ((points[chain[i]] - points[top]).norm() < kMinBeside * total) {
        score += kNotBesideScore;
      }
      // Of several hinges at one place the last one moves the bone.
      if (VelocityCount(skeleton.joint(chain[k]).type) == 1) {
        score -= kLastHingeScore * static_cast<double>(k);
      }
      if (IsTwist(skeleton, chain[i], names[i]) ||
          IsTwist(skeleton, chain[k], names[k])) {
        score += 1;
      }
      if (score < best.score) best = {chain[i], chain[k], score};
    }
  }
  if (best.upper < 0) return std::nullopt;
  return best;
}

}  // namespace gelenk

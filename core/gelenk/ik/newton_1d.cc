#include "gelenk/ik/newton_1d.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/number_check.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

using Bracket = Newton1dOptions::Bracket;

// A million samples of a cheap function take a few ms.
constexpr int kMaxSamples = 1000000;

absl::Status Check(const Newton1dOptions& options) {
  Violations violations;
  CheckNumber("start", options.start, violations);
  if (options.bracket && !(std::isfinite(options.bracket->lower) &&
                           std::isfinite(options.bracket->upper) &&
                           options.bracket->lower < options.bracket->upper)) {
    violations.Add(
        "bracket",
        absl::StrFormat("want finite numbers, lower < upper, got %g "
                        "and %g",
                        options.bracket->lower, options.bracket->upper));
  }
  if (options.sample_count < 2 || options.sample_count > kMaxSamples) {
    violations.Add("sample_count",
                   absl::StrFormat("want 2 to %d, got %d", kMaxSamples,
                                   options.sample_count));
  }
  if (options.max_iterations < 0) {
    violations.Add("max_iterations",
                   absl::StrCat("want >= 0, got ", options.max_iterations));
  }
  CheckPositive("tolerance", options.tolerance, violations);
  CheckPositive("difference_step", options.difference_step, violations);
  return violations.ToStatus();
}

// The pieces between samples in which the sign changes. A sample that is zero
// counts once.
std::vector<Bracket> SignChanges(const ScalarFunction& function,
                                 const Newton1dOptions& options) {
  std::vector<Bracket> pieces;
  const Bracket& all = *options.bracket;
  double last_x = all.lower;
  double last_f = function(last_x);
  if (last_f == 0) pieces.push_back({last_x, last_x});
  for (int i = 1; i < options.sample_count; ++i) {
    const double share = static_cast<double>(i) / (options.sample_count - 1);
    const double x = all.lower + share * (all.upper - all.lower);
    const double f = function(x);
    if (f == 0) {
      pieces.push_back({x, x});
    } else if (last_f != 0 && std::signbit(f) != std::signbit(last_f)) {
      pieces.push_back({last_x, x});
    }
    last_x = x;
    last_f = f;
  }
  return pieces;
}

}  // namespace

absl::StatusOr<Newton1dResult> FindZero(const ScalarFunction& function,
                                        const ScalarFunction& derivative,
                                        const Newton1dOptions& options) {
  if (absl::Status status = Check(options); !status.ok()) return status;
  Newton1dResult result;
  double x = options.start;
  std::optional<Bracket> piece;
  double f_lower = 0;
  if (options.bracket) {
    x = std::clamp(x, options.bracket->lower, options.bracket->upper);
    const std::vector<Bracket> pieces = SignChanges(function, options);
    for (const Bracket& p : pieces) {
      result.seen_zeros.push_back(0.5 * (p.lower + p.upper));
    }
    result.zero_count = pieces.empty()       ? ZeroCount::kNone
                        : pieces.size() == 1 ? ZeroCount::kOne
                                             : ZeroCount::kMany;
    const auto away = [x](const Bracket& p) {
      return std::abs(x - std::clamp(x, p.lower, p.upper));
    };
    const auto nearest = std::min_element(
        pieces.begin(), pieces.end(),
        [&](const Bracket& a, const Bracket& b) { return away(a) < away(b); });
    if (nearest != pieces.end()) {
      piece = *nearest;
      f_lower = function(piece->lower);
    }
  }
  for (int iteration = 0;; ++iteration) {
    const double f = function(x);
    result.x = x;
    result.f = f;
    if (!std::isfinite(f)) return result;
    if (std::abs(f) <= options.tolerance) {
      result.converged = true;
      return result;
    }
    if (iteration >= options.max_iterations) return result;
    const double slope = derivative
                             ? derivative(x)
                             : (function(x + options.difference_step) - f) /
                                   options.difference_step;
    result.tangents.push_back({x, f, slope});
    const bool inside = piece && x >= piece->lower && x <= piece->upper;
    if (inside) {
      // Keep the half in which the sign changes.
      if (std::signbit(f) == std::signbit(f_lower)) {
        piece->lower = x;
        f_lower = f;
      } else {
        piece->upper = x;
      }
    }
    const double next = x - f / slope;
    const bool usable = slope != 0 && std::isfinite(next);
    if (piece) {
      const bool stays = usable && next >= piece->lower && next <= piece->upper;
      x = stays ? next : 0.5 * (piece->lower + piece->upper);
    } else if (usable) {
      x = options.bracket
              ? std::clamp(next, options.bracket->lower, options.bracket->upper)
              : next;
    } else {
      result.singular = true;
      return result;
    }
  }
}

}  // namespace gelenk

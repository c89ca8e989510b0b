#include "client/cli/picture/outcome_strip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/picture/style.h"
#include "client/cli/text/format.h"

namespace gelenk::cli {
namespace {

struct Kind {
  absl::string_view name;
  absl::string_view fill;
};

// From good to bad; a frame without an answer is the worst.
constexpr int kKinds = 5;
Kind KindOf(int badness) {
  switch (badness) {
    case 0:
      return {"converged", OutcomeClass(SolveOutcome::kConverged)};
    case 1:
      return {"stalled at limits",
              OutcomeClass(SolveOutcome::kStalledAtLimits)};
    case 2:
      return {"unreachable", OutcomeClass(SolveOutcome::kUnreachable)};
    case 3:
      return {"iteration limit", OutcomeClass(SolveOutcome::kIterationLimit)};
    default:
      return {"no answer", kUnansweredClass};
  }
}

int Badness(const Answer& answer) {
  if (!answer.answered) return kKinds - 1;
  switch (answer.outcome) {
    case SolveOutcome::kConverged:
      return 0;
    case SolveOutcome::kStalledAtLimits:
      return 1;
    case SolveOutcome::kUnreachable:
      return 2;
    case SolveOutcome::kIterationLimit:
    case SolveOutcome::kTimeLimit:
    case SolveOutcome::kSingular:
      return 3;
  }
  return kKinds - 1;
}

}  // namespace

void DrawOutcomeStrip(const Playback& playback, const Box& box, Svg& svg) {
  const int frames = playback.frame_count();
  const int columns = std::min<int>(frames, std::lround(box.width));
  std::vector<int> worst(columns, 0);
  for (int i = 0; i < frames; ++i) {
    int& column = worst[static_cast<int64_t>(i) * columns / frames];
    column = std::max(column, Badness(playback.answers[i]));
  }
  svg.OpenGroup("outcomes");
  for (int begin = 0; begin < columns;) {
    int end = begin;
    while (end < columns && worst[end] == worst[begin]) ++end;
    const double width = box.width / columns;
    svg.Rectangle(
        {box.left + begin * width, box.top, (end - begin) * width, box.height},
        0, KindOf(worst[begin]).fill);
    begin = end;
  }
  svg.CloseGroup();
}

void DrawOutcomeKey(const Playback& playback, const Point& at, Svg& svg) {
  std::array<int, kKinds> counts = {};
  for (const Answer& answer : playback.answers) ++counts[Badness(answer)];
  double x = at.x();
  for (int badness = 0; badness < kKinds; ++badness) {
    if (counts[badness] == 0) continue;
    const Kind kind = KindOf(badness);
    const std::string label = absl::StrCat(
        kind.name, " ", Percent(counts[badness], playback.frame_count()));
    svg.Rectangle({x, at.y() - 10, 11, 11}, 2, kind.fill);
    svg.Text({x + 17, at.y()}, label, "");
    x += 17 + 7.0 * label.size() + 18;
  }
}

}  // namespace gelenk::cli

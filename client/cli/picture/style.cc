#include "client/cli/picture/style.h"

namespace gelenk::cli {

absl::string_view PictureStyle() {
  return R"css(
text { font-family: system-ui, "Segoe UI", "Helvetica Neue", Arial, sans-serif;
  font-size: 12px; fill: #5b6470; }
line, polyline { fill: none; stroke-linecap: round; stroke-linejoin: round; }
.paper { fill: #fcfcfb; }
.panel { fill: #f3f4f4; }
.title { font-size: 22px; font-weight: 600; fill: #1d2126; }
.heading { font-size: 13px; font-weight: 600; fill: #353c45; }
.middle { text-anchor: middle; }
.end { text-anchor: end; }
.grid { stroke: #dcdfe2; stroke-width: 1; }
.ground { stroke: #b4bac1; stroke-width: 1.2; }
.bone { stroke-width: 3.2; }
.trunk { stroke: #4a525c; }
.left { stroke: #2f6fb5; }
.right { stroke: #d2691e; }
.thin { stroke-width: 1.4; }
.pale { stroke: #c3c8ce; }
.earth { fill: #e4e2dd; }
.slide { stroke: #d11f1f; stroke-width: 3; }
.slide-end, .contact { fill: #d11f1f; }
.turning { fill: none; stroke: #d11f1f; stroke-width: 1.2; }
.left-fill { fill: #2f6fb5; }
.right-fill { fill: #d2691e; }
.ghost { stroke: #c9cdd2; stroke-width: 5; }
.target { fill: none; stroke: #b0378a; stroke-width: 1.4; }
.effector { fill: #b0378a; }
.residual { stroke: #d11f1f; stroke-width: 1.6; }
.path-target { stroke: #c3c8ce; stroke-width: 6; }
.path { stroke: #2f6fb5; stroke-width: 1.6; }
.path-start { fill: #3a9a6e; }
.path-end { fill: #2f6fb5; }
.curve { stroke: #2f6fb5; stroke-width: 1.2; }
.tolerance { stroke: #b0378a; stroke-width: 1.2; stroke-dasharray: 5 4; }
.tolerance-label { fill: #b0378a; }
.converged { fill: #3a9a6e; }
.stalled { fill: #e0a02f; }
.unreachable { fill: #d9622b; }
.exhausted { fill: #b3262e; }
.unanswered { fill: #b9bec6; }
.shade1 { fill: #d6e4f3; }
.shade2 { fill: #abc9e7; }
.shade3 { fill: #7dabd9; }
.shade4 { fill: #518ac6; }
.shade5 { fill: #2f68a8; }
.shade6 { fill: #194a82; }
@media (prefers-color-scheme: dark) {
  text { fill: #a3acb8; }
  .paper { fill: #16191d; }
  .panel { fill: #1f2329; }
  .title { fill: #f0f2f4; }
  .heading { fill: #d5dae0; }
  .grid { stroke: #343a42; }
  .ground { stroke: #59626d; }
  .trunk { stroke: #c0c7cf; }
  .left, .path, .curve { stroke: #6ba6e8; }
  .right { stroke: #f0954f; }
  .ghost, .path-target { stroke: #3c434c; }
  .pale { stroke: #3c434c; }
  .earth { fill: #2a2825; }
  .slide { stroke: #ff6b6b; }
  .slide-end, .contact { fill: #ff6b6b; }
  .turning { stroke: #ff6b6b; }
  .left-fill { fill: #6ba6e8; }
  .right-fill { fill: #f0954f; }
  .target, .tolerance { stroke: #e477c1; }
  .effector, .tolerance-label { fill: #e477c1; }
  .residual { stroke: #ff6b6b; }
  .path-end { fill: #6ba6e8; }
  .unanswered { fill: #5d6570; }
}
)css";
}

absl::string_view OutcomeClass(SolveOutcome outcome) {
  switch (outcome) {
    case SolveOutcome::kConverged:
      return "converged";
    case SolveOutcome::kStalledAtLimits:
      return "stalled";
    case SolveOutcome::kUnreachable:
      return "unreachable";
    case SolveOutcome::kIterationLimit:
    case SolveOutcome::kTimeLimit:
    case SolveOutcome::kSingular:
      return "exhausted";
  }
  return kUnansweredClass;
}

}  // namespace gelenk::cli

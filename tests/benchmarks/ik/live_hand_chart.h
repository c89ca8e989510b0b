// What two solvers make of the same hand, as curves over time.
#ifndef GELENK_TESTS_BENCHMARKS_IK_LIVE_HAND_CHART_H_
#define GELENK_TESTS_BENCHMARKS_IK_LIVE_HAND_CHART_H_

#include <string>
#include <vector>

namespace gelenk::benchmarks {

// One a frame.
struct HandRun {
  // The largest move of a degree of freedom, rad.
  std::vector<double> steps_rad;
  // From the tip to the target, m.
  std::vector<double> distances_m;
};

struct HandFigures {
  std::string name;
  HandRun ours;
  HandRun other;
};

struct LiveHandLegend {
  double frames_per_second = 72;
  double max_step_rad = 0.1;
  // Who the other is.
  std::string other;
};

// An SVG: a column a hand, above the joints' steps, below the distances, on
// logarithmic scales.
std::string LiveHandChart(const std::vector<HandFigures>& hands,
                          const LiveHandLegend& legend);

}  // namespace gelenk::benchmarks

#endif  // GELENK_TESTS_BENCHMARKS_IK_LIVE_HAND_CHART_H_

// Mean times of solvers as bars on a logarithmic axis.
#ifndef TESTS_BENCHMARKS_IK_PEERS_CHART_H_
#define TESTS_BENCHMARKS_IK_PEERS_CHART_H_

#include <string>
#include <vector>

#include "client/cli/bench/ik_run.h"

namespace gelenk::benchmarks {

struct PeerFigures {
  std::string arm;
  std::string start;
  std::string solver;
  cli::IkFigures figures;
};

// SVG. Rows of one arm and start stand together.
std::string PeersChart(const std::vector<PeerFigures>& rows);

}  // namespace gelenk::benchmarks

#endif  // TESTS_BENCHMARKS_IK_PEERS_CHART_H_

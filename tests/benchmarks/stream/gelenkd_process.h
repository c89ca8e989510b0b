// A gelenkd on loopback, with sessions to measure.
#ifndef GELENK_TESTS_BENCHMARKS_STREAM_GELENKD_PROCESS_H_
#define GELENK_TESTS_BENCHMARKS_STREAM_GELENKD_PROCESS_H_

#include <grpcpp/channel.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/benchmarks/problems.h"
#include "tests/benchmarks/stream/child_process.h"

namespace gelenk::benchmarks {

class GelenkdProcess {
 public:
  // Starts it with these flags on a free port, and waits until it listens.
  explicit GelenkdProcess(const std::vector<std::string>& flags);

  const ChildProcess& process() const { return process_; }
  // HOST:PORT.
  const std::string& address() const { return address_; }

 private:
  std::string port_file_;
  ChildProcess process_;
  std::string address_;
};

// Stores the problem's skeleton as skeletons/benchmark; ends the program where
// that fails.
void CreateSkeleton(const StreamProblem& problem,
                    const std::shared_ptr<grpc::Channel>& channel);

// Opens sessions/benchmark-FIRST and so on, `count` of them, on that skeleton;
// ends the program where that fails.
void CreateSessions(const StreamProblem& problem, int first, int count,
                    const std::shared_ptr<grpc::Channel>& channel);

}  // namespace gelenk::benchmarks

#endif  // GELENK_TESTS_BENCHMARKS_STREAM_GELENKD_PROCESS_H_

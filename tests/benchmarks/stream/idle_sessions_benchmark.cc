// What a session costs gelenkd while nobody drives it: growth of the process's
// resident memory, transport and allocator included, beside the shared body.
#include <grpcpp/grpcpp.h>

#include <cstdio>

#include "gelenk/v1/session_service.grpc.pb.h"
#include "tests/benchmarks/problems.h"
#include "tests/benchmarks/stream/gelenkd_process.h"

namespace gelenk::benchmarks {
namespace {

// Opened first, so that what the server sets up once is not counted.
constexpr int kWarmUp = 100;

int Main() {
  const StreamProblem body = BodyProblem(2);
  std::printf("idle sessions on a body of %zu joints with %zu goals\n",
              body.skeleton->joints().size(), body.goals.size());
  std::printf("%8s %14s %18s\n", "sessions", "resident MB", "bytes a session");
  GelenkdProcess server({"--max-sessions=20000"});
  const auto channel =
      grpc::CreateChannel(server.address(), grpc::InsecureChannelCredentials());
  CreateSkeleton(body, channel);
  CreateSessions(body, 0, kWarmUp, channel);
  const long before = server.process().resident_bytes();
  int opened = 0;
  for (const int count : {1000, 10000}) {
    CreateSessions(body, kWarmUp + opened, count - opened, channel);
    opened = count;
    const long after = server.process().resident_bytes();
    std::printf("%8d %14.1f %18ld\n", opened, 1e-6 * after,
                (after - before) / opened);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace gelenk::benchmarks

int main() { return gelenk::benchmarks::Main(); }

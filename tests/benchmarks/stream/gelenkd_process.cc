#include "tests/benchmarks/stream/gelenkd_process.h"

#include <grpcpp/grpcpp.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "convert/goal.h"
#include "convert/pose.h"
#include "convert/skeleton.h"
#include "gelenk/v1/kinematics_service.grpc.pb.h"
#include "gelenk/v1/session_service.grpc.pb.h"

namespace gelenk::benchmarks {
namespace {

std::vector<std::string> CommandLine(const std::string& port_file,
                                     const std::vector<std::string>& flags) {
  std::vector<std::string> line = {GELENKD, "--listen=127.0.0.1:0",
                                   "--port-file=" + port_file,
                                   "--log-level=error"};
  line.insert(line.end(), flags.begin(), flags.end());
  return line;
}

std::string NewPortFile() {
  std::string path = "/tmp/gelenk-benchmark-" + std::to_string(getpid());
  std::remove(path.c_str());
  return path;
}

void Check(const grpc::Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "%s\n", status.error_message().c_str());
  std::exit(1);
}

}  // namespace

GelenkdProcess::GelenkdProcess(const std::vector<std::string>& flags)
    : port_file_(NewPortFile()), process_(CommandLine(port_file_, flags)) {
  std::string port;
  while (!(std::ifstream(port_file_) >> port)) usleep(10000);
  std::remove(port_file_.c_str());
  address_ = "127.0.0.1:" + port;
}

void CreateSkeleton(const StreamProblem& problem,
                    const std::shared_ptr<grpc::Channel>& channel) {
  grpc::ClientContext context;
  v1::CreateSkeletonRequest request;
  request.set_skeleton_id("benchmark");
  convert::ToProto(*problem.skeleton, request.mutable_skeleton());
  v1::Skeleton skeleton;
  Check(v1::KinematicsService::NewStub(channel)->CreateSkeleton(
      &context, request, &skeleton));
}

void CreateSessions(const StreamProblem& problem, int first, int count,
                    const std::shared_ptr<grpc::Channel>& channel) {
  const auto stub = v1::SessionService::NewStub(channel);
  for (int i = first; i < first + count; ++i) {
    grpc::ClientContext context;
    v1::CreateSessionRequest request;
    request.set_session_id("benchmark-" + std::to_string(i));
    v1::Session* session = request.mutable_session();
    session->set_skeleton("skeletons/benchmark");
    convert::ToProto(problem.goals, session->mutable_goals());
    convert::ToProto(problem.start, session->mutable_pose());
    session->mutable_solver_options()->set_position_tolerance_m(1e-3);
    session->mutable_solver_options()->set_rotation_tolerance_rad(1e-2);
    v1::Session created;
    Check(stub->CreateSession(&context, request, &created));
  }
}

}  // namespace gelenk::benchmarks

// A server of the streaming contract whose solver is arithmetic and whose
// misfortunes are scripted.
//
// It keeps what a real one keeps (sessions, goals as their frames left them,
// the warm pose) and solves by a recurrence over all of it, so that one frame
// lost, doubled, or solved from another state changes every number after it.
#ifndef GELENK_TESTS_TESTING_FAKE_SESSION_SERVER_H_
#define GELENK_TESTS_TESTING_FAKE_SESSION_SERVER_H_

#include <grpcpp/server.h>
#include <grpcpp/server_context.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/ik/goal.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/v1/kinematics_service.grpc.pb.h"
#include "gelenk/v1/session_service.grpc.pb.h"

namespace gelenk::testing {

// What befalls a frame.
enum class Fate {
  kAnswer,
  kDropBefore,  // the stream breaks, the frame is not solved
  kDropAfter,   // it is solved, then the stream breaks before the answer
  kIgnore,      // solved, never answered; the stream lives
  kDrain,       // answered, after KIND_DRAINING
  kTakeOver,    // KIND_DETACHED with ABORTED instead of an answer
  kClose,       // KIND_CLOSING with RESOURCE_EXHAUSTED instead of an answer
  kAnswerTwice,
};

// Thread-safe.
class FakeSessionServer : private v1::KinematicsService::Service,
                          private v1::SessionService::Service {
 public:
  // Listens on a free port of the loopback device.
  FakeSessionServer();
  ~FakeSessionServer() override;

  std::string target() const;

  // As SIGKILL: connections break, everything is forgotten.
  void Stop();
  // On the same port again.
  void Start();

  // Decides about every frame that comes in; `count` is how many came before
  // it, of all streams and sessions. Called without a lock. Null answers all.
  using Script = std::function<Fate(const v1::TargetFrame& frame, int count)>;
  void SetScript(Script script);
  // Answers carry `continuation`, read by resume_from.
  void SetContinues(bool continues);
  // The next `count` attaches fail with `status`, inside the stream.
  void RefuseAttaches(int count, const absl::Status& status);
  // The next `count` unary calls fail.
  void RefuseCalls(int count, const absl::Status& status);
  void ForgetSession(const std::string& name);

  // --- What happened ---
  int attach_count() const;
  std::vector<v1::AttachSession> attaches() const;
  std::vector<v1::CreateSessionRequest> creates() const;
  int delete_count() const;
  // Those that were solved.
  std::vector<v1::TargetFrame> frames() const;
  // Metadata gelenk-session of every stream.
  std::vector<std::string> affinity_keys() const;

 private:
  struct FakeSession {
    v1::Session declared;
    std::vector<Goal> goals;
    RigidTransform world_from_skeleton;
    std::vector<double> positions;
    bool is_cold = true;
    int64_t sequence_number = 0;
  };
  struct Refusals {
    int count = 0;
    absl::Status status;
  };
  using Stream = grpc::ServerReaderWriter<v1::StreamingSolveResponse,
                                          v1::StreamingSolveRequest>;

  grpc::Status CreateSkeleton(grpc::ServerContext*,
                              const v1::CreateSkeletonRequest*,
                              v1::Skeleton*) override;
  grpc::Status GetSkeleton(grpc::ServerContext*, const v1::GetSkeletonRequest*,
                           v1::Skeleton*) override;
  grpc::Status CreateSession(grpc::ServerContext*,
                             const v1::CreateSessionRequest*,
                             v1::Session*) override;
  grpc::Status GetSession(grpc::ServerContext*, const v1::GetSessionRequest*,
                          v1::Session*) override;
  grpc::Status DeleteSession(grpc::ServerContext*,
                             const v1::DeleteSessionRequest*,
                             google::protobuf::Empty*) override;
  grpc::Status StreamingSolve(grpc::ServerContext* context,
                              Stream* stream) override;

  grpc::Status Refuse(Refusals* refusals);
  v1::StreamEvent Attach(const v1::AttachSession& attach,
                         std::map<int, std::string>* slots);
  absl::StatusOr<v1::PoseFrame> Solve(const std::string& name,
                                      const v1::TargetFrame& frame);
  absl::Status Apply(const v1::TargetFrame& frame, FakeSession* session);
  Fate FateOf(const v1::TargetFrame& frame);

  mutable std::mutex mutex_;
  int port_ = 0;
  Script script_;
  bool continues_ = true;
  Refusals attach_refusals_;
  Refusals call_refusals_;
  std::map<std::string, v1::Skeleton> skeletons_;
  std::map<std::string, FakeSession> sessions_;
  std::set<std::string> request_ids_;

  std::vector<v1::AttachSession> attaches_;
  std::vector<v1::CreateSessionRequest> creates_;
  std::vector<v1::TargetFrame> frames_;
  std::vector<std::string> affinity_keys_;
  int delete_count_ = 0;
  int frame_count_ = 0;

  std::unique_ptr<grpc::Server> server_;
};

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_FAKE_SESSION_SERVER_H_

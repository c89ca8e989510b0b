// The floor under a streaming server: reads a message, writes one of a given
// size, nothing else. One completion queue per thread, one read and one write
// under way per stream; what gelenkd is measured against.
//
// With BUSY_NS it spins that long before each answer, as a server does that has
// something to work out: messages then arrive, and are batched by the kernel
// and by gRPC, as they are for such a server.
//
//   bare_echo THREADS ANSWER_BYTES BUSY_NS
//                                  prints its port, ends on end of input
#include <grpcpp/grpcpp.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "stream/echo.grpc.pb.h"

namespace gelenk::benchmarks {
namespace {

using Clock = std::chrono::steady_clock;

void Spin(std::chrono::nanoseconds duration) {
  if (duration.count() == 0) return;
  const Clock::time_point end = Clock::now() + duration;
  while (Clock::now() < end) {
  }
}

class Tag {
 public:
  virtual ~Tag() = default;
  virtual void Run(bool ok) = 0;
};

class EchoStream {
 public:
  EchoStream(Echo::AsyncService* service, grpc::ServerCompletionQueue* queue,
             const std::string& answer, std::chrono::nanoseconds busy)
      : service_(service), queue_(queue), busy_(busy) {
    answer_.set_bytes(answer);
    service_->RequestStream(&context_, &stream_, queue_, queue_, &started_);
  }

 private:
  class Operation final : public Tag {
   public:
    Operation(EchoStream* stream, void (EchoStream::*run)(bool))
        : stream_(stream), run_(run) {}
    void Run(bool ok) override { (stream_->*run_)(ok); }

   private:
    EchoStream* stream_;
    void (EchoStream::*run_)(bool);
  };

  void OnStarted(bool ok) {
    if (!ok) return;
    new EchoStream(service_, queue_, answer_.bytes(), busy_);
    stream_.Read(&request_, &read_);
  }
  void OnRead(bool ok) {
    if (!ok) return;  // the process ends soon, nothing is given back
    has_request_ = true;
    Advance();
  }
  void OnWritten(bool) {
    writing_ = false;
    Advance();
  }
  // A client may have the answer before this side knows that it was written.
  void Advance() {
    if (!has_request_ || writing_) return;
    has_request_ = false;
    writing_ = true;
    Spin(busy_);
    stream_.Write(answer_, &written_);
    stream_.Read(&request_, &read_);
  }

  Echo::AsyncService* service_;
  grpc::ServerCompletionQueue* queue_;
  const std::chrono::nanoseconds busy_;
  grpc::ServerContext context_;
  grpc::ServerAsyncReaderWriter<Payload, Payload> stream_{&context_};
  Payload request_;
  Payload answer_;
  bool has_request_ = false;
  bool writing_ = false;
  Operation started_{this, &EchoStream::OnStarted};
  Operation read_{this, &EchoStream::OnRead};
  Operation written_{this, &EchoStream::OnWritten};
};

int Serve(int threads, size_t answer_bytes, std::chrono::nanoseconds busy) {
  const std::string answer(answer_bytes, 'x');
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(),
                           &port);
  Echo::AsyncService service;
  builder.RegisterService(&service);
  std::vector<std::unique_ptr<grpc::ServerCompletionQueue>> queues;
  for (int i = 0; i < threads; ++i) {
    queues.push_back(builder.AddCompletionQueue());
  }
  const std::unique_ptr<grpc::Server> server = builder.BuildAndStart();
  if (server == nullptr) return 1;
  for (const auto& queue : queues) {
    new EchoStream(&service, queue.get(), answer, busy);
    std::thread([queue = queue.get()] {
      void* tag;
      bool ok;
      while (queue->Next(&tag, &ok)) static_cast<Tag*>(tag)->Run(ok);
    }).detach();
  }
  std::printf("127.0.0.1:%d\n", port);
  std::fflush(stdout);
  while (std::getchar() != EOF) {
  }
  std::_Exit(0);
}

}  // namespace
}  // namespace gelenk::benchmarks

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  return gelenk::benchmarks::Serve(
      std::atoi(argv[1]), std::strtoul(argv[2], nullptr, 10),
      std::chrono::nanoseconds(std::strtol(argv[3], nullptr, 10)));
}

// What the server adds to a frame, besides the solve, against a bare echo that
// carries as many bytes both ways.
//
// An echo that is as busy before each answer as the solver is (and is measured
// without that) stands beside it: in a closed loop a server that answers at
// once gets its messages in larger bunches, which makes each one cheaper.
//
// All servers are measured in turn, several pairs, by the CPU time of their
// processes: wall-clock throughput would measure this loader, which shares the
// cores. Paced: each stream sends 60 messages a second, as a game does, so that
// all servers see the same arrivals. Closed loop: each stream sends its next
// message when it has read the answer. The solve is subtracted by its own
// report, without the slowest percent, which were interrupted.
//
//   stream_benchmark [FIRST LAST]     only these lines of the table, from 0
#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "convert/geometry.h"
#include "gelenk/v1/session_service.grpc.pb.h"
#include "stream/echo.grpc.pb.h"
#include "tests/benchmarks/problems.h"
#include "tests/benchmarks/stream/child_process.h"
#include "tests/benchmarks/stream/gelenkd_process.h"

namespace gelenk::benchmarks {
namespace {

constexpr int kStreams = 100;
constexpr int kConnections = 10;
constexpr int kPairs = 5;
constexpr double kSeconds = 1.5;
constexpr double kPacedHz = 60;

using Clock = std::chrono::steady_clock;

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double MeanWithoutSlowest(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  values.resize(std::max<size_t>(1, values.size() * 99 / 100));
  double sum = 0;
  for (double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// One message on its way to a server and its answer, again and again.
class LoopStream {
 public:
  virtual ~LoopStream() = default;
  // An operation has ended.
  virtual void Run(bool ok) = 0;
  // Paced: time to send.
  virtual void Send() = 0;
  virtual void Cancel() = 0;
};

// `Traits` says how messages are made and read.
template <class Request, class Response>
class TypedLoopStream final : public LoopStream {
 public:
  using ReaderWriter = grpc::ClientAsyncReaderWriter<Request, Response>;
  using Prepare =
      std::function<std::unique_ptr<ReaderWriter>(grpc::ClientContext*)>;

  TypedLoopStream(const Prepare& prepare, bool paced,
                  std::function<void(Request&)> next,
                  std::function<void(const Response&)> take)
      : paced_(paced), next_(std::move(next)), take_(std::move(take)) {
    stream_ = prepare(&context_);
    stream_->StartCall(this);
  }

  // One operation is under way at a time: start, then write, read, write, …
  void Run(bool ok) override {
    if (!ok) return;
    if (reading_) take_(response_);
    if (writing_) {
      writing_ = false;
      reading_ = true;
      stream_->Read(&response_, this);
      return;
    }
    reading_ = false;
    idle_ = true;
    if (!paced_) Send();
  }

  void Send() override {
    if (!idle_) return;
    idle_ = false;
    writing_ = true;
    next_(request_);
    stream_->Write(request_, this);
  }

  void Cancel() override { context_.TryCancel(); }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<ReaderWriter> stream_;
  Request request_;
  Response response_;
  const bool paced_;
  const std::function<void(Request&)> next_;
  const std::function<void(const Response&)> take_;
  bool idle_ = false;
  bool reading_ = false;
  bool writing_ = false;
};

struct Load {
  std::vector<std::shared_ptr<grpc::Channel>> channels;
  grpc::CompletionQueue queue;
  std::vector<std::unique_ptr<LoopStream>> streams;
  long messages = 0;
  bool counting = false;

  explicit Load(const std::string& address) {
    grpc::ChannelArguments arguments;
    arguments.SetInt("grpc.use_local_subchannel_pool", 1);
    for (int i = 0; i < kConnections; ++i) {
      channels.push_back(grpc::CreateCustomChannel(
          address, grpc::InsecureChannelCredentials(), arguments));
    }
  }

  // Without a rate, as fast as the answers come.
  void RunFor(double seconds, double hz) {
    const auto begin = Clock::now();
    const auto end = begin + std::chrono::duration<double>(seconds);
    const auto interval =
        std::chrono::duration<double>(hz > 0 ? 1 / hz / kStreams : seconds);
    auto due = begin;
    void* tag;
    bool ok;
    size_t next = 0;
    while (Clock::now() < end) {
      if (hz > 0 && Clock::now() >= due) {
        streams[next]->Send();
        next = (next + 1) % streams.size();
        due += std::chrono::duration_cast<Clock::duration>(interval);
      }
      const auto wake =
          std::chrono::system_clock::now() +
          std::chrono::duration_cast<std::chrono::system_clock::duration>(
              (hz > 0 ? due : end) - Clock::now());
      if (queue.AsyncNext(&tag, &ok, wake) ==
          grpc::CompletionQueue::GOT_EVENT) {
        static_cast<LoopStream*>(tag)->Run(ok);
      }
    }
  }
};

struct Setting {
  int threads;
  int batch;
  bool paced;
};

struct Figures {
  double cpu_us = 0;    // of the server, a frame
  double solve_us = 0;  // of it in the solver
  double frames_s = 0;
};

Figures Measure(const ChildProcess& server, Load& load,
                const Setting& setting) {
  const double hz = setting.paced ? kPacedHz : 0;
  load.RunFor(0.5, hz);
  load.messages = 0;
  load.counting = true;
  const double cpu = server.cpu_seconds();
  const auto begin = Clock::now();
  load.RunFor(kSeconds, hz);
  const double seconds =
      std::chrono::duration<double>(Clock::now() - begin).count();
  const double frames = static_cast<double>(load.messages) * setting.batch;
  return {1e6 * (server.cpu_seconds() - cpu) / frames, 0, frames / seconds};
}

// The loader's memory is left to the end of the process: taking its calls down
// one by one is no part of the figures.
void Abandon(std::unique_ptr<Load> load) {
  for (const auto& stream : load->streams) stream->Cancel();
  load.release();
}

// `busy_us` a frame is what the echo spins, and what is taken off its figure.
Figures MeasureEcho(const Setting& setting, size_t request_bytes,
                    size_t answer_bytes, double busy_us) {
  ChildProcess server(
      {BARE_ECHO, std::to_string(setting.threads), std::to_string(answer_bytes),
       std::to_string(std::lround(1e3 * busy_us * setting.batch))});
  auto load = std::make_unique<Load>(server.ReadLine());
  const std::string payload(request_bytes, 'x');
  for (int i = 0; i < kStreams; ++i) {
    std::shared_ptr<Echo::Stub> stub =
        Echo::NewStub(load->channels[i % kConnections]);
    load->streams.push_back(std::make_unique<TypedLoopStream<Payload, Payload>>(
        [stub, &load](grpc::ClientContext* context) {
          return stub->PrepareAsyncStream(context, &load->queue);
        },
        setting.paced,
        [&payload](Payload& request) { request.set_bytes(payload); },
        [l = load.get()](const Payload&) { l->messages += l->counting; }));
  }
  Figures figures = Measure(server, *load, setting);
  figures.cpu_us -= busy_us;
  Abandon(std::move(load));
  return figures;
}

// Sends the frames of one session, to and fro.
class FrameSource {
 public:
  FrameSource(const StreamProblem& problem, int batch, int phase)
      : problem_(problem), batch_(batch), at_(phase) {}

  void Fill(v1::StreamingSolveRequest& request) {
    request.Clear();
    const size_t period = 2 * (problem_.frames.size() - 1);
    for (int b = 0; b < batch_; ++b) {
      at_ = (at_ + 1) % period;
      const size_t frame = at_ < problem_.frames.size() ? at_ : period - at_;
      v1::TargetFrame* out = request.add_frames();
      out->set_sequence_number(++number_);
      for (size_t g = 0; g < problem_.frames[frame].size(); ++g) {
        v1::GoalTarget* target = out->add_targets();
        target->set_goal_index(static_cast<int>(g));
        const GoalTarget& value = problem_.frames[frame][g];
        if (const auto* point = std::get_if<Eigen::Vector3d>(&value)) {
          convert::ToProto(*point, target->mutable_world_position());
        } else {
          convert::ToProto(std::get<RigidTransform>(value),
                           target->mutable_world_pose());
        }
      }
    }
  }

 private:
  const StreamProblem& problem_;
  const int batch_;
  size_t at_;
  int64_t number_ = 0;
};

Figures MeasureServer(const Setting& setting, const StreamProblem& problem,
                      size_t* request_bytes, size_t* answer_bytes) {
  GelenkdProcess server({"--io-threads=" + std::to_string(setting.threads)});
  auto load = std::make_unique<Load>(server.address());
  CreateSkeleton(problem, load->channels[0]);
  CreateSessions(problem, 0, kStreams, load->channels[0]);
  std::vector<double> solves;
  for (int i = 0; i < kStreams; ++i) {
    std::shared_ptr<v1::SessionService::Stub> stub =
        v1::SessionService::NewStub(load->channels[i % kConnections]);
    auto source = std::make_shared<FrameSource>(problem, setting.batch, 5 * i);
    bool attached = false;
    load->streams.push_back(
        std::make_unique<TypedLoopStream<v1::StreamingSolveRequest,
                                         v1::StreamingSolveResponse>>(
            [stub, &load](grpc::ClientContext* context) {
              return stub->PrepareAsyncStreamingSolve(context, &load->queue);
            },
            setting.paced,
            [source, i, attached,
             request_bytes](v1::StreamingSolveRequest& request) mutable {
              if (!attached) {
                attached = true;
                request.Clear();
                v1::AttachSession* attach = request.add_attach();
                attach->set_session("sessions/benchmark-" + std::to_string(i));
                attach->set_frame_policy(v1::FRAME_POLICY_EVERY_FRAME);
                attach->set_report_interval(60);
                return;
              }
              source->Fill(request);
              *request_bytes = request.ByteSizeLong();
            },
            [l = load.get(), &solves,
             answer_bytes](const v1::StreamingSolveResponse& response) {
              if (!l->counting || response.frames_size() == 0) return;
              ++l->messages;
              *answer_bytes = response.ByteSizeLong();
              for (const v1::PoseFrame& frame : response.frames()) {
                solves.push_back(1e-3 *
                                 frame.report().solve_duration().nanos());
              }
            }));
  }
  Figures figures = Measure(server.process(), *load, setting);
  figures.solve_us = MeanWithoutSlowest(solves);
  Abandon(std::move(load));
  return figures;
}

void Compare(const char* name, const StreamProblem& problem,
             const Setting& setting) {
  std::vector<double> ratios;
  std::vector<double> busy_ratios;
  std::vector<double> ours;
  std::vector<double> bare;
  std::vector<double> busy;
  std::vector<double> solve;
  size_t request_bytes = 0;
  size_t answer_bytes = 0;
  for (int pair = 0; pair < kPairs; ++pair) {
    const Figures server =
        MeasureServer(setting, problem, &request_bytes, &answer_bytes);
    const Figures echo = MeasureEcho(setting, request_bytes, answer_bytes, 0);
    const Figures busy_echo =
        MeasureEcho(setting, request_bytes, answer_bytes, server.solve_us);
    ours.push_back(server.cpu_us - server.solve_us);
    bare.push_back(echo.cpu_us);
    solve.push_back(server.solve_us);
    busy.push_back(busy_echo.cpu_us);
    ratios.push_back(ours.back() / bare.back());
    busy_ratios.push_back(ours.back() / busy.back());
  }
  std::printf(
      "%-16s %-6s %5d %7d %6zu %6zu %8.2f %8.2f %9.2f %6.2f "
      "%9.2f %6.2f\n",
      name, setting.paced ? "60 Hz" : "closed", setting.batch, setting.threads,
      request_bytes, answer_bytes, Median(solve), Median(ours), Median(bare),
      Median(ratios), Median(busy), Median(busy_ratios));
  std::fflush(stdout);
}

int Main(int first, int last) {
  std::printf(
      "%d streams on %d connections; CPU of the server, us a frame, medians "
      "of %d pairs\n",
      kStreams, kConnections, kPairs);
  std::printf("%-16s %-6s %5s %7s %6s %6s %8s %8s %9s %6s %9s %6s\n", "session",
              "load", "batch", "threads", "in B", "out B", "solve", "the rest",
              "bare echo", "ratio", "busy echo", "ratio");
  const StreamProblem body = BodyProblem(600);
  const StreamProblem arm = PandaProblem(600);
  int line = 0;
  for (const Setting& setting :
       {Setting{1, 1, true}, Setting{1, 1, false}, Setting{1, 10, false},
        Setting{2, 1, true}, Setting{2, 1, false}}) {
    for (const auto& [name, problem] :
         {std::make_pair("body, 31 joints", &body),
          std::make_pair("arm, 7 joints", &arm)}) {
      if (line >= first && line <= last) Compare(name, *problem, setting);
      ++line;
    }
  }
  return 0;
}

}  // namespace
}  // namespace gelenk::benchmarks

int main(int argc, char** argv) {
  const bool some = argc == 3;
  const int code = gelenk::benchmarks::Main(some ? std::atoi(argv[1]) : 0,
                                            some ? std::atoi(argv[2]) : 99);
  std::fflush(stdout);
  // Abandoned calls may still be under way.
  std::_Exit(code);
}

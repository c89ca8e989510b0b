#include "tests/testing/server_process.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/time/clock.h"

namespace gelenk::testing {
namespace {

constexpr absl::Duration kPoll = absl::Milliseconds(2);
constexpr absl::Duration kStartPatience = absl::Seconds(20);
constexpr unsigned kLifeSeconds = 300;

// "50051" or "127.0.0.1:50051"; 0 when there is nothing yet.
int ReadPort(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> parts = absl::StrSplit(line, ':');
  int port = 0;
  return absl::SimpleAtoi(parts.back(), &port) ? port : 0;
}

std::string TemporaryPath() {
  const char* folder = std::getenv("TMPDIR");
  static int count = 0;
  return absl::StrCat(folder != nullptr ? folder : "/tmp", "/gelenkd-port-",
                      getpid(), "-", ++count);
}

// In the child: nothing but calls that are safe after fork. The alarm survives
// exec, and ends the server if the test cannot.
[[noreturn]] void Execute(char* const* arguments) {
  alarm(kLifeSeconds);
  execv(arguments[0], arguments);
  _exit(127);
}

}  // namespace

ServerProcess::ServerProcess(std::string program,
                             std::vector<std::string> arguments)
    : program_(std::move(program)),
      arguments_(std::move(arguments)),
      port_file_(TemporaryPath()) {}

ServerProcess::~ServerProcess() {
  Kill();
  std::remove(port_file_.c_str());
}

std::string ServerProcess::target() const {
  return absl::StrCat("127.0.0.1:", port_);
}

absl::Status ServerProcess::Start() {
  std::remove(port_file_.c_str());
  std::vector<std::string> words = {program_, "--listen", target(),
                                    "--port-file", port_file_};
  words.insert(words.end(), arguments_.begin(), arguments_.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  pid_ = fork();
  if (pid_ == 0) Execute(pointers.data());
  if (pid_ < 0) return absl::InternalError("fork failed");

  const absl::Time deadline = absl::Now() + kStartPatience;
  while (absl::Now() < deadline) {
    if (const int port = ReadPort(port_file_); port > 0) {
      port_ = port;
      return absl::OkStatus();
    }
    int exit_code = 0;
    if (WaitForEnd(absl::ZeroDuration(), &exit_code)) {
      return absl::UnavailableError(
          absl::StrCat(program_, " ended with exit code ", exit_code));
    }
    absl::SleepFor(kPoll);
  }
  Kill();
  return absl::DeadlineExceededError(absl::StrCat(program_, " does not start"));
}

int64_t ServerProcess::resident_bytes() const {
  std::ifstream file(absl::StrCat("/proc/", pid_, "/statm"));
  int64_t total_pages = 0;
  int64_t resident_pages = 0;
  file >> total_pages >> resident_pages;
  return resident_pages * sysconf(_SC_PAGESIZE);
}

void ServerProcess::Kill() {
  if (!is_running()) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  pid_ = -1;
}

int ServerProcess::Terminate(absl::Duration patience) {
  if (!is_running()) return -1;
  kill(pid_, SIGTERM);
  int exit_code = -1;
  if (!WaitForEnd(patience, &exit_code)) Kill();
  return exit_code;
}

bool ServerProcess::WaitForEnd(absl::Duration patience, int* exit_code) {
  const absl::Time deadline = absl::Now() + patience;
  for (;;) {
    int status = 0;
    if (waitpid(pid_, &status, WNOHANG) == pid_) {
      pid_ = -1;
      *exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
      return true;
    }
    if (absl::Now() >= deadline) return false;
    absl::SleepFor(kPoll);
  }
}

}  // namespace gelenk::testing

// A server process that a benchmark starts, measures and ends.
#ifndef GELENK_TESTS_BENCHMARKS_STREAM_CHILD_PROCESS_H_
#define GELENK_TESTS_BENCHMARKS_STREAM_CHILD_PROCESS_H_

#include <sys/types.h>

#include <string>
#include <vector>

namespace gelenk::benchmarks {

class ChildProcess {
 public:
  // Starts `arguments` (the first is the program) with a pipe as its input.
  explicit ChildProcess(const std::vector<std::string>& arguments);
  // Closes the pipe and sends SIGTERM, waits a while, then kills.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // The first line of its output.
  std::string ReadLine() const;
  // CPU time that it has used, all threads, s.
  double cpu_seconds() const;
  // Resident memory, bytes.
  long resident_bytes() const;

 private:
  pid_t pid_ = -1;
  int input_ = -1;
  int output_ = -1;
};

}  // namespace gelenk::benchmarks

#endif  // GELENK_TESTS_BENCHMARKS_STREAM_CHILD_PROCESS_H_

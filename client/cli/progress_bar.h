// How far a long command is, on a terminal.
#ifndef CLIENT_CLI_PROGRESS_BAR_H_
#define CLIENT_CLI_PROGRESS_BAR_H_

#include <cstdint>
#include <string>

#include "absl/time/time.h"

namespace gelenk::cli {

// Draws itself on standard error, over and over on one line, and goes away at
// the end. Does nothing when standard error is no terminal. Not thread-safe.
class ProgressBar {
 public:
  ProgressBar(std::string label, int64_t total);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // Cheap: draws at most ten times a second.
  void Update(int64_t done);

 private:
  const std::string label_;
  const int64_t total_;
  const bool visible_;
  absl::Time next_draw_ = absl::InfinitePast();
};

// "label [=====     ]  50 %"
std::string ProgressLine(const std::string& label, int64_t done, int64_t total);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PROGRESS_BAR_H_

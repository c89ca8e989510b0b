#include "client/cli/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "absl/strings/str_format.h"
#include "absl/time/clock.h"

namespace gelenk::cli {
namespace {

constexpr int kWidth = 40;
constexpr absl::Duration kDrawInterval = absl::Milliseconds(100);
// Back to the start of the line, and blank to its end.
constexpr char kClearLine[] = "\r\x1b[K";

}  // namespace

std::string ProgressLine(const std::string& label, int64_t done,
                         int64_t total) {
  const double share =
      total > 0 ? std::clamp(static_cast<double>(done) / total, 0.0, 1.0) : 1;
  const int full = static_cast<int>(share * kWidth);
  return absl::StrFormat("%s [%s%s] %3d %%", label, std::string(full, '='),
                         std::string(kWidth - full, ' '),
                         static_cast<int>(share * 100));
}

ProgressBar::ProgressBar(std::string label, int64_t total)
    : label_(std::move(label)),
      total_(total),
      visible_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (visible_) std::fputs(kClearLine, stderr);
}

void ProgressBar::Update(int64_t done) {
  if (!visible_) return;
  const absl::Time now = absl::Now();
  if (now < next_draw_) return;
  next_draw_ = now + kDrawInterval;
  std::fputs((kClearLine + ProgressLine(label_, done, total_)).c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace gelenk::cli

// Which joint limits a clip is played with.
#ifndef CLIENT_CLI_PLAY_LIMIT_CHOICE_H_
#define CLIENT_CLI_PLAY_LIMIT_CHOICE_H_

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cli/bvh_clip.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk::cli {

inline constexpr char kClipLimits[] = "clip";
inline constexpr char kNoLimits[] = "none";

struct LimitedSkeleton {
  std::shared_ptr<const Skeleton> skeleton;
  // For people: where the limits are from, and what to know about them.
  std::string description;
  std::vector<std::string> notes;
};

// The clip's skeleton with limits by `choice`: kClipLimits takes the range of
// the clip and a little more, kNoLimits none, anything else names a skeleton
// file whose joints' limits, and the axes they are about, are taken by id.
absl::StatusOr<LimitedSkeleton> ChooseLimits(const BvhClip& clip,
                                             const std::string& choice);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PLAY_LIMIT_CHOICE_H_

// What can be told about a skeleton file.
#ifndef CLIENT_CLI_INFO_INSPECTION_H_
#define CLIENT_CLI_INFO_INSPECTION_H_

#include <optional>
#include <string>
#include <vector>

#include "client/cli/skeleton_file.h"
#include "client/cli/text/format.h"
#include "gelenk/motion/body_parts.h"
#include "gelenk/motion/first_frame.h"

namespace gelenk::cli {

struct Inspection {
  // Outlives the inspection.
  const SkeletonFile* file = nullptr;
  BodyParts body;
  std::optional<double> height_m;
  std::optional<FirstFrameJump> first_frame_jump;
  // Per joint of the skeleton the channels that the BVH file gives it.
  std::vector<std::vector<std::string>> channels;
  // Ends of chains: what hangs from joints without children, else these
  // joints themselves.
  std::vector<std::string> tips;
};

Inspection Inspect(const SkeletonFile& file);

// For people: facts, the tree of joints, warnings.
std::string InspectionText(const Inspection& inspection);

// Keys stay; numbers in m, rad, s.
Json InspectionJson(const Inspection& inspection);

// End effectors that share the frame of `joint`: the links of a robot.
std::vector<std::string> EffectorsAt(const Skeleton& skeleton, int joint);
bool SharesItsJointsFrame(const EndEffector& effector);

// A body part's name and its joint, -1 where there is none.
struct NamedPart {
  const char* name;
  int joint;
};
std::vector<NamedPart> PartsOf(const BodyParts& body);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_INFO_INSPECTION_H_

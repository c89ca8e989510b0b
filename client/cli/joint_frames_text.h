// Joint frames and poses, joint by joint.
#ifndef CLIENT_CLI_JOINT_FRAMES_TEXT_H_
#define CLIENT_CLI_JOINT_FRAMES_TEXT_H_

#include <string>

#include "client/cli/text/format.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/v1/skeleton.pb.h"

namespace gelenk::cli {

// `frames` are those of all joints of `skeleton`.
std::string JointFramesText(const Skeleton& skeleton,
                            const v1::JointFrames& frames);
Json JointFramesJson(const Skeleton& skeleton, const v1::JointFrames& frames);

// `pose` has the skeleton's number of positions. Joints without numbers of
// their own are left out.
std::string PoseText(const Skeleton& skeleton, const v1::Pose& pose);
Json PoseJson(const Skeleton& skeleton, const v1::Pose& pose);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_JOINT_FRAMES_TEXT_H_

// A body as lines between its joints.
#ifndef CLIENT_CLI_PICTURE_STICK_FIGURE_H_
#define CLIENT_CLI_PICTURE_STICK_FIGURE_H_

#include <Eigen/Core>
#include <vector>

#include "absl/strings/string_view.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/motion/body_parts.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk::cli {

enum class BodyHalf { kTrunk, kLeft, kRight };

// Per joint: left and right are the limbs that end in a left or right hand or
// foot, with what hangs from them.
std::vector<BodyHalf> HalvesOf(const Skeleton& skeleton, const BodyParts& body);

struct Bone {
  Eigen::Vector3d world_from;
  Eigen::Vector3d world_to;
  BodyHalf half = BodyHalf::kTrunk;
};

// A bone from every joint to its parent, and to each of its end effectors.
std::vector<Bone> BonesOf(const Skeleton& skeleton,
                          const std::vector<BodyHalf>& halves,
                          const WorldTransforms& world_from_joints);

// How bones of that half look, see style.h.
absl::string_view BoneClass(BodyHalf half);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_STICK_FIGURE_H_

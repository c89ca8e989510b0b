// What a BVH file says, as it says it: a hierarchy and rows of channel values.
//
// Lengths are in the file's own unit and angles in degrees; nothing is turned
// or scaled. bvh_import.h makes a Skeleton of it, bvh_motion.h poses.
#ifndef GELENK_FORMATS_BVH_DOCUMENT_H_
#define GELENK_FORMATS_BVH_DOCUMENT_H_

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"

namespace gelenk {

// Positions first, so that the axis is the value modulo 3.
enum class BvhChannel : unsigned char {
  kXposition,
  kYposition,
  kZposition,
  kXrotation,
  kYrotation,
  kZrotation,
};

inline constexpr std::array<absl::string_view, 6> kBvhChannelNames = {
    "Xposition", "Yposition", "Zposition",
    "Xrotation", "Yrotation", "Zrotation"};

inline absl::string_view BvhChannelName(BvhChannel channel) {
  return kBvhChannelNames[static_cast<int>(channel)];
}
inline bool IsPosition(BvhChannel channel) {
  return static_cast<int>(channel) < 3;
}
// 0, 1, 2 for X, Y, Z.
inline int AxisOf(BvhChannel channel) { return static_cast<int>(channel) % 3; }

struct BvhEndSite {
  // Most files give it none.
  std::string name;
  // From the joint, in the joint's frame.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

struct BvhJoint {
  std::string name;
  // Index in BvhDocument::joints, -1 for the root.
  int parent = -1;
  // From the parent, in the parent's frame. Position channels replace its
  // components, they are not added.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  // In file order. Rotations apply in this order about the moving axes: the
  // joint turns by R(first) * R(second) * R(third).
  std::vector<BvhChannel> channels;
  std::vector<BvhEndSite> end_sites;
};

struct BvhDocument {
  // Depth first, as files list them; the root is joints[0].
  std::vector<BvhJoint> joints;
  double frame_time_s = 1.0 / 30;
  // The number as the file wrote it; written again while it still means
  // frame_time_s.
  std::string frame_time_text;
  // One column a frame, one row a channel: the joints' channels one after the
  // other.
  Eigen::MatrixXd motion;
  // What the reader took with a grain of salt.
  std::vector<std::string> warnings;

  int channel_count() const {
    int count = 0;
    for (const BvhJoint& joint : joints) {
      count += static_cast<int>(joint.channels.size());
    }
    return count;
  }
  int frame_count() const { return static_cast<int>(motion.cols()); }
};

}  // namespace gelenk

#endif  // GELENK_FORMATS_BVH_DOCUMENT_H_

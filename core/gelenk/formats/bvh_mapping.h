// Which number of a BVH frame is which number of a pose.
//
// Made by ImportBvh. Angles change between degrees and rad, lengths between the
// file's unit and m; nothing is turned.
#ifndef GELENK_FORMATS_BVH_MAPPING_H_
#define GELENK_FORMATS_BVH_MAPPING_H_

#include <Eigen/Core>
#include <array>
#include <numbers>
#include <vector>

#include "gelenk/math/euler.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

inline constexpr double kRadPerDegree = std::numbers::pi / 180;

// q[position] = scale * channel.
struct BvhScalar {
  int channel = 0;
  int position = 0;
  double scale = 1;  // rad per degree, or m per unit
};

// The quaternion at q[position] is made of three angles.
struct BvhRotation {
  std::array<int, 3> channels = {};
  EulerAxes axes = {};
  int position = 0;
};

// A position channel that never moves: it is part of the skeleton.
struct BvhConstant {
  int channel = 0;
  double value = 0;  // in the file's unit
};

struct BvhMapping {
  int channel_count = 0;
  std::vector<BvhScalar> scalars;
  std::vector<BvhRotation> rotations;
  std::vector<BvhConstant> constants;
};

// Writes the numbers of q that the channels of one frame give; the mapping of
// an import gives all of them. Allocates nothing.
void PoseFromChannels(const BvhMapping& mapping,
                      const ConstVectorView& channels, VectorView positions);

// The way back, into `channels`. Of all angles that make a rotation it takes
// those nearest to `near_channels`, which may be `channels` itself.
void ChannelsFromPose(const BvhMapping& mapping,
                      const ConstVectorView& positions,
                      const ConstVectorView& near_channels,
                      VectorView channels);

}  // namespace gelenk

#endif  // GELENK_FORMATS_BVH_MAPPING_H_

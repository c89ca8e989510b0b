#include "gelenk/formats/bvh_mapping.h"

#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

Eigen::Vector3d AnglesOf(const BvhRotation& rotation,
                         const ConstVectorView& channels) {
  const auto& [first, second, third] = rotation.channels;
  return kRadPerDegree *
         Eigen::Vector3d(channels[first], channels[second], channels[third]);
}

}  // namespace

void PoseFromChannels(const BvhMapping& mapping,
                      const ConstVectorView& channels, VectorView positions) {
  for (const BvhScalar& scalar : mapping.scalars) {
    positions[scalar.position] = scalar.scale * channels[scalar.channel];
  }
  for (const BvhRotation& rotation : mapping.rotations) {
    StoreXyzw(RotationFromEuler(rotation.axes, AnglesOf(rotation, channels)),
              positions.data() + rotation.position);
  }
}

void ChannelsFromPose(const BvhMapping& mapping,
                      const ConstVectorView& positions,
                      const ConstVectorView& near_channels,
                      VectorView channels) {
  for (const BvhScalar& scalar : mapping.scalars) {
    channels[scalar.channel] = positions[scalar.position] / scalar.scale;
  }
  for (const BvhConstant& constant : mapping.constants) {
    channels[constant.channel] = constant.value;
  }
  for (const BvhRotation& rotation : mapping.rotations) {
    const Eigen::Vector3d angles = EulerFromRotation(
        rotation.axes, QuaternionXyzw(positions.data() + rotation.position),
        AnglesOf(rotation, near_channels));
    for (int i = 0; i < 3; ++i) {
      channels[rotation.channels[i]] = angles[i] / kRadPerDegree;
    }
  }
}

}  // namespace gelenk

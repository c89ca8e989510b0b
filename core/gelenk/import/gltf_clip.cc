#include "gelenk/import/gltf_clip.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/formats/unique_names.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

// Departures from rest that rounding in single precision makes, as a part of
// the length.
constexpr double kSinglePrecision = 1e-5;

// Keys that are recorded frames are spaced evenly and so close; those that an
// animator has set are not. Single precision rounds their times.
constexpr double kShortestFrame = 1.0 / 1000;
constexpr double kLongestFrame = 1.0 / 10;
constexpr double kUnevenness = 1e-2;
// So near to a whole rate the rate is meant, if that moves the last key by less
// than so much of a frame: 0.0083333 s is 1/120 in a short clip only.
constexpr double kRateRounding = 1e-5;
constexpr double kLastKeyRounding = 5e-4;

// The time from key to key of the channel with the most keys, where they are
// frames; else 0.
double FrameTimeOfKeys(const GltfAnimation& animation) {
  const std::vector<double>* times = nullptr;
  for (const GltfChannel& channel : animation.channels) {
    if (times == nullptr || channel.times_s.size() > times->size()) {
      times = &channel.times_s;
    }
  }
  if (times == nullptr || times->size() < 3) return 0;
  const double mean =
      (times->back() - times->front()) / static_cast<double>(times->size() - 1);
  if (mean < kShortestFrame || mean > kLongestFrame) return 0;
  for (size_t k = 0; k < times->size(); ++k) {
    const double even = times->front() + static_cast<double>(k) * mean;
    if (std::abs((*times)[k] - even) > kUnevenness * mean) return 0;
  }
  const double rate = 1 / mean;
  const double whole = std::round(rate);
  const double last = static_cast<double>(times->size() - 1);
  const bool is_whole = std::abs(rate - whole) <=
                        std::min(kRateRounding, kLastKeyRounding / last) * rate;
  return is_whole ? 1 / whole : mean;
}

// What is above a node, while it rests: scene = linear * local + position.
struct Above {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

Above WhatIsAbove(const GltfDocument& document, int node) {
  Above above;
  for (int i = document.nodes[node].parent; i >= 0;
       i = document.nodes[i].parent) {
    const GltfNode& outer = document.nodes[i];
    const Eigen::Matrix3d linear =
        outer.rotation.toRotationMatrix() * outer.scale.asDiagonal();
    above.position = linear * above.position + outer.translation;
    above.linear = linear * above.linear;
    above.rotation = (outer.rotation * above.rotation).normalized();
  }
  return above;
}

// Multiplies quaternions from the left, number by number.
Eigen::Matrix4d LeftProduct(const Eigen::Quaterniond& q) {
  Eigen::Matrix4d product;
  for (int i = 0; i < 4; ++i) {
    Eigen::Quaterniond unit;
    unit.coeffs() = Eigen::Vector4d::Unit(i);
    product.col(i) = (q * unit).coeffs();
  }
  return product;
}

JointTrack Mapped(const GltfChannel& channel, int joint,
                  const Eigen::MatrixXd& linear,
                  const Eigen::VectorXd& offset) {
  JointTrack track{.joint = joint,
                   .kind = channel.path == GltfPath::kRotation
                               ? PosePartKind::kRotation
                               : PosePartKind::kNumbers,
                   .interpolation = channel.interpolation,
                   .times_s = channel.times_s};
  track.values = (linear * channel.values).colwise() + offset;
  if (channel.interpolation == Interpolation::kCubicSpline) {
    track.in_tangents = linear * channel.in_tangents;
    track.out_tangents = linear * channel.out_tangents;
  }
  return track;
}

// What is left out, for one sentence.
struct LeftOut {
  int count = 0;
  int worst_node = -1;
  double worst = 0;

  void Note(int node, double departure) {
    ++count;
    if (departure < worst) return;
    worst = departure;
    worst_node = node;
  }
};

std::string NodeName(const GltfDocument& document, int node) {
  return absl::StrCat("nodes[", node, "] (",
                      QuotedId(PrintableUtf8(document.nodes[node].name)), ")");
}

}  // namespace

absl::StatusOr<GltfClip> ClipFromGltf(const GltfAnimation& animation,
                                      const GltfDocument& document,
                                      const GltfImport& import) {
  const Skeleton& skeleton = *import.skeleton;
  std::vector<JointTrack> tracks;
  LeftOut translations, scales, strangers;
  for (const GltfChannel& channel : animation.channels) {
    const GltfNode& node = document.nodes[channel.node];
    const int joint = import.joint_of_node[channel.node];
    if (channel.path == GltfPath::kScale) {
      const double departure =
          (channel.values.colwise() - node.scale).cwiseAbs().maxCoeff();
      if (departure > kSinglePrecision) scales.Note(channel.node, departure);
    } else if (joint < 0) {
      strangers.Note(channel.node, 0);
    } else if (channel.path == GltfPath::kTranslation) {
      if (skeleton.joint(joint).type == JointType::kFree) {
        const Above above = WhatIsAbove(document, channel.node);
        tracks.push_back(Mapped(channel, joint, import.unit_m * above.linear,
                                import.unit_m * above.position));
        continue;
      }
      const double departure = (channel.values.colwise() - node.translation)
                                   .colwise()
                                   .norm()
                                   .maxCoeff();
      if (departure > kSinglePrecision * (1 + node.translation.norm())) {
        translations.Note(channel.node, import.unit_m * departure);
      }
    } else {
      const Eigen::Quaterniond before =
          skeleton.joint(joint).type == JointType::kFree
              ? WhatIsAbove(document, channel.node).rotation
              : node.rotation.conjugate();
      tracks.push_back(
          Mapped(channel, joint, LeftProduct(before), Eigen::Vector4d::Zero()));
    }
  }
  absl::StatusOr<MotionClip> clip = MotionClip::Create(
      import.skeleton, std::move(tracks),
      {.name = animation.name, .frame_time_s = FrameTimeOfKeys(animation)});
  if (!clip.ok()) return clip.status();
  GltfClip result{*std::move(clip), {}};
  if (translations.count > 0) {
    result.warnings.push_back(absl::StrFormat(
        "translations of %d joints below the root are left out; the largest "
        "departs from rest by %.3g m, %s",
        translations.count, translations.worst,
        NodeName(document, translations.worst_node)));
  }
  if (scales.count > 0) {
    result.warnings.push_back(absl::StrFormat(
        "scales of %d nodes are left out; the largest departs from rest by "
        "%.3g, %s",
        scales.count, scales.worst, NodeName(document, scales.worst_node)));
  }
  if (strangers.count > 0) {
    result.warnings.push_back(absl::StrFormat(
        "channels of %d nodes that are no joints are left out, as %s",
        strangers.count, NodeName(document, strangers.worst_node)));
  }
  if (animation.skipped_channels > 0) {
    result.warnings.push_back(
        absl::StrFormat("%d channels of weights or without a node are left out",
                        animation.skipped_channels));
  }
  return result;
}

}  // namespace gelenk

#include "gelenk/motion/blender.h"

#include <algorithm>
#include <utility>

#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

// Steps to Karcher's mean shrink by the square of the spread; within half a
// turn eight leave nothing.
constexpr int kMaxMeanSteps = 32;
constexpr double kMeanTolerance_rad = 1e-14;

double WeightOf(const BlendInput& input, int joint) {
  return input.joint_weights.empty()
             ? input.weight
             : input.weight * input.joint_weights[joint];
}

Eigen::Quaterniond MeanRotation(absl::Span<const BlendInput> inputs,
                                const PosePart& part, double sum,
                                const double* heaviest) {
  Eigen::Quaterniond mean = QuaternionXyzw(heaviest + part.position_offset);
  for (int step = 0; step < kMaxMeanSteps; ++step) {
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();
    for (const BlendInput& input : inputs) {
      const double weight = WeightOf(input, part.joint);
      if (weight == 0) continue;
      turn +=
          weight / sum *
          LogRotation(mean.conjugate() *
                      QuaternionXyzw(input.positions + part.position_offset));
    }
    if (turn.norm() < kMeanTolerance_rad) break;
    mean = (mean * ExpRotation(turn)).normalized();
  }
  return mean;
}

}  // namespace

Blender::Blender(std::shared_ptr<const Skeleton> skeleton)
    : skeleton_(std::move(skeleton)), parts_(PosePartsOf(*skeleton_)) {}

void Blender::Blend(absl::Span<const BlendInput> inputs,
                    VectorView positions) const {
  for (const PosePart& part : parts_) {
    double sum = 0;
    double largest = 0;
    const double* heaviest = nullptr;
    for (const BlendInput& input : inputs) {
      const double weight = WeightOf(input, part.joint);
      sum += weight;
      if (weight <= largest) continue;
      largest = weight;
      heaviest = input.positions;
    }
    if (heaviest == nullptr) continue;
    double* out = positions.data() + part.position_offset;
    if (part.kind == PosePartKind::kRotation) {
      StoreXyzw(MeanRotation(inputs, part, sum, heaviest), out);
      continue;
    }
    for (int i = 0; i < part.position_count; ++i) {
      // From the heaviest on, so that equal numbers stay what they are.
      const double reference = heaviest[part.position_offset + i];
      double change = 0;
      for (const BlendInput& input : inputs) {
        change += WeightOf(input, part.joint) / sum *
                  (input.positions[part.position_offset + i] - reference);
      }
      out[i] = reference + change;
    }
  }
}

}  // namespace gelenk

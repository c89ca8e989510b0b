#include "client/cli/vmc/vmc_reader.h"

#include <cmath>

#include "client/cli/vmc/unity_axes.h"

namespace gelenk::cli {
namespace {

// A name, then a position and a quaternion x y z w; newer senders add more to
// the root's.
constexpr size_t kPlaceArguments = 8;
// Rooms are smaller, m.
constexpr double kMost_m = 1000;
// Floats that were a unit quaternion.
constexpr double kUnitTolerance = 0.01;

struct NamedPlace {
  std::string name;
  RigidTransform place;
};

std::optional<NamedPlace> PlaceOf(const OscMessage& message) {
  const std::vector<OscArgument>& arguments = message.arguments;
  if (arguments.size() < kPlaceArguments) return std::nullopt;
  const auto* name = std::get_if<std::string>(&arguments[0]);
  if (name == nullptr) return std::nullopt;
  std::array<double, 7> numbers;
  for (size_t i = 0; i < numbers.size(); ++i) {
    const auto* number = std::get_if<float>(&arguments[i + 1]);
    if (number == nullptr || !(std::abs(*number) <= kMost_m)) {
      return std::nullopt;
    }
    numbers[i] = *number;
  }
  Eigen::Quaterniond rotation(numbers[6], numbers[3], numbers[4], numbers[5]);
  if (std::abs(rotation.norm() - 1) > kUnitTolerance) return std::nullopt;
  rotation.normalize();
  return NamedPlace{
      *name, MirrorAxes({rotation, {numbers[0], numbers[1], numbers[2]}})};
}

}  // namespace

bool VmcReader::End() {
  if (!has_any_) return false;
  frame_ = next_;
  brought_ = {};
  has_any_ = false;
  return true;
}

bool VmcReader::TakeBone(const OscMessage& message) {
  const std::optional<NamedPlace> place = PlaceOf(message);
  const int bone = place ? FindHumanBone(place->name) : -1;
  if (bone < 0) {
    ++refused_count_;
    return false;
  }
  const bool ended = brought_[bone] && End();
  next_.bones[bone] = place->place;
  brought_[bone] = true;
  has_any_ = true;
  return ended;
}

void VmcReader::TakeTracker(const OscMessage& message) {
  const std::optional<NamedPlace> place = PlaceOf(message);
  const bool is_full = next_.trackers.size() >= kMaxVmcTrackers;
  if (!place || (is_full && next_.trackers.count(place->name) == 0)) {
    ++refused_count_;
    return;
  }
  next_.trackers[place->name] = place->place;
  has_any_ = true;
}

bool VmcReader::Take(const OscMessage& message) {
  const std::string& path = message.path;
  if (path == "/VMC/Ext/OK" || path == "/VMC/Ext/T") return End();
  if (path == "/VMC/Ext/Bone/Pos") return TakeBone(message);
  if (path == "/VMC/Ext/Root/Pos") {
    const std::optional<NamedPlace> place = PlaceOf(message);
    if (place) {
      next_.root = place->place;
    } else {
      ++refused_count_;
    }
  } else if (path == "/VMC/Ext/Hmd/Pos" || path == "/VMC/Ext/Con/Pos" ||
             path == "/VMC/Ext/Tra/Pos") {
    TakeTracker(message);
  }
  return false;
}

}  // namespace gelenk::cli

#include "gelenk/formats/bvh_import.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/formats/bvh_body.h"
#include "gelenk/formats/unique_names.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {
namespace {

// Positions that move less than this, relative to the skeleton's size, are an
// exporter's rounding.
constexpr double kConstant = 1e-6;

constexpr double kRadPerDegree = std::numbers::pi / 180;

// A nanometre to a thousand kilometres.
constexpr double kMinUnit = 1e-9;
constexpr double kMaxUnit = 1e6;

// The channels of one joint, sorted by what they do.
struct JointChannels {
  std::vector<int> positions;  // rows of the motion
  std::vector<int> rotations;
  std::vector<int> position_axes;
  EulerAxes rotation_axes = {};  // of the first three rotations
  bool is_full_rotation = false;
};

JointChannels SortChannels(const BvhJoint& joint, int first_channel) {
  JointChannels sorted;
  for (size_t i = 0; i < joint.channels.size(); ++i) {
    const int row = first_channel + static_cast<int>(i);
    const int axis = AxisOf(joint.channels[i]);
    if (IsPosition(joint.channels[i])) {
      sorted.positions.push_back(row);
      sorted.position_axes.push_back(axis);
      continue;
    }
    if (sorted.rotations.size() < 3) {
      sorted.rotation_axes[sorted.rotations.size()] = axis;
    }
    sorted.rotations.push_back(row);
  }
  sorted.is_full_rotation = sorted.rotations.size() == 3 &&
                            ReachesEveryRotation(sorted.rotation_axes);
  return sorted;
}

// Builds the skeleton and the mapping for one length of the unit.
class BvhSkeletonBuilder {
 public:
  BvhSkeletonBuilder(const BvhDocument& document, double unit_m)
      : document_(document), unit_m_(unit_m), ids_(kMaxIdBytes) {}

  absl::StatusOr<BvhImport> Build(const Eigen::Vector3d& up);

 private:
  void AddJoint(int index, int first_channel);
  void AddEndSites();

  // The chain of scalar joints that replaces one of the file; `offset` is what
  // does not move.
  void AddChain(const BvhJoint& joint, const JointChannels& channels,
                bool positions_move, Joint first);
  void AddFree(const JointChannels& channels, Joint joint,
               const Eigen::Vector3d& rest);
  void AddSpherical(const JointChannels& channels, Joint joint);
  void AddScalar(int channel, JointType type, int axis, double rest,
                 Joint joint);
  void Add(Joint joint, const std::vector<double>& rest);

  // True when these rows of the motion do not move.
  bool AreConstant(const std::vector<int>& rows) const;
  double Size() const;

  std::string IdOf(absl::string_view name, absl::string_view what);

  const BvhDocument& document_;
  const double unit_m_;
  double size_ = 0;
  UniqueNames ids_;
  // Ids of the file's joints, given before those of the joints between.
  std::vector<std::string> joint_ids_;
  int joint_count_ = 0;
  std::vector<double> rest_positions_;
  SkeletonBuilder builder_;
  BvhImport import_;
};

absl::StatusOr<BvhImport> BvhSkeletonBuilder::Build(const Eigen::Vector3d& up) {
  size_ = Size();
  for (const BvhJoint& joint : document_.joints) {
    joint_ids_.push_back(IdOf(joint.name, "joint"));
  }
  int first_channel = 0;
  for (size_t i = 0; i < document_.joints.size(); ++i) {
    AddJoint(static_cast<int>(i), first_channel);
    first_channel += static_cast<int>(document_.joints[i].channels.size());
  }
  AddEndSites();
  builder_.SetUp(up).SetRestPositions(Eigen::Map<const Eigen::VectorXd>(
      rest_positions_.data(), rest_positions_.size()));
  absl::StatusOr<std::shared_ptr<const Skeleton>> skeleton = builder_.Build();
  if (!skeleton.ok()) return skeleton.status();
  import_.skeleton = *std::move(skeleton);
  import_.unit_m = unit_m_;
  import_.mapping.channel_count = first_channel;
  return std::move(import_);
}

void BvhSkeletonBuilder::AddJoint(int index, int first_channel) {
  const BvhJoint& joint = document_.joints[index];
  const JointChannels channels = SortChannels(joint, first_channel);
  Joint made;
  made.id = joint_ids_[index];
  if (joint.parent >= 0) made.parent_id = joint_ids_[joint.parent];

  // What the channels move is not part of the offset.
  const bool positions_move =
      !channels.positions.empty() &&
      (joint.parent < 0 || !AreConstant(channels.positions));
  Eigen::Vector3d offset = joint.offset;
  for (size_t i = 0; i < channels.positions.size(); ++i) {
    double& component = offset[channels.position_axes[i]];
    if (positions_move) {
      component = 0;
    } else if (document_.frame_count() > 0) {
      component = document_.motion(channels.positions[i], 0);
    }
    if (!positions_move) {
      import_.mapping.constants.push_back({channels.positions[i], component});
    }
  }
  made.parent_from_joint.translation = unit_m_ * offset;

  const bool moves_anywhere = positions_move && channels.positions.size() == 3;
  if (moves_anywhere && channels.is_full_rotation) {
    AddFree(channels, std::move(made), unit_m_ * joint.offset);
  } else if (!positions_move && channels.is_full_rotation) {
    AddSpherical(channels, std::move(made));
  } else if (!positions_move && channels.rotations.empty()) {
    Add(std::move(made), {});
  } else {
    AddChain(joint, channels, positions_move, std::move(made));
  }
  import_.joints.push_back(joint_count_ - 1);
}

void BvhSkeletonBuilder::AddFree(const JointChannels& channels, Joint joint,
                                 const Eigen::Vector3d& rest) {
  joint.type = JointType::kFree;
  const int at = static_cast<int>(rest_positions_.size());
  for (int i = 0; i < 3; ++i) {
    import_.mapping.scalars.push_back(
        {channels.positions[i], at + channels.position_axes[i], unit_m_});
  }
  import_.mapping.rotations.push_back(
      {{channels.rotations[0], channels.rotations[1], channels.rotations[2]},
       channels.rotation_axes,
       at + 3});
  Add(std::move(joint), {rest.x(), rest.y(), rest.z(), 0, 0, 0, 1});
}

void BvhSkeletonBuilder::AddSpherical(const JointChannels& channels,
                                      Joint joint) {
  joint.type = JointType::kSpherical;
  import_.mapping.rotations.push_back(
      {{channels.rotations[0], channels.rotations[1], channels.rotations[2]},
       channels.rotation_axes,
       static_cast<int>(rest_positions_.size())});
  Add(std::move(joint), {0, 0, 0, 1});
}

void BvhSkeletonBuilder::AddScalar(int channel, JointType type, int axis,
                                   double rest, Joint joint) {
  joint.type = type;
  joint.axis = Eigen::Vector3d::Unit(axis);
  import_.mapping.scalars.push_back(
      {channel, static_cast<int>(rest_positions_.size()),
       type == JointType::kPrismatic ? unit_m_ : kRadPerDegree});
  Add(std::move(joint), {rest});
}

void BvhSkeletonBuilder::AddChain(const BvhJoint& joint,
                                  const JointChannels& channels,
                                  bool positions_move, Joint first) {
  const std::string id = first.id;
  const size_t prismatic = positions_move ? channels.positions.size() : 0;
  const size_t rotational =
      channels.is_full_rotation ? 1 : channels.rotations.size();
  Joint next = std::move(first);
  // Joints but the last get the name of their channel.
  const auto take = [&](size_t number, int channel, int first_channel) {
    Joint taken = std::move(next);
    if (number + 1 == prismatic + rotational) {
      taken.id = id;
    } else {
      const absl::string_view name =
          BvhChannelName(joint.channels[channel - first_channel]);
      const size_t room = kMaxIdBytes - name.size() - 1;
      taken.id = ids_.Take(absl::StrCat(TruncateUtf8(id, room), ".", name));
    }
    next = Joint();
    next.parent_id = taken.id;
    return taken;
  };
  const int first_channel =
      std::min(channels.positions.empty() ? INT32_MAX : channels.positions[0],
               channels.rotations.empty() ? INT32_MAX : channels.rotations[0]);
  for (size_t i = 0; i < prismatic; ++i) {
    const int channel = channels.positions[i];
    const int axis = channels.position_axes[i];
    AddScalar(channel, JointType::kPrismatic, axis,
              unit_m_ * joint.offset[axis], take(i, channel, first_channel));
  }
  if (channels.is_full_rotation) {
    AddSpherical(channels,
                 take(prismatic, channels.rotations[0], first_channel));
    return;
  }
  for (size_t i = 0; i < rotational; ++i) {
    const int channel = channels.rotations[i];
    AddScalar(channel, JointType::kRevolute,
              AxisOf(joint.channels[channel - first_channel]), 0,
              take(prismatic + i, channel, first_channel));
  }
}

void BvhSkeletonBuilder::Add(Joint joint, const std::vector<double>& rest) {
  builder_.AddJoint(std::move(joint));
  ++joint_count_;
  rest_positions_.insert(rest_positions_.end(), rest.begin(), rest.end());
}

void BvhSkeletonBuilder::AddEndSites() {
  for (size_t i = 0; i < document_.joints.size(); ++i) {
    for (const BvhEndSite& site : document_.joints[i].end_sites) {
      EndEffector effector;
      effector.joint_id = joint_ids_[i];
      effector.joint_from_end_effector.translation = unit_m_ * site.offset;
      const std::string own_name = PrintableUtf8(site.name);
      const bool has_own_name = !own_name.empty() &&
                                own_name.size() <= kMaxIdBytes &&
                                !ids_.Contains(own_name);
      effector.id = ids_.Take(
          has_own_name
              ? own_name
              : absl::StrCat(TruncateUtf8(joint_ids_[i], kMaxIdBytes - 4),
                             ".end"));
      builder_.AddEndEffector(std::move(effector));
    }
  }
}

bool BvhSkeletonBuilder::AreConstant(const std::vector<int>& rows) const {
  if (document_.frame_count() == 0) return true;
  for (int row : rows) {
    const auto values = document_.motion.row(row);
    if (values.maxCoeff() - values.minCoeff() > kConstant * size_) return false;
  }
  return true;
}

// The longest way from the root to a joint, in the file's unit. Exporters that
// give every joint positions may leave the OFFSETs zero, so the first frame
// counts as well.
double BvhSkeletonBuilder::Size() const {
  std::vector<double> ways;
  int row = 0;
  for (const BvhJoint& joint : document_.joints) {
    Eigen::Vector3d bone = joint.offset;
    for (BvhChannel channel : joint.channels) {
      if (IsPosition(channel) && document_.frame_count() > 0) {
        bone[AxisOf(channel)] = document_.motion(row, 0);
      }
      ++row;
    }
    ways.push_back(joint.parent < 0 ? 0 : ways[joint.parent] + bone.norm());
  }
  return *std::max_element(ways.begin(), ways.end());
}

std::string BvhSkeletonBuilder::IdOf(absl::string_view name,
                                     absl::string_view what) {
  const std::string id = ids_.Take(PrintableUtf8(name));
  if (id != name) {
    import_.warnings.push_back(absl::StrCat(what, " \"", PrintableUtf8(name),
                                            "\" is called \"", id, "\""));
  }
  return id;
}

absl::Status CheckUnit(double unit_m) {
  if (unit_m >= kMinUnit && unit_m <= kMaxUnit) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat(
      "unit_m: want %g to %g, got %g", kMinUnit, kMaxUnit, unit_m));
}

}  // namespace

absl::StatusOr<BvhImport> ImportBvh(const BvhDocument& document,
                                    const BvhImportOptions& options) {
  if (document.joints.empty()) {
    return absl::InvalidArgumentError("joints: want at least one");
  }
  if (options.unit_m) {
    if (absl::Status status = CheckUnit(*options.unit_m); !status.ok()) {
      return status;
    }
  }
  const absl::StatusOr<BvhImport> in_units =
      BvhSkeletonBuilder(document, 1).Build(Eigen::Vector3d::UnitY());
  if (!in_units.ok()) return in_units.status();
  std::vector<std::string> warnings = document.warnings;

  double unit_m = options.unit_m.value_or(0);
  if (!options.unit_m) {
    UnitGuess guess =
        GuessUnit(document, *in_units->skeleton, in_units->mapping);
    unit_m = guess.unit_m;
    warnings.push_back(std::move(guess.reason));
  }
  UpGuess up = GuessUp(document, *in_units->skeleton, in_units->mapping);
  if (!up.reason.empty()) warnings.push_back(std::move(up.reason));

  absl::StatusOr<BvhImport> import =
      BvhSkeletonBuilder(document, unit_m).Build(up.up);
  if (!import.ok()) return import.status();
  import->warnings.insert(import->warnings.begin(),
                          std::make_move_iterator(warnings.begin()),
                          std::make_move_iterator(warnings.end()));
  return import;
}

}  // namespace gelenk

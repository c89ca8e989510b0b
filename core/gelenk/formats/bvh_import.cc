#include "gelenk/formats/bvh_import.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/formats/bvh_body.h"
#include "gelenk/formats/file_unit.h"
#include "gelenk/formats/unique_names.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {
namespace {

// Positions that move less than this, relative to the skeleton's size, are an
// exporter's rounding.
constexpr double kConstant = 1e-6;

struct ChannelRow {
  int row;
  BvhChannel channel;
};

// One joint of the skeleton and the channels that move it.
struct JointPlan {
  JointType type;
  std::vector<ChannelRow> rows;
};

bool IsFullRotation(const std::vector<ChannelRow>& rotations) {
  return rotations.size() == 3 &&
         ReachesEveryRotation({AxisOf(rotations[0].channel),
                               AxisOf(rotations[1].channel),
                               AxisOf(rotations[2].channel)});
}

// The joints that stand for one of the file. Translation comes before
// rotation, whatever the order of the channels.
std::vector<JointPlan> JointPlans(const std::vector<ChannelRow>& positions,
                                  const std::vector<ChannelRow>& rotations) {
  std::vector<JointPlan> plans;
  const bool is_full_rotation = IsFullRotation(rotations);
  if (positions.size() == 3 && is_full_rotation) {
    plans.push_back({JointType::kFree, positions});
    plans[0].rows.insert(plans[0].rows.end(), rotations.begin(),
                         rotations.end());
    return plans;
  }
  for (const ChannelRow& position : positions) {
    plans.push_back({JointType::kPrismatic, {position}});
  }
  if (is_full_rotation) {
    plans.push_back({JointType::kSpherical, rotations});
  } else {
    for (const ChannelRow& rotation : rotations) {
      plans.push_back({JointType::kRevolute, {rotation}});
    }
  }
  if (plans.empty()) plans.push_back({JointType::kFixed, {}});
  return plans;
}

// How far each row of the motion goes, in the file's unit or degrees.
Eigen::VectorXd RangeOfRows(const BvhDocument& document) {
  if (document.frame_count() == 0) {
    return Eigen::VectorXd::Zero(document.channel_count());
  }
  Eigen::VectorXd low = document.motion.col(0);
  Eigen::VectorXd high = low;
  for (int frame = 1; frame < document.frame_count(); ++frame) {
    low = low.cwiseMin(document.motion.col(frame));
    high = high.cwiseMax(document.motion.col(frame));
  }
  return high - low;
}

// The longest way from the root to a joint, in the file's unit. Exporters that
// give every joint positions may leave the OFFSETs zero, so the first frame
// counts.
double LongestWay(const BvhDocument& document) {
  std::vector<double> ways;
  int row = 0;
  for (const BvhJoint& joint : document.joints) {
    Eigen::Vector3d bone = joint.offset;
    for (BvhChannel channel : joint.channels) {
      if (IsPosition(channel) && document.frame_count() > 0) {
        bone[AxisOf(channel)] = document.motion(row, 0);
      }
      ++row;
    }
    ways.push_back(joint.parent < 0 ? 0 : ways[joint.parent] + bone.norm());
  }
  return *std::max_element(ways.begin(), ways.end());
}

// Which rows of the motion do not move.
std::vector<bool> ConstantRows(const BvhDocument& document) {
  const Eigen::VectorXd ranges = RangeOfRows(document);
  const double least = kConstant * LongestWay(document);
  std::vector<bool> constant(ranges.size());
  for (int i = 0; i < ranges.size(); ++i) constant[i] = ranges[i] <= least;
  return constant;
}

// Builds the skeleton and the mapping for one length of the unit.
class BvhSkeletonBuilder {
 public:
  BvhSkeletonBuilder(const BvhDocument& document,
                     const std::vector<bool>& constant_rows, double unit_m)
      : document_(document),
        constant_rows_(constant_rows),
        unit_m_(unit_m),
        ids_(kMaxIdBytes) {}

  absl::StatusOr<BvhImport> Build(const Eigen::Vector3d& up);

 private:
  void TakeJointIds();
  void AddFileJoint(int index, int first_row);
  void AddEndSites();

  // Takes positions that never move out of `positions` and into `offset`.
  void FoldConstants(std::vector<ChannelRow>& positions,
                     Eigen::Vector3d& offset);
  // Adds one joint and says which rows move it. `rest` is where a joint that
  // translates rests, in the file's unit.
  void AddJoint(const JointPlan& plan, const Eigen::Vector3d& rest,
                Joint joint);
  void MapScalar(const ChannelRow& row, double scale, double rest);
  void MapRotation(absl::Span<const ChannelRow> rows);

  const BvhDocument& document_;
  const std::vector<bool>& constant_rows_;
  const double unit_m_;
  UniqueNames ids_;
  // Of the file's joints.
  std::vector<std::string> joint_ids_;
  int joint_count_ = 0;
  // As long as the positions of the joints so far.
  std::vector<double> rest_positions_;
  SkeletonBuilder builder_;
  BvhImport import_;
};

absl::StatusOr<BvhImport> BvhSkeletonBuilder::Build(const Eigen::Vector3d& up) {
  TakeJointIds();
  int row = 0;
  for (size_t i = 0; i < document_.joints.size(); ++i) {
    AddFileJoint(static_cast<int>(i), row);
    row += static_cast<int>(document_.joints[i].channels.size());
  }
  AddEndSites();
  builder_.SetUp(up).SetRestPositions(Eigen::Map<const Eigen::VectorXd>(
      rest_positions_.data(), rest_positions_.size()));
  absl::StatusOr<std::shared_ptr<const Skeleton>> skeleton = builder_.Build();
  if (!skeleton.ok()) return skeleton.status();
  import_.skeleton = *std::move(skeleton);
  import_.unit_m = unit_m_;
  import_.mapping.channel_count = row;
  return std::move(import_);
}

// Before the joints of chains get theirs, so that the file's names go first.
void BvhSkeletonBuilder::TakeJointIds() {
  for (const BvhJoint& joint : document_.joints) {
    const std::string name = PrintableUtf8(joint.name);
    joint_ids_.push_back(ids_.Take(name));
    if (joint_ids_.back() == joint.name) continue;
    import_.warnings.push_back(absl::StrCat("joint \"", name, "\" is called \"",
                                            joint_ids_.back(), "\""));
  }
}

void BvhSkeletonBuilder::AddFileJoint(int index, int first_row) {
  const BvhJoint& file_joint = document_.joints[index];
  std::vector<ChannelRow> positions;
  std::vector<ChannelRow> rotations;
  int row = first_row;
  for (BvhChannel channel : file_joint.channels) {
    (IsPosition(channel) ? positions : rotations).push_back({row++, channel});
  }
  Eigen::Vector3d offset = file_joint.offset;
  const bool is_root = file_joint.parent < 0;
  if (!is_root) FoldConstants(positions, offset);
  // What moves is in the coordinates, not in the offset.
  for (const ChannelRow& position : positions) {
    offset[AxisOf(position.channel)] = 0;
  }

  const std::string& id = joint_ids_[index];
  std::string parent_id = is_root ? "" : joint_ids_[file_joint.parent];
  const std::vector<JointPlan> plans = JointPlans(positions, rotations);
  for (size_t i = 0; i < plans.size(); ++i) {
    Joint joint;
    joint.parent_id = std::move(parent_id);
    if (i == 0) joint.parent_from_joint.translation = unit_m_ * offset;
    if (i + 1 == plans.size()) {
      joint.id = id;
    } else {
      const absl::string_view channel =
          BvhChannelName(plans[i].rows[0].channel);
      joint.id = ids_.Take(absl::StrCat(
          TruncateUtf8(id, kMaxIdBytes - 1 - channel.size()), ".", channel));
    }
    parent_id = joint.id;
    AddJoint(plans[i], file_joint.offset, std::move(joint));
  }
  import_.joints.push_back(joint_count_ - 1);
}

void BvhSkeletonBuilder::FoldConstants(std::vector<ChannelRow>& positions,
                                       Eigen::Vector3d& offset) {
  for (const ChannelRow& position : positions) {
    if (!constant_rows_[position.row]) return;
  }
  for (const ChannelRow& position : positions) {
    double& component = offset[AxisOf(position.channel)];
    if (document_.frame_count() > 0) {
      component = document_.motion(position.row, 0);
    }
    import_.mapping.constants.push_back({position.row, component});
  }
  positions.clear();
}

void BvhSkeletonBuilder::AddJoint(const JointPlan& plan,
                                  const Eigen::Vector3d& rest, Joint joint) {
  const std::vector<ChannelRow>& rows = plan.rows;
  joint.type = plan.type;
  switch (plan.type) {
    case JointType::kFree: {
      // Coordinates are in the order of the axes, channels in any.
      const int first = static_cast<int>(rest_positions_.size());
      for (int i = 0; i < 3; ++i) {
        const int axis = AxisOf(rows[i].channel);
        import_.mapping.scalars.push_back({rows[i].row, first + axis, unit_m_});
        rest_positions_.push_back(unit_m_ * rest[i]);
      }
      MapRotation(absl::MakeConstSpan(rows).subspan(3));
      break;
    }
    case JointType::kSpherical:
      MapRotation(rows);
      break;
    case JointType::kPrismatic:
      joint.axis = Eigen::Vector3d::Unit(AxisOf(rows[0].channel));
      MapScalar(rows[0], unit_m_, unit_m_ * rest.dot(joint.axis));
      break;
    case JointType::kRevolute:
      joint.axis = Eigen::Vector3d::Unit(AxisOf(rows[0].channel));
      MapScalar(rows[0], kRadPerDegree, 0);
      break;
    case JointType::kFixed:
    case JointType::kPlanar:
      break;
  }
  builder_.AddJoint(std::move(joint));
  ++joint_count_;
}

void BvhSkeletonBuilder::MapScalar(const ChannelRow& row, double scale,
                                   double rest) {
  import_.mapping.scalars.push_back(
      {row.row, static_cast<int>(rest_positions_.size()), scale});
  rest_positions_.push_back(rest);
}

void BvhSkeletonBuilder::MapRotation(absl::Span<const ChannelRow> rows) {
  BvhRotation rotation;
  for (int i = 0; i < 3; ++i) {
    rotation.channels[i] = rows[i].row;
    rotation.axes[i] = AxisOf(rows[i].channel);
  }
  rotation.position = static_cast<int>(rest_positions_.size());
  import_.mapping.rotations.push_back(rotation);
  rest_positions_.insert(rest_positions_.end(), {0, 0, 0, 1});
}

void BvhSkeletonBuilder::AddEndSites() {
  constexpr absl::string_view kSuffix = ".end";
  for (size_t i = 0; i < document_.joints.size(); ++i) {
    for (const BvhEndSite& site : document_.joints[i].end_sites) {
      EndEffector effector;
      effector.joint_id = joint_ids_[i];
      effector.joint_from_end_effector.translation = unit_m_ * site.offset;
      std::string name = PrintableUtf8(site.name);
      const bool fits = !name.empty() && name.size() <= kMaxIdBytes;
      if (!fits || ids_.Contains(name)) {
        name = absl::StrCat(
            TruncateUtf8(joint_ids_[i], kMaxIdBytes - kSuffix.size()), kSuffix);
      }
      effector.id = ids_.Take(name);
      builder_.AddEndEffector(std::move(effector));
    }
  }
}

}  // namespace

absl::StatusOr<BvhImport> ImportBvh(const BvhDocument& document,
                                    const BvhImportOptions& options) {
  if (document.joints.empty()) {
    return absl::InvalidArgumentError("joints: want at least one");
  }
  if (options.unit_m) {
    if (absl::Status status = CheckFileUnit(*options.unit_m); !status.ok()) {
      return status;
    }
  }
  const std::vector<bool> constant_rows = ConstantRows(document);
  const absl::StatusOr<BvhImport> in_units =
      BvhSkeletonBuilder(document, constant_rows, 1)
          .Build(Eigen::Vector3d::UnitY());
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
      BvhSkeletonBuilder(document, constant_rows, unit_m).Build(up.up);
  if (!import.ok()) return import.status();
  import->warnings.insert(import->warnings.begin(),
                          std::make_move_iterator(warnings.begin()),
                          std::make_move_iterator(warnings.end()));
  return import;
}

}  // namespace gelenk

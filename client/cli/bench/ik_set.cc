#include "client/cli/bench/ik_set.h"

#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk::cli {
namespace {

// Columns `prefix`0, `prefix`1, ... without a gap.
std::vector<int> NumberedColumns(const NumberTable& table,
                                 absl::string_view prefix) {
  std::vector<int> columns;
  for (int i = 0;; ++i) {
    const int column = table.FindColumn(absl::StrCat(prefix, i));
    if (column < 0) return columns;
    columns.push_back(column);
  }
}

absl::StatusOr<std::vector<EffectorFrame>> FindTips(
    const Skeleton& skeleton, const std::vector<std::string>& tips) {
  std::vector<EffectorFrame> frames;
  for (const std::string& tip : tips) {
    const std::optional<EffectorFrame> frame = skeleton.FindEffector(tip);
    if (!frame) {
      return absl::InvalidArgumentError(
          absl::StrCat("--tip: the skeleton has no end effector or joint \"",
                       absl::CHexEscape(tip), "\""));
    }
    frames.push_back(*frame);
  }
  return frames;
}

// The numbers of q of joints that move one of `tips`, or of all joints.
std::vector<int> Coordinates(const Skeleton& skeleton,
                             const std::vector<EffectorFrame>& tips,
                             bool all_joints) {
  std::vector<bool> moves(skeleton.joint_count(), all_joints);
  for (const EffectorFrame& tip : tips) {
    for (int j = tip.joint; j >= 0; j = skeleton.span(j).parent) {
      const int mimicked = skeleton.span(j).mimicked;
      moves[mimicked < 0 ? j : mimicked] = true;
    }
  }
  std::vector<int> coordinates;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int offset = skeleton.span(j).position_offset;
    if (!moves[j] || offset < 0) continue;
    const int count = PositionCount(skeleton.joint(j).type);
    for (int k = 0; k < count; ++k) coordinates.push_back(offset + k);
  }
  return coordinates;
}

std::vector<std::string> CoordinateNames(const Skeleton& skeleton,
                                         const std::vector<int>& coordinates) {
  std::vector<std::string> names(skeleton.position_count());
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int offset = skeleton.span(j).position_offset;
    if (offset < 0) continue;
    const int count = PositionCount(skeleton.joint(j).type);
    for (int k = 0; k < count; ++k) {
      const std::string& id = skeleton.joint(j).id;
      names[offset + k] = count == 1 ? id : absl::StrCat(id, ".", k);
    }
  }
  std::vector<std::string> chosen;
  chosen.reserve(coordinates.size());
  for (int coordinate : coordinates) chosen.push_back(names[coordinate]);
  return chosen;
}

Eigen::VectorXd MidRange(const Skeleton& skeleton) {
  Eigen::VectorXd middle = NeutralPositions(skeleton);
  const PositionBounds& bounds = skeleton.position_bounds();
  for (Eigen::Index i = 0; i < middle.size(); ++i) {
    if (std::isfinite(bounds.lower[i]) && std::isfinite(bounds.upper[i])) {
      middle[i] = 0.5 * (bounds.lower[i] + bounds.upper[i]);
    }
  }
  return middle;
}

class SetMaker {
 public:
  SetMaker(const NumberTable& table, std::vector<EffectorFrame> tips,
           IkSet* set)
      : table_(table), tips_(std::move(tips)), set_(*set) {}

  absl::Status Make(BenchStart start) {
    absl::Status status = ReadTargets();
    if (status.ok()) status = ReadStarts(start);
    return status;
  }

 private:
  // Which columns hold a pose. The first tip's names need no number.
  struct PoseColumns {
    std::vector<int> position;
    std::vector<int> rotation;
  };

  PoseColumns FindPose(size_t tip) const {
    PoseColumns columns;
    const auto find = [&](absl::string_view name, std::vector<int>& out) {
      int column = table_.FindColumn(absl::StrCat(name, tip));
      if (column < 0 && tip == 0) column = table_.FindColumn(name);
      if (column >= 0) out.push_back(column);
    };
    for (const char* name : {"px", "py", "pz"}) find(name, columns.position);
    for (const char* name : {"qx", "qy", "qz", "qw"}) {
      find(name, columns.rotation);
    }
    return columns;
  }

  absl::Status ReadTargets() {
    std::vector<PoseColumns> columns;
    for (size_t t = 0; t < tips_.size(); ++t) columns.push_back(FindPose(t));
    const std::vector<int> values = NumberedColumns(table_, "q");
    set_.coordinates = Coordinates(
        *set_.skeleton, tips_,
        static_cast<int>(values.size()) == set_.skeleton->position_count());
    bool poses = true;
    for (const PoseColumns& pose : columns) {
      poses = poses && pose.position.size() == 3;
    }
    if (!poses && values.empty()) {
      return absl::InvalidArgumentError(
          "want columns q0, q1, ... or px, py, pz (and qx, qy, qz, qw) for "
          "each tip");
    }
    for (const PoseColumns& pose : columns) {
      if (poses && pose.rotation.size() != 4) set_.goal = BenchGoal::kPosition;
    }
    for (int row = 0; row < table_.row_count(); ++row) {
      absl::Status status =
          poses ? ReadPoses(columns, row) : ReadValues(values, row);
      if (!status.ok()) return status;
    }
    return absl::OkStatus();
  }

  absl::Status ReadPoses(const std::vector<PoseColumns>& columns, int row) {
    const double* cells = table_.row(row);
    for (const PoseColumns& pose : columns) {
      RigidTransform target;
      for (int k = 0; k < 3; ++k) {
        target.translation[k] = cells[pose.position[k]];
      }
      if (set_.goal == BenchGoal::kPose) {
        double xyzw[4];
        for (int k = 0; k < 4; ++k) xyzw[k] = cells[pose.rotation[k]];
        if (!NormalizeNearUnit(xyzw)) {
          return absl::InvalidArgumentError(absl::StrCat(
              "row ", row + 1, ": qx, qy, qz, qw is no unit quaternion: ",
              cells[pose.rotation[0]], ", ", cells[pose.rotation[1]], ", ",
              cells[pose.rotation[2]], ", ", cells[pose.rotation[3]]));
        }
        target.rotation = QuaternionXyzw(xyzw);
      }
      set_.targets.push_back(target);
    }
    return absl::OkStatus();
  }

  // The pose with the coordinates of one row. `base` is what the other joints
  // have.
  absl::StatusOr<Eigen::VectorXd> ReadPositions(const std::vector<int>& columns,
                                                absl::string_view prefix,
                                                int row) const {
    if (columns.size() != set_.coordinates.size()) {
      return absl::InvalidArgumentError(absl::StrCat(
          "want ", set_.coordinates.size(), " columns ", prefix, "0, ", prefix,
          "1, ... (movable joints from the root to the tips), or ",
          set_.skeleton->position_count(), " (all), got ", columns.size()));
    }
    Eigen::VectorXd positions = MidRange(*set_.skeleton);
    for (size_t i = 0; i < columns.size(); ++i) {
      positions[set_.coordinates[i]] = table_.row(row)[columns[i]];
    }
    if (absl::Status status = CheckPositions(*set_.skeleton, positions);
        !status.ok()) {
      return absl::InvalidArgumentError(
          absl::StrCat("row ", row + 1, ": ", status.message()));
    }
    return positions;
  }

  absl::Status ReadValues(const std::vector<int>& columns, int row) {
    const absl::StatusOr<Eigen::VectorXd> positions =
        ReadPositions(columns, "q", row);
    if (!positions.ok()) return positions.status();
    ForwardKinematics(*set_.skeleton, *positions, frames_);
    for (const EffectorFrame& tip : tips_) {
      set_.targets.push_back(frames_[tip.joint] * tip.joint_from_effector);
    }
    return absl::OkStatus();
  }

  absl::Status ReadStarts(BenchStart start) {
    if (start == BenchStart::kCold) {
      set_.starts = MidRange(*set_.skeleton);
      return absl::OkStatus();
    }
    const std::vector<int> columns = NumberedColumns(table_, "warm");
    if (columns.empty()) {
      return absl::InvalidArgumentError(
          "--start warm: want columns warm0, warm1, ...");
    }
    // A table of poses has no q columns that would say which joints count.
    if (NumberedColumns(table_, "q").empty() &&
        static_cast<int>(columns.size()) == set_.skeleton->position_count()) {
      set_.coordinates = Coordinates(*set_.skeleton, tips_, true);
    }
    set_.starts.resize(set_.skeleton->position_count(), table_.row_count());
    for (int row = 0; row < table_.row_count(); ++row) {
      const absl::StatusOr<Eigen::VectorXd> positions =
          ReadPositions(columns, "warm", row);
      if (!positions.ok()) return positions.status();
      set_.starts.col(row) = *positions;
    }
    return absl::OkStatus();
  }

  const NumberTable& table_;
  const std::vector<EffectorFrame> tips_;
  IkSet& set_;
  WorldTransforms frames_;
};

}  // namespace

absl::StatusOr<IkSet> MakeIkSet(std::shared_ptr<const Skeleton> skeleton,
                                const std::vector<std::string>& tips,
                                const NumberTable& table, BenchStart start,
                                BenchGoal goal) {
  IkSet set;
  set.skeleton = std::move(skeleton);
  set.goal = goal;
  absl::StatusOr<std::vector<EffectorFrame>> frames =
      FindTips(*set.skeleton, tips);
  if (!frames.ok()) return frames.status();
  const absl::Status status =
      SetMaker(table, *std::move(frames), &set).Make(start);
  if (!status.ok()) return status;
  for (size_t t = 0; t < tips.size(); ++t) {
    Goal one;
    one.id = absl::StrCat(tips[t], "#", t);
    if (set.goal == BenchGoal::kPose) {
      PoseGoal pose;
      pose.end_effector_id = tips[t];
      pose.world_pose = set.targets[t];
      one.kind = pose;
    } else {
      PositionGoal position;
      position.end_effector_id = tips[t];
      position.world_position = set.targets[t].translation;
      one.kind = position;
    }
    set.goals.push_back(std::move(one));
  }
  set.coordinate_names = CoordinateNames(*set.skeleton, set.coordinates);
  return set;
}

}  // namespace gelenk::cli

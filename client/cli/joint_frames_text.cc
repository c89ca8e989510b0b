#include "client/cli/joint_frames_text.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/text/table.h"

namespace gelenk::cli {
namespace {

constexpr int kDecimals = 4;

std::vector<double> PositionsOf(const Skeleton& skeleton, int joint,
                                const v1::Pose& pose) {
  const int first = skeleton.span(joint).position_offset;
  if (first < 0) return {};
  const int count = PositionCount(skeleton.joint(joint).type);
  const auto begin = pose.positions().begin() + first;
  return {begin, begin + count};
}

}  // namespace

std::string JointFramesText(const Skeleton& skeleton,
                            const v1::JointFrames& frames) {
  std::vector<Column> columns = {{"JOINT"}};
  for (const char* title :
       {"X (m)", "Y (m)", "Z (m)", "QX", "QY", "QZ", "QW"}) {
    columns.push_back({title, Align::kRight});
  }
  Table table(columns);
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    std::vector<std::string> cells = {skeleton.joint(i).id};
    for (int k = 0; k < 3; ++k) {
      cells.push_back(Fixed(frames.world_translations(3 * i + k), kDecimals));
    }
    for (int k = 0; k < 4; ++k) {
      cells.push_back(Fixed(frames.world_rotations(4 * i + k), kDecimals));
    }
    table.AddRow(std::move(cells));
  }
  return table.ToString();
}

Json JointFramesJson(const Skeleton& skeleton, const v1::JointFrames& frames) {
  Json joints = Json::array();
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    Json joint;
    joint["id"] = skeleton.joint(i).id;
    for (int k = 0; k < 3; ++k) {
      joint["world_translation_m"].push_back(
          frames.world_translations(3 * i + k));
    }
    for (int k = 0; k < 4; ++k) {
      joint["world_rotation_xyzw"].push_back(frames.world_rotations(4 * i + k));
    }
    joints.push_back(std::move(joint));
  }
  return joints;
}

std::string PoseText(const Skeleton& skeleton, const v1::Pose& pose) {
  Table table({{"JOINT"}, {"TYPE"}, {"POSITION (rad, m, x y z w)"}});
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    std::string numbers;
    for (double number : PositionsOf(skeleton, i, pose)) {
      absl::StrAppend(&numbers, numbers.empty() ? "" : " ",
                      Fixed(number, kDecimals));
    }
    if (numbers.empty()) continue;
    table.AddRow({skeleton.joint(i).id,
                  std::string(JointTypeName(skeleton.joint(i).type)), numbers});
  }
  return table.ToString();
}

Json PoseJson(const Skeleton& skeleton, const v1::Pose& pose) {
  Json joints = Json::array();
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const std::vector<double> positions = PositionsOf(skeleton, i, pose);
    if (positions.empty()) continue;
    joints.push_back(
        {{"id", skeleton.joint(i).id},
         {"type", std::string(JointTypeName(skeleton.joint(i).type))},
         {"position", positions}});
  }
  return joints;
}

}  // namespace gelenk::cli

#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "client/cli/info/inspection.h"
#include "client/cli/text/table.h"

namespace gelenk::cli {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

std::string Text(const Eigen::Vector3d& v, int decimals) {
  return absl::StrCat(Fixed(v.x(), decimals), " ", Fixed(v.y(), decimals), " ",
                      Fixed(v.z(), decimals));
}

std::string UpText(const Eigen::Vector3d& up) {
  constexpr absl::string_view kAxes[] = {"X", "Y", "Z"};
  for (int axis = 0; axis < 3; ++axis) {
    if (up == Eigen::Vector3d::Unit(axis))
      return absl::StrCat("+", kAxes[axis]);
    if (up == -Eigen::Vector3d::Unit(axis)) {
      return absl::StrCat("-", kAxes[axis]);
    }
  }
  return Text(up, 3);
}

std::string BodyText(const Skeleton& skeleton, const BodyParts& body) {
  if (body.evidence == BodyParts::Evidence::kNone) return "none found";
  std::vector<std::string> parts;
  for (const NamedPart& part : PartsOf(body)) {
    if (part.joint < 0) continue;
    parts.push_back(absl::StrCat(absl::StrReplaceAll(part.name, {{"_", " "}}),
                                 " ", skeleton.joint(part.joint).id));
  }
  return absl::StrCat(absl::StrJoin(parts, ", "), " (by ",
                      EvidenceName(body.evidence), ")");
}

bool IsLimited(const Joint& joint) {
  return !joint.limits.lower.empty() || joint.limits.HasRotationLimits();
}

std::string LimitsText(const Skeleton& skeleton) {
  int limited = 0;
  for (const Joint& joint : skeleton.joints()) limited += IsLimited(joint);
  return limited == 0 ? "none"
                      : absl::StrFormat("%d of %d joints", limited,
                                        skeleton.joint_count());
}

// Past this a list says less than its length.
constexpr size_t kMaxListedTips = 12;

std::string TipsText(const std::vector<std::string>& tips) {
  if (tips.size() <= kMaxListedTips) return absl::StrJoin(tips, ", ");
  return absl::StrCat(
      absl::StrJoin(tips.begin(), tips.begin() + kMaxListedTips, ", "),
      ", and ", tips.size() - kMaxListedTips, " more");
}

std::string BoundText(double bound) {
  return std::isfinite(bound) ? Significant(bound, 4) : "any";
}

// "-1.5 to 1.5 rad, 2 rad/s", or what a mimic follows.
std::string JointLimitsText(const Joint& joint) {
  if (joint.mimic) {
    const Mimic& mimic = *joint.mimic;
    return absl::StrCat(
        "= ", Significant(mimic.multiplier, 4), " * ", mimic.joint_id,
        mimic.offset == 0
            ? ""
            : absl::StrCat(mimic.offset < 0 ? " - " : " + ",
                           Significant(std::abs(mimic.offset), 4)));
  }
  const JointLimits& limits = joint.limits;
  if (joint.type != JointType::kRevolute &&
      joint.type != JointType::kPrismatic) {
    return IsLimited(joint) ? "limited" : "";
  }
  const absl::string_view unit =
      joint.type == JointType::kRevolute ? "rad" : "m";
  std::string text = limits.lower.empty()
                         ? "any"
                         : absl::StrCat(BoundText(limits.lower[0]), " to ",
                                        BoundText(limits.upper[0]), " ", unit);
  if (!limits.max_velocity.empty()) {
    absl::StrAppend(&text, ", ", Significant(limits.max_velocity[0], 4), " ",
                    unit, "/s");
  }
  return text;
}

void AddClip(const Inspection& inspection, Facts& facts) {
  const BvhClip& clip = *inspection.file->clip;
  facts.Add("unit", absl::StrCat(Significant(clip.import.unit_m, 5), " m"));
  const double frame_time_s = clip.document.frame_time_s;
  facts.Add("frames",
            absl::StrFormat("%d, %s s at %s fps", clip.frame_count(),
                            Significant(frame_time_s * clip.frame_count(), 4),
                            Significant(1 / frame_time_s, 4)));
  if (!inspection.first_frame_jump) return;
  const FirstFrameJump& jump = *inspection.first_frame_jump;
  facts.Add("first frame",
            absl::StrFormat("no part of the motion: joint %s jumps by %.0f° "
                            "out of it",
                            inspection.file->skeleton->joint(jump.joint).id,
                            jump.angle_rad / kDegree));
}

std::string FactsText(const Inspection& inspection) {
  const Skeleton& skeleton = *inspection.file->skeleton;
  Facts facts;
  facts.Add("file", inspection.file->path);
  facts.Add("joints",
            absl::StrFormat("%d, %d degrees of freedom, pose of %d "
                            "numbers",
                            skeleton.joint_count(), skeleton.velocity_count(),
                            skeleton.position_count()));
  facts.Add(inspection.file->clip ? "end sites" : "end effectors",
            absl::StrCat(skeleton.end_effectors().size()));
  facts.Add("tips", TipsText(inspection.tips));
  facts.Add("limits", LimitsText(skeleton));
  facts.Add("up", UpText(skeleton.up()));
  facts.Add("body", BodyText(skeleton, inspection.body));
  if (inspection.height_m) {
    facts.Add("height", absl::StrCat(Fixed(*inspection.height_m, 3), " m"));
  }
  if (inspection.file->clip) AddClip(inspection, facts);
  return facts.ToString();
}

// The nodes of the tree that hang from each joint: joints, then end effectors
// with a line of their own.
struct Children {
  std::vector<int> joints;
  std::vector<const EndEffector*> end_effectors;
};

std::vector<Children> ChildrenOf(const SkeletonFile& file) {
  const Skeleton& skeleton = *file.skeleton;
  std::vector<Children> children(skeleton.joint_count());
  for (int i = 1; i < skeleton.joint_count(); ++i) {
    children[skeleton.span(i).parent].joints.push_back(i);
  }
  for (const EndEffector& effector : skeleton.end_effectors()) {
    // Links of a robot stand in their joint's line.
    if (!file.clip && SharesItsJointsFrame(effector)) continue;
    children[skeleton.FindJoint(effector.joint_id)].end_effectors.push_back(
        &effector);
  }
  return children;
}

// "Zrotation Yrotation Xrotation" as "Zrot Yrot Xrot".
std::string ShortChannels(const std::vector<std::string>& channels) {
  return absl::StrReplaceAll(absl::StrJoin(channels, " "),
                             {{"osition", "os"}, {"otation", "ot"}});
}

// Writes the tree line by line, without recursion: files may be deep.
class TreeTable {
 public:
  explicit TreeTable(const Inspection& inspection)
      : inspection_(inspection),
        skeleton_(*inspection.file->skeleton),
        children_(ChildrenOf(*inspection.file)),
        has_clip_(inspection.file->clip.has_value()),
        table_({{"JOINT"},
                {"TYPE"},
                {has_clip_ ? "CHANNELS" : "LIMITS"},
                {"OFFSET (m)"},
                {has_clip_ ? "" : "END EFFECTOR"}}) {}

  std::string ToString() {
    struct Line {
      int joint;
      std::string branch;
      std::string below;
    };
    std::vector<Line> waiting = {{0, "", ""}};
    while (!waiting.empty()) {
      const Line line = waiting.back();
      waiting.pop_back();
      AddJoint(line.joint, line.branch);
      const Children& children = children_[line.joint];
      AddEndEffectors(children, line.below);
      for (size_t i = children.joints.size(); i-- > 0;) {
        const bool last = i + 1 == children.joints.size();
        waiting.push_back({children.joints[i],
                           absl::StrCat(line.below, last ? "└ " : "├ "),
                           absl::StrCat(line.below, last ? "  " : "│ ")});
      }
    }
    return table_.ToString();
  }

 private:
  void AddJoint(int index, const std::string& branch) {
    const Joint& joint = skeleton_.joint(index);
    table_.AddRow(
        {absl::StrCat(branch, joint.id), std::string(JointTypeName(joint.type)),
         has_clip_ ? ShortChannels(inspection_.channels[index])
                   : JointLimitsText(joint),
         Text(joint.parent_from_joint.translation, 4),
         has_clip_ ? "" : absl::StrJoin(EffectorsAt(skeleton_, index), ", ")});
  }

  void AddEndEffectors(const Children& children, const std::string& below) {
    for (size_t i = 0; i < children.end_effectors.size(); ++i) {
      const EndEffector& effector = *children.end_effectors[i];
      const bool last =
          children.joints.empty() && i + 1 == children.end_effectors.size();
      table_.AddRow({absl::StrCat(below, last ? "└ " : "├ ", effector.id),
                     has_clip_ ? "end site" : "end effector", "",
                     Text(effector.joint_from_end_effector.translation, 4)});
    }
  }

  const Inspection& inspection_;
  const Skeleton& skeleton_;
  const std::vector<Children> children_;
  const bool has_clip_;
  Table table_;
};

}  // namespace

std::string InspectionText(const Inspection& inspection) {
  std::string text = FactsText(inspection);
  absl::StrAppend(&text, "\n", TreeTable(inspection).ToString());
  const auto& warnings = inspection.file->message.warnings();
  if (!warnings.empty()) absl::StrAppend(&text, "\nwarnings\n");
  for (const std::string& warning : warnings) {
    absl::StrAppend(&text, "  ", warning, "\n");
  }
  return text;
}

}  // namespace gelenk::cli

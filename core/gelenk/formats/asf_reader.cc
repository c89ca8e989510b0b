#include "gelenk/formats/asf_reader.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "gelenk/formats/asf_scanner.h"
#include "gelenk/formats/unique_names.h"

namespace gelenk {
namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180;
// As long as a direction may be of unit length for six digits in a file.
constexpr double kUnitSlack = 1e-3;

#define GELENK_RETURN_IF_ERROR(expression) \
  if (absl::Status status = (expression); !status.ok()) return status

std::string Quoted(absl::string_view name) {
  return absl::StrCat("\"", absl::CHexEscape(TruncateUtf8(name, 64)), "\"");
}

// "rx" is Xrotation; nothing for what is none.
bool DofOf(absl::string_view text, BvhChannel* channel) {
  constexpr absl::string_view kNames[] = {"tx", "ty", "tz", "rx", "ry", "rz"};
  for (int i = 0; i < 6; ++i) {
    if (!absl::EqualsIgnoreCase(text, kNames[i])) continue;
    *channel = static_cast<BvhChannel>(i);
    return true;
  }
  return false;
}

class AsfParser {
 public:
  AsfParser(absl::string_view text, const BvhBounds& bounds)
      : bounds_(bounds), scanner_(text) {
    document_.bones.push_back({.name = "root"});
    index_of_name_["root"] = 0;
    parents_.push_back(-1);
  }

  absl::StatusOr<AsfDocument> Parse();

 private:
  absl::Status ReadSection();
  absl::Status ReadUnits();
  absl::Status ReadRoot();
  absl::Status ReadBones();
  absl::Status ReadBone();
  absl::Status ReadBoneField(AsfBone& bone);
  absl::Status ReadHierarchy();
  absl::Status ReadChildren();
  absl::Status SkipLimits();

  absl::Status ReadVector(Eigen::Vector3d& vector);
  absl::Status ReadAxisOrder(EulerAxes& axes);
  absl::Status ReadDofs(bool is_root, std::vector<BvhChannel>& dofs);
  absl::StatusOr<int> FindBone(absl::string_view name);
  // Bones in the order of the tree, parents first.
  absl::Status Sort();

  bool TakeKeyword(absl::string_view keyword) {
    scanner_.SkipToToken();
    return scanner_.TakeKeyword(keyword);
  }
  void Warn(absl::string_view text) { document_.warnings.emplace_back(text); }

  const BvhBounds bounds_;
  AsfScanner scanner_;
  AsfDocument document_;
  bool has_root_ = false;
  bool has_bones_ = false;
  bool has_hierarchy_ = false;
  bool has_limits_ = false;
  absl::flat_hash_map<std::string, int> index_of_name_;
  // By bone in file order; -1 for those without one so far.
  std::vector<int> parents_;
};

absl::StatusOr<AsfDocument> AsfParser::Parse() {
  for (scanner_.SkipToToken(); !scanner_.AtEnd(); scanner_.SkipToToken()) {
    GELENK_RETURN_IF_ERROR(ReadSection());
  }
  if (!has_root_) return scanner_.Expected("a section :root");
  if (!has_bones_) return scanner_.Expected("a section :bonedata");
  if (!has_hierarchy_) return scanner_.Expected("a section :hierarchy");
  GELENK_RETURN_IF_ERROR(Sort());
  if (has_limits_) Warn("limits of bones are not read");
  if (document_.is_in_degrees) {
    for (AsfBone& bone : document_.bones) bone.axis_rad *= kRadPerDegree;
  }
  return std::move(document_);
}

absl::Status AsfParser::ReadSection() {
  if (!scanner_.IsAtSection()) return scanner_.Expected("a section");
  if (TakeKeyword(":version")) return scanner_.TakeNumber().status();
  if (TakeKeyword(":name")) {
    scanner_.SkipLine();
    return absl::OkStatus();
  }
  if (TakeKeyword(":units")) return ReadUnits();
  if (TakeKeyword(":root")) return ReadRoot();
  if (TakeKeyword(":bonedata")) return ReadBones();
  if (TakeKeyword(":hierarchy")) return ReadHierarchy();
  const bool is_known =
      absl::EqualsIgnoreCase(scanner_.Peek(), ":documentation");
  if (!is_known) {
    Warn(absl::StrCat("section ", Quoted(scanner_.Peek()), " is not read"));
  }
  do {
    scanner_.SkipLine();
    scanner_.SkipToToken();
  } while (!scanner_.IsAtSection() && !scanner_.AtEnd());
  return absl::OkStatus();
}

absl::Status AsfParser::ReadUnits() {
  while (!scanner_.IsAtSection() && !scanner_.AtEnd()) {
    if (TakeKeyword("angle")) {
      if (TakeKeyword("deg")) {
        document_.is_in_degrees = true;
      } else if (TakeKeyword("rad")) {
        document_.is_in_degrees = false;
      } else {
        return scanner_.Expected("deg or rad");
      }
      continue;
    }
    if (!TakeKeyword("mass") && !TakeKeyword("length")) {
      return scanner_.Expected("mass, length or angle");
    }
    // What a unit is in others of an unknown kind.
    GELENK_RETURN_IF_ERROR(scanner_.TakeNumber().status());
  }
  return absl::OkStatus();
}

absl::Status AsfParser::ReadRoot() {
  if (has_root_) return scanner_.Expected("one section :root");
  has_root_ = true;
  AsfBone& root = document_.bones[0];
  while (!scanner_.IsAtSection() && !scanner_.AtEnd()) {
    if (TakeKeyword("order")) {
      GELENK_RETURN_IF_ERROR(ReadDofs(true, root.dofs));
    } else if (TakeKeyword("axis")) {
      GELENK_RETURN_IF_ERROR(ReadAxisOrder(root.axis_order));
    } else if (TakeKeyword("position")) {
      GELENK_RETURN_IF_ERROR(ReadVector(document_.root_position));
    } else if (TakeKeyword("orientation")) {
      GELENK_RETURN_IF_ERROR(ReadVector(root.axis_rad));
    } else {
      return scanner_.Expected("order, axis, position or orientation");
    }
  }
  return absl::OkStatus();
}

absl::Status AsfParser::ReadBones() {
  if (has_bones_) return scanner_.Expected("one section :bonedata");
  has_bones_ = true;
  while (!scanner_.IsAtSection() && !scanner_.AtEnd()) {
    if (!TakeKeyword("begin")) return scanner_.Expected("begin");
    GELENK_RETURN_IF_ERROR(ReadBone());
  }
  return absl::OkStatus();
}

absl::Status AsfParser::ReadBone() {
  if (static_cast<int>(document_.bones.size()) >= bounds_.max_joints) {
    return scanner_.Expected(
        absl::StrCat("at most ", bounds_.max_joints, " bones"));
  }
  AsfBone bone;
  while (!TakeKeyword("end")) {
    GELENK_RETURN_IF_ERROR(ReadBoneField(bone));
  }
  if (bone.name.empty()) return scanner_.Expected("a name of the bone before");
  const double norm = bone.direction.norm();
  if (bone.length > 0 && !(norm > 0)) {
    return scanner_.Expected(
        absl::StrCat("a direction of bone ", Quoted(bone.name)));
  }
  if (norm > 0) {
    if (std::abs(norm - 1) > kUnitSlack) {
      Warn(absl::StrCat("the direction of bone ", Quoted(bone.name),
                        " is of length ", norm, ", taken as 1"));
    }
    bone.direction /= norm;
  }
  const int index = static_cast<int>(document_.bones.size());
  if (!index_of_name_.emplace(bone.name, index).second) {
    return scanner_.Expected(
        absl::StrCat("no second bone ", Quoted(bone.name)));
  }
  document_.bones.push_back(std::move(bone));
  parents_.push_back(-1);
  return absl::OkStatus();
}

absl::Status AsfParser::ReadBoneField(AsfBone& bone) {
  if (TakeKeyword("id")) return scanner_.TakeCount().status();
  if (TakeKeyword("name")) {
    scanner_.SkipToToken();
    const absl::string_view name = scanner_.Peek();
    if (name.empty() || name.size() > bounds_.max_name_bytes) {
      return scanner_.Expected("a name");
    }
    bone.name = std::string(scanner_.Take());
    return absl::OkStatus();
  }
  if (TakeKeyword("direction")) return ReadVector(bone.direction);
  if (TakeKeyword("length")) {
    const absl::StatusOr<double> length = scanner_.TakeNumber();
    if (!length.ok()) return length.status();
    if (*length < 0) return scanner_.Expected("a length >= 0 before this");
    bone.length = *length;
    return absl::OkStatus();
  }
  if (TakeKeyword("axis")) {
    GELENK_RETURN_IF_ERROR(ReadVector(bone.axis_rad));
    return ReadAxisOrder(bone.axis_order);
  }
  if (TakeKeyword("dof")) return ReadDofs(false, bone.dofs);
  if (TakeKeyword("limits")) return SkipLimits();
  if (TakeKeyword("bodymass") || TakeKeyword("cofmass")) {
    return scanner_.TakeNumber().status();
  }
  return scanner_.Expected(
      "id, name, direction, length, axis, dof, limits or end");
}

absl::Status AsfParser::SkipLimits() {
  has_limits_ = true;
  scanner_.SkipToToken();
  while (absl::StartsWith(scanner_.Peek(), "(")) {
    // "(-160.0 20.0)", with or without blanks about the numbers.
    while (!absl::EndsWith(scanner_.Peek(), ")")) {
      if (scanner_.Peek().empty()) return scanner_.Expected("\")\"");
      scanner_.Take();
    }
    scanner_.Take();
    scanner_.SkipToToken();
  }
  return absl::OkStatus();
}

absl::Status AsfParser::ReadVector(Eigen::Vector3d& vector) {
  for (double& number : vector) {
    const absl::StatusOr<double> read = scanner_.TakeNumber();
    if (!read.ok()) return read.status();
    number = *read;
  }
  return absl::OkStatus();
}

absl::Status AsfParser::ReadAxisOrder(EulerAxes& axes) {
  const std::string text = absl::AsciiStrToUpper(scanner_.Peek());
  bool seen[3] = {};
  for (size_t i = 0; i < text.size() && i < 3; ++i) {
    const int axis = text[i] - 'X';
    if (axis < 0 || axis > 2) break;
    axes[i] = axis;
    seen[axis] = true;
  }
  if (text.size() != 3 || !(seen[0] && seen[1] && seen[2])) {
    return scanner_.Expected("an order of axes such as XYZ");
  }
  scanner_.Take();
  return absl::OkStatus();
}

absl::Status AsfParser::ReadDofs(bool is_root, std::vector<BvhChannel>& dofs) {
  dofs.clear();
  bool seen[6] = {};
  while (true) {
    scanner_.SkipToToken();
    BvhChannel channel = BvhChannel::kXposition;
    if (!DofOf(scanner_.Peek(), &channel)) break;
    if (!is_root && IsPosition(channel)) {
      return scanner_.Expected("rotations only below the root");
    }
    if (seen[static_cast<int>(channel)]) {
      return scanner_.Expected("each number once");
    }
    seen[static_cast<int>(channel)] = true;
    dofs.push_back(channel);
    scanner_.Take();
  }
  if (absl::EqualsIgnoreCase(scanner_.Peek(), "l")) {
    return scanner_.Expected("a bone whose length stays");
  }
  if (dofs.empty()) return scanner_.Expected("tx, ty, tz, rx, ry or rz");
  return absl::OkStatus();
}

absl::StatusOr<int> AsfParser::FindBone(absl::string_view name) {
  const auto found = index_of_name_.find(name);
  if (found != index_of_name_.end()) return found->second;
  return scanner_.Expected("the name of a bone");
}

absl::Status AsfParser::ReadHierarchy() {
  if (has_hierarchy_) return scanner_.Expected("one section :hierarchy");
  has_hierarchy_ = true;
  if (!TakeKeyword("begin")) return scanner_.Expected("begin");
  while (!TakeKeyword("end")) {
    GELENK_RETURN_IF_ERROR(ReadChildren());
  }
  return absl::OkStatus();
}

// A line: a bone, and those that hang on it.
absl::Status AsfParser::ReadChildren() {
  const absl::StatusOr<int> parent = FindBone(scanner_.Peek());
  if (!parent.ok()) return parent.status();
  scanner_.Take();
  while (!scanner_.SkipToToken() && !scanner_.AtEnd()) {
    const absl::StatusOr<int> child = FindBone(scanner_.Peek());
    if (!child.ok()) return child.status();
    if (*child == 0 || parents_[*child] >= 0) {
      return scanner_.Expected("a bone that hangs on nothing yet");
    }
    parents_[*child] = *parent;
    scanner_.Take();
  }
  return absl::OkStatus();
}

absl::Status AsfParser::Sort() {
  const int count = static_cast<int>(document_.bones.size());
  std::vector<std::vector<int>> children(count);
  for (int i = 1; i < count; ++i) {
    if (parents_[i] >= 0) children[parents_[i]].push_back(i);
  }
  // Depth first, in the order of the file.
  struct Visit {
    int bone;
    int parent;
    int depth;
  };
  std::vector<Visit> open = {{0, -1, 1}};
  std::vector<AsfBone> sorted;
  std::vector<bool> reached(count, false);
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    if (visit.depth > bounds_.max_depth) {
      return absl::InvalidArgumentError(absl::StrCat(
          ":hierarchy: bone ", Quoted(document_.bones[visit.bone].name),
          " is more than ", bounds_.max_depth, " bones deep"));
    }
    const int index = static_cast<int>(sorted.size());
    reached[visit.bone] = true;
    sorted.push_back(std::move(document_.bones[visit.bone]));
    sorted.back().parent = visit.parent;
    const std::vector<int>& below = children[visit.bone];
    for (auto child = below.rbegin(); child != below.rend(); ++child) {
      open.push_back({*child, index, visit.depth + 1});
    }
  }
  for (int i = 0; i < count; ++i) {
    if (reached[i]) continue;
    return absl::InvalidArgumentError(
        absl::StrCat(":hierarchy: bone ", Quoted(document_.bones[i].name),
                     " does not hang on the root"));
  }
  document_.bones = std::move(sorted);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<AsfDocument> ReadAsf(absl::string_view bytes,
                                    const BvhBounds& bounds) {
  if (bytes.size() > bounds.max_bytes) {
    return absl::InvalidArgumentError(
        absl::StrCat("expected at most ", bounds.max_bytes,
                     " bytes of ASF, got ", bytes.size()));
  }
  absl::ConsumePrefix(&bytes, "\xEF\xBB\xBF");
  return AsfParser(bytes, bounds).Parse();
}

}  // namespace gelenk

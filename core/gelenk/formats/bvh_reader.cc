#include "gelenk/formats/bvh_reader.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "gelenk/formats/bvh_scanner.h"
#include "gelenk/formats/unique_names.h"

namespace gelenk {
namespace {

constexpr int kMaxChannels = kBvhChannelNames.size();

// Outside of these a rate in Hz is a mistake, and sampling at another rate
// would ask for absurd numbers of frames.
constexpr double kMinFrameTime = 1e-6;
constexpr double kMaxFrameTime = 3600;
constexpr double kDefaultFrameTime = 1.0 / 30;

#define GELENK_RETURN_IF_ERROR(expression) \
  if (absl::Status status = (expression); !status.ok()) return status

std::string Quoted(absl::string_view name) {
  return absl::StrCat("\"", absl::CHexEscape(TruncateUtf8(name, 64)), "\"");
}

class BvhParser {
 public:
  BvhParser(absl::string_view text, const BvhBounds& bounds)
      : bounds_(bounds), scanner_(text), names_(bounds.max_name_bytes) {}

  absl::StatusOr<BvhDocument> Parse();

 private:
  absl::Status ReadHierarchy();
  absl::Status ReadJointStatement();
  absl::Status OpenJoint(int parent);
  absl::Status CloseJoint();
  absl::StatusOr<std::string> ReadName();
  absl::Status ReadOffset(Eigen::Vector3d& offset);
  absl::Status ReadChannels(BvhJoint& joint);
  absl::Status ReadChannel(BvhJoint& joint);
  absl::Status ReadEndSite(BvhJoint& joint);

  absl::Status ReadMotion();
  absl::StatusOr<int64_t> ReadFrameCount();
  absl::Status ReadFrameTime(int64_t frames);
  absl::Status ReadRows(int64_t frames);
  absl::Status CheckRowCount(int64_t frames, int64_t numbers);

  void Warn(absl::string_view text) { document_.warnings.emplace_back(text); }

  // A joint whose closing brace is still to come.
  struct OpenBlock {
    int joint;
    bool has_offset = false;
    bool has_channels = false;
    bool has_children = false;
  };

  const BvhBounds bounds_;
  BvhScanner scanner_;
  UniqueNames names_;
  std::vector<OpenBlock> open_;
  int end_sites_ = 0;
  BvhDocument document_;
};

absl::StatusOr<BvhDocument> BvhParser::Parse() {
  GELENK_RETURN_IF_ERROR(ReadHierarchy());
  scanner_.SkipBlanks();
  if (scanner_.AtEnd()) {
    document_.motion.resize(document_.channel_count(), 0);
    Warn("the file has no MOTION: no frames");
    return std::move(document_);
  }
  GELENK_RETURN_IF_ERROR(ReadMotion());
  return std::move(document_);
}

absl::Status BvhParser::ReadHierarchy() {
  if (!scanner_.TakeKeyword("HIERARCHY")) return scanner_.Expected("HIERARCHY");
  if (!scanner_.TakeKeyword("ROOT")) return scanner_.Expected("ROOT");
  GELENK_RETURN_IF_ERROR(OpenJoint(-1));
  while (!open_.empty()) {
    GELENK_RETURN_IF_ERROR(ReadJointStatement());
  }
  return absl::OkStatus();
}

absl::Status BvhParser::ReadJointStatement() {
  OpenBlock& block = open_.back();
  BvhJoint& joint = document_.joints[block.joint];
  const absl::string_view keyword = scanner_.Peek();
  if (keyword == "}") return CloseJoint();
  if (absl::EqualsIgnoreCase(keyword, "OFFSET")) {
    if (block.has_offset) return scanner_.Expected("one OFFSET a joint");
    block.has_offset = true;
    scanner_.Take();
    return ReadOffset(joint.offset);
  }
  if (absl::EqualsIgnoreCase(keyword, "CHANNELS")) {
    // Behind a child it would be unclear whose numbers come first in a row.
    if (block.has_channels || block.has_children) {
      return scanner_.Expected("one CHANNELS a joint, before its children");
    }
    block.has_channels = true;
    scanner_.Take();
    return ReadChannels(joint);
  }
  if (absl::EqualsIgnoreCase(keyword, "JOINT")) {
    block.has_children = true;
    scanner_.Take();
    return OpenJoint(block.joint);
  }
  if (absl::EqualsIgnoreCase(keyword, "END") ||
      absl::EqualsIgnoreCase(keyword, "ENDSITE")) {
    return ReadEndSite(joint);
  }
  return scanner_.Expected("OFFSET, CHANNELS, JOINT, End Site or \"}\"");
}

absl::Status BvhParser::OpenJoint(int parent) {
  if (document_.joints.size() >= static_cast<size_t>(bounds_.max_joints)) {
    return scanner_.Expected(
        absl::StrCat("at most ", bounds_.max_joints, " joints"));
  }
  if (open_.size() >= static_cast<size_t>(bounds_.max_depth)) {
    return scanner_.Expected(
        absl::StrCat("at most ", bounds_.max_depth, " joints in each other"));
  }
  const std::string position = scanner_.Position();
  absl::StatusOr<std::string> name = ReadName();
  GELENK_RETURN_IF_ERROR(name.status());
  if (name->empty()) return scanner_.Expected("a name");
  BvhJoint joint;
  joint.name = names_.Take(*name);
  joint.parent = parent;
  if (joint.name != *name) {
    Warn(absl::StrCat(position, ": a second joint ", Quoted(*name),
                      " is renamed ", Quoted(joint.name)));
  }
  if (!scanner_.TakeKeyword("{")) return scanner_.Expected("\"{\"");
  open_.push_back({static_cast<int>(document_.joints.size())});
  document_.joints.push_back(std::move(joint));
  return absl::OkStatus();
}

absl::Status BvhParser::CloseJoint() {
  if (!open_.back().has_offset) {
    const BvhJoint& joint = document_.joints[open_.back().joint];
    return scanner_.Expected(absl::StrCat("an OFFSET in ", Quoted(joint.name)));
  }
  scanner_.Take();
  open_.pop_back();
  return absl::OkStatus();
}

absl::StatusOr<std::string> BvhParser::ReadName() {
  const std::string position = scanner_.Position();
  const absl::string_view name = scanner_.TakeName();
  if (name.size() > bounds_.max_name_bytes) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s: expected a name of at most %d bytes, got %d",
                        position, bounds_.max_name_bytes, name.size()));
  }
  for (char c : name) {
    if (!absl::ascii_iscntrl(c)) continue;
    return absl::InvalidArgumentError(
        absl::StrCat(position, ": expected a name, got ", Quoted(name)));
  }
  return std::string(name);
}

absl::Status BvhParser::ReadOffset(Eigen::Vector3d& offset) {
  for (int axis = 0; axis < 3; ++axis) {
    const absl::StatusOr<double> number = scanner_.TakeNumber();
    GELENK_RETURN_IF_ERROR(number.status());
    offset[axis] = *number;
  }
  return absl::OkStatus();
}

absl::Status BvhParser::ReadChannels(BvhJoint& joint) {
  BvhScanner before = scanner_;
  const absl::StatusOr<int64_t> count = scanner_.TakeCount();
  GELENK_RETURN_IF_ERROR(count.status());
  if (*count > kMaxChannels) return before.Expected("0 to 6 channels");
  for (int64_t i = 0; i < *count; ++i) {
    GELENK_RETURN_IF_ERROR(ReadChannel(joint));
  }
  return absl::OkStatus();
}

absl::Status BvhParser::ReadChannel(BvhJoint& joint) {
  const absl::string_view token = scanner_.Peek();
  for (int i = 0; i < kMaxChannels; ++i) {
    if (!absl::EqualsIgnoreCase(token, kBvhChannelNames[i])) continue;
    const BvhChannel channel = static_cast<BvhChannel>(i);
    const auto& channels = joint.channels;
    if (IsPosition(channel) && std::find(channels.begin(), channels.end(),
                                         channel) != channels.end()) {
      return scanner_.Expected("each position channel once");
    }
    joint.channels.push_back(channel);
    scanner_.Take();
    return absl::OkStatus();
  }
  return scanner_.Expected(
      "a channel (Xposition ... Zposition, Xrotation ... Zrotation)");
}

absl::Status BvhParser::ReadEndSite(BvhJoint& joint) {
  if (++end_sites_ > bounds_.max_end_sites) {
    return scanner_.Expected(
        absl::StrCat("at most ", bounds_.max_end_sites, " End Sites"));
  }
  if (!scanner_.TakeKeyword("ENDSITE")) {
    scanner_.Take();
    if (!scanner_.TakeKeyword("SITE")) return scanner_.Expected("Site");
  }
  BvhEndSite site;
  absl::StatusOr<std::string> name = ReadName();
  GELENK_RETURN_IF_ERROR(name.status());
  site.name = *std::move(name);
  if (!scanner_.TakeKeyword("{")) return scanner_.Expected("\"{\"");
  if (!scanner_.TakeKeyword("OFFSET")) return scanner_.Expected("OFFSET");
  GELENK_RETURN_IF_ERROR(ReadOffset(site.offset));
  if (scanner_.TakeKeyword("CHANNELS") && !scanner_.TakeKeyword("0")) {
    return scanner_.Expected("0 channels in an End Site");
  }
  if (!scanner_.TakeKeyword("}")) return scanner_.Expected("\"}\"");
  joint.end_sites.push_back(std::move(site));
  return absl::OkStatus();
}

absl::Status BvhParser::ReadMotion() {
  if (!scanner_.TakeKeyword("MOTION")) {
    return scanner_.Expected("MOTION (a file has one ROOT)");
  }
  const absl::StatusOr<int64_t> frames = ReadFrameCount();
  GELENK_RETURN_IF_ERROR(frames.status());
  GELENK_RETURN_IF_ERROR(ReadFrameTime(*frames));
  return ReadRows(*frames);
}

absl::StatusOr<int64_t> BvhParser::ReadFrameCount() {
  if (!scanner_.TakeWord("FRAMES")) return scanner_.Expected("Frames:");
  scanner_.TakeColon();
  BvhScanner before = scanner_;
  const absl::StatusOr<int64_t> frames = scanner_.TakeCount();
  GELENK_RETURN_IF_ERROR(frames.status());
  if (*frames > bounds_.max_frames) {
    return before.Expected(
        absl::StrCat("at most ", bounds_.max_frames, " frames"));
  }
  const int64_t channels = document_.channel_count();
  if (*frames * channels > bounds_.max_numbers) {
    return before.Expected(
        absl::StrFormat("at most %d numbers of motion, %d channels times "
                        "the frames",
                        bounds_.max_numbers, channels));
  }
  return *frames;
}

absl::Status BvhParser::ReadFrameTime(int64_t frames) {
  const bool found = scanner_.TakeWord("FRAMETIME") ||
                     (scanner_.TakeWord("FRAME") && scanner_.TakeWord("TIME"));
  if (!found) return scanner_.Expected("Frame Time:");
  scanner_.TakeColon();
  BvhScanner before = scanner_;
  const absl::string_view text = scanner_.Peek();
  const absl::StatusOr<double> seconds = scanner_.TakeNumber();
  GELENK_RETURN_IF_ERROR(seconds.status());
  if (*seconds >= kMinFrameTime && *seconds <= kMaxFrameTime) {
    document_.frame_time_s = *seconds;
    document_.frame_time_text = std::string(text);
    return absl::OkStatus();
  }
  // A still pose has no use for it, and exporters write 0.
  if (frames > 1 || *seconds > 0) {
    return before.Expected("a frame time of 1e-6 to 3600 s");
  }
  document_.frame_time_s = kDefaultFrameTime;
  Warn(absl::StrFormat("frame time %g of a still pose is taken as 1/30 s",
                       *seconds));
  return absl::OkStatus();
}

absl::Status BvhParser::ReadRows(int64_t frames) {
  const int64_t channels = document_.channel_count();
  const int64_t total = frames * channels;
  // A number takes a digit and a blank at least, so a count that cannot be true
  // takes no memory: its numbers are only counted, for the error.
  const bool possible =
      total <= static_cast<int64_t>(scanner_.BytesLeft()) / 2 + 1;
  Eigen::MatrixXd& motion = document_.motion;
  if (possible) motion.resize(channels, frames);
  const int64_t wanted = possible ? total : 0;
  int64_t numbers = 0;
  bool one_row_a_line = true;
  int64_t row = 0;  // numbers of the row so far
  for (;; ++numbers) {
    const bool line_ended = scanner_.SkipBlanks();
    if (scanner_.AtEnd()) break;
    if (channels == 0) return scanner_.Expected("no numbers without channels");
    const absl::StatusOr<double> number = scanner_.TakeNumber();
    GELENK_RETURN_IF_ERROR(number.status());
    if (numbers < wanted) motion.data()[numbers] = *number;
    if (numbers > 0 && line_ended != (row == 0)) one_row_a_line = false;
    if (++row == channels) row = 0;
  }
  GELENK_RETURN_IF_ERROR(CheckRowCount(frames, numbers));
  if (!one_row_a_line) {
    Warn(
        "the motion does not have one frame a line; it is read number by "
        "number");
  }
  return absl::OkStatus();
}

absl::Status BvhParser::CheckRowCount(int64_t frames, int64_t numbers) {
  const int64_t channels = document_.channel_count();
  if (channels == 0) return absl::OkStatus();
  const int64_t complete = numbers / channels;
  const int64_t rest = numbers % channels;
  if (complete < frames || rest != 0) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: expected %d frames of %d numbers, got %d%s", scanner_.Position(),
        frames, channels, complete,
        rest == 0 ? "" : absl::StrFormat(" and %d numbers", rest)));
  }
  if (complete > frames) {
    Warn(absl::StrFormat(
        "the header says %d frames, the file has %d: the last %d dropped",
        frames, complete, complete - frames));
  }
  return absl::OkStatus();
}

#undef GELENK_RETURN_IF_ERROR

absl::string_view WithoutPadding(absl::string_view text) {
  // Some exporters end a file with NUL or Ctrl-Z.
  constexpr absl::string_view kPadding("\0\x1a \t\r\n\v\f", 8);
  const size_t last = text.find_last_not_of(kPadding);
  return last == absl::string_view::npos ? absl::string_view()
                                         : text.substr(0, last + 1);
}

}  // namespace

absl::StatusOr<BvhDocument> ReadBvh(absl::string_view bytes,
                                    const BvhBounds& bounds) {
  if (bytes.size() > bounds.max_bytes) {
    return absl::InvalidArgumentError(
        absl::StrFormat("expected at most %d bytes of BVH, got %d",
                        bounds.max_bytes, bytes.size()));
  }
  if (absl::StartsWith(bytes, "\xFF\xFE") ||
      absl::StartsWith(bytes, "\xFE\xFF")) {
    return absl::InvalidArgumentError(
        "line 1, column 1: expected UTF-8 text, got UTF-16");
  }
  absl::ConsumePrefix(&bytes, "\xEF\xBB\xBF");
  return BvhParser(WithoutPadding(bytes), bounds).Parse();
}

}  // namespace gelenk

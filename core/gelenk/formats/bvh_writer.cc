#include "gelenk/formats/bvh_writer.h"

#include <array>
#include <charconv>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "gelenk/formats/bvh_scanner.h"

namespace gelenk {
namespace {

void AppendNumber(double number, std::string& text) {
  // The longest shortest form of a double has 24 characters.
  std::array<char, 32> digits;
  const std::to_chars_result result =
      std::to_chars(digits.data(), digits.data() + digits.size(), number);
  text.append(digits.data(), result.ptr);
}

void AppendOffset(const Eigen::Vector3d& offset, std::string& text) {
  text += "OFFSET";
  for (double component : offset) {
    text += ' ';
    AppendNumber(component, text);
  }
  text += '\n';
}

class HierarchyWriter {
 public:
  HierarchyWriter(const BvhDocument& document, std::string& text)
      : document_(document), text_(text) {}

  void Write() {
    text_ += "HIERARCHY\n";
    for (size_t i = 0; i < document_.joints.size(); ++i) {
      const BvhJoint& joint = document_.joints[i];
      while (!open_.empty() && open_.back() != joint.parent) Close();
      Open(static_cast<int>(i));
    }
    while (!open_.empty()) Close();
  }

 private:
  void Indent() { text_.append(open_.size(), '\t'); }

  void Open(int index) {
    const BvhJoint& joint = document_.joints[index];
    Indent();
    absl::StrAppend(&text_, open_.empty() ? "ROOT " : "JOINT ", joint.name,
                    "\n");
    Indent();
    text_ += "{\n";
    open_.push_back(index);
    Indent();
    AppendOffset(joint.offset, text_);
    Indent();
    absl::StrAppend(&text_, "CHANNELS ", joint.channels.size());
    for (BvhChannel channel : joint.channels) {
      absl::StrAppend(&text_, " ", BvhChannelName(channel));
    }
    text_ += '\n';
  }

  // End Sites come last: joints under them would hide behind their braces.
  void Close() {
    for (const BvhEndSite& site : document_.joints[open_.back()].end_sites) {
      Indent();
      absl::StrAppend(&text_, "End Site", site.name.empty() ? "" : " ",
                      site.name, "\n");
      Indent();
      text_ += "{\n\t";
      Indent();
      AppendOffset(site.offset, text_);
      Indent();
      text_ += "}\n";
    }
    open_.pop_back();
    Indent();
    text_ += "}\n";
  }

  const BvhDocument& document_;
  std::string& text_;
  std::vector<int> open_;
};

void AppendFrameTime(const BvhDocument& document, std::string& text) {
  BvhScanner scanner(document.frame_time_text);
  const bool one_token = scanner.Peek() == document.frame_time_text;
  const absl::StatusOr<double> as_read = scanner.TakeNumber();
  if (one_token && as_read.ok() && *as_read == document.frame_time_s) {
    text += document.frame_time_text;
  } else {
    AppendNumber(document.frame_time_s, text);
  }
}

}  // namespace

std::string WriteBvh(const BvhDocument& document) {
  std::string text;
  HierarchyWriter(document, text).Write();
  absl::StrAppend(&text, "MOTION\nFrames: ", document.frame_count(),
                  "\nFrame Time: ");
  AppendFrameTime(document, text);
  text += '\n';
  for (int frame = 0; frame < document.frame_count(); ++frame) {
    for (int row = 0; row < document.motion.rows(); ++row) {
      if (row > 0) text += ' ';
      AppendNumber(document.motion(row, frame), text);
    }
    text += '\n';
  }
  return text;
}

}  // namespace gelenk

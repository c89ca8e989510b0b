#include "gelenk/formats/amc_reader.h"

#include <algorithm>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "gelenk/formats/asf_scanner.h"

namespace gelenk {
namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180;

class AmcParser {
 public:
  AmcParser(absl::string_view text, const AsfDocument& skeleton,
            const BvhBounds& bounds)
      : skeleton_(skeleton),
        bounds_(bounds),
        scanner_(text),
        dof_count_(skeleton.dof_count()),
        is_in_degrees_(skeleton.is_in_degrees) {
    int row = 0;
    for (size_t i = 0; i < skeleton.bones.size(); ++i) {
      bone_of_name_[skeleton.bones[i].name] = static_cast<int>(i);
      first_row_.push_back(row);
      row += static_cast<int>(skeleton.bones[i].dofs.size());
    }
  }

  absl::StatusOr<AmcMotion> Parse();

 private:
  absl::Status ReadRemarks();
  absl::Status ReadFrame();
  absl::Status ReadBone(std::vector<bool>& seen);

  const AsfDocument& skeleton_;
  const BvhBounds bounds_;
  AsfScanner scanner_;
  const int dof_count_;
  bool is_in_degrees_;
  absl::flat_hash_map<std::string, int> bone_of_name_;
  std::vector<int> first_row_;
  std::optional<int64_t> last_number_;
  int64_t frame_count_ = 0;
  // Frame after frame.
  std::vector<double> numbers_;
};

absl::StatusOr<AmcMotion> AmcParser::Parse() {
  if (absl::Status status = ReadRemarks(); !status.ok()) return status;
  while (!scanner_.AtEnd()) {
    if (absl::Status status = ReadFrame(); !status.ok()) return status;
  }
  AmcMotion motion;
  motion.numbers = Eigen::Map<const Eigen::MatrixXd>(numbers_.data(),
                                                     dof_count_, frame_count_);
  return motion;
}

absl::Status AmcParser::ReadRemarks() {
  while (scanner_.IsAtSection()) {
    if (absl::EqualsIgnoreCase(scanner_.Peek(), ":degrees")) {
      is_in_degrees_ = true;
    } else if (absl::EqualsIgnoreCase(scanner_.Peek(), ":radians")) {
      is_in_degrees_ = false;
    }
    scanner_.SkipLine();
  }
  return absl::OkStatus();
}

absl::Status AmcParser::ReadFrame() {
  const int64_t want = last_number_.value_or(0) + 1;
  if (frame_count_ >= bounds_.max_frames ||
      (frame_count_ + 1) * dof_count_ > bounds_.max_numbers) {
    return scanner_.Expected(absl::StrCat("at most ", frame_count_, " frames"));
  }
  const absl::string_view token = scanner_.Peek();
  absl::StatusOr<int64_t> number = scanner_.TakeCount();
  if (!number.ok()) {
    return scanner_.Expected("the number of a frame, or a bone of the frame");
  }
  if (last_number_ && *number != want) {
    return scanner_.Expected(
        absl::StrCat("frame ", want, " before this, not ", token));
  }
  last_number_ = *number;
  numbers_.resize(numbers_.size() + dof_count_, 0);
  ++frame_count_;
  std::vector<bool> seen(skeleton_.bones.size(), false);
  scanner_.SkipToToken();
  while (!scanner_.AtEnd() && bone_of_name_.contains(scanner_.Peek())) {
    if (absl::Status status = ReadBone(seen); !status.ok()) return status;
    scanner_.SkipToToken();
  }
  for (size_t i = 0; i < seen.size(); ++i) {
    if (seen[i] || skeleton_.bones[i].dofs.empty()) continue;
    return scanner_.Expected(
        absl::StrCat("bone ", skeleton_.bones[i].name, " of frame ", *number));
  }
  return absl::OkStatus();
}

absl::Status AmcParser::ReadBone(std::vector<bool>& seen) {
  const int bone = bone_of_name_.find(scanner_.Peek())->second;
  if (seen[bone]) return scanner_.Expected("each bone once in a frame");
  seen[bone] = true;
  scanner_.Take();
  double* numbers =
      numbers_.data() + numbers_.size() - dof_count_ + first_row_[bone];
  for (BvhChannel channel : skeleton_.bones[bone].dofs) {
    const absl::StatusOr<double> read = scanner_.TakeNumber();
    if (!read.ok()) return read.status();
    const bool is_angle = !IsPosition(channel);
    *numbers++ = is_angle && is_in_degrees_ ? *read * kRadPerDegree : *read;
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<AmcMotion> ReadAmc(absl::string_view bytes,
                                  const AsfDocument& skeleton,
                                  const BvhBounds& bounds) {
  if (bytes.size() > bounds.max_bytes) {
    return absl::InvalidArgumentError(
        absl::StrCat("expected at most ", bounds.max_bytes,
                     " bytes of AMC, got ", bytes.size()));
  }
  absl::ConsumePrefix(&bytes, "\xEF\xBB\xBF");
  return AmcParser(bytes, skeleton, bounds).Parse();
}

}  // namespace gelenk

#include "gelenk/base/violations.h"

#include <string>
#include <vector>

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace gelenk {
namespace {

constexpr absl::string_view kPayloadUrl = "type.gelenk.dev/violations";
constexpr size_t kMaxListed = 20;
constexpr char kRecordEnd = '\x1e';
constexpr char kFieldEnd = '\x1f';

std::string Join(absl::string_view parent, absl::string_view child) {
  if (parent.empty() || child.empty()) return absl::StrCat(parent, child);
  return absl::StrCat(parent, ".", child);
}

}  // namespace

void Violations::Add(absl::string_view field, absl::string_view description) {
  if (list_.size() == kMaxListed) {
    ++dropped_;
    return;
  }
  list_.push_back({std::string(field), std::string(description)});
}

void Violations::AddStatus(absl::string_view field,
                           const absl::Status& status) {
  if (status.ok()) return;
  const std::vector<Violation> inner = FromStatus(status);
  if (inner.empty()) Add(field, status.message());
  for (const Violation& violation : inner) {
    Add(Join(field, violation.field), violation.description);
  }
}

absl::Status Violations::ToStatus() const {
  if (list_.empty()) return absl::OkStatus();
  std::string message;
  std::string payload;
  for (const Violation& violation : list_) {
    absl::StrAppend(&message, message.empty() ? "" : "; ", violation.field,
                    violation.field.empty() ? "" : ": ", violation.description);
    absl::StrAppend(&payload, violation.field, std::string(1, kFieldEnd),
                    violation.description, std::string(1, kRecordEnd));
  }
  if (dropped_ > 0) absl::StrAppend(&message, "; and ", dropped_, " more");
  absl::Status status = absl::InvalidArgumentError(message);
  status.SetPayload(kPayloadUrl, absl::Cord(payload));
  return status;
}

std::vector<Violation> Violations::FromStatus(const absl::Status& status) {
  std::vector<Violation> list;
  const auto payload = status.GetPayload(kPayloadUrl);
  if (!payload) return list;
  const std::string text(*payload);
  for (absl::string_view record : absl::StrSplit(text, kRecordEnd)) {
    if (record.empty()) continue;
    const std::pair<absl::string_view, absl::string_view> parts =
        absl::StrSplit(record, absl::MaxSplits(kFieldEnd, 1));
    list.push_back({std::string(parts.first), std::string(parts.second)});
  }
  return list;
}

}  // namespace gelenk

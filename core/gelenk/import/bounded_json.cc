#include "gelenk/import/bounded_json.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace gelenk {
namespace {

using nlohmann::json;

// As much of the parser's words as is passed on; they quote the text.
constexpr size_t kMaxReasonBytes = 160;

absl::Status TooLarge(absl::string_view what, size_t most) {
  return absl::InvalidArgumentError(
      absl::StrFormat("JSON: want at most %d %s", most, what));
}

// Without the parser's own code in front: "[json.exception.parse_error.101] ".
absl::Status Malformed(absl::string_view reason) {
  const size_t code_end = reason.find("] ");
  if (code_end != absl::string_view::npos) reason.remove_prefix(code_end + 2);
  return absl::InvalidArgumentError(
      absl::StrCat("no well-formed JSON: ",
                   absl::CHexEscape(reason.substr(0, kMaxReasonBytes))));
}

// Puts together what the parser reads. The library's own callback would do, but
// looks through the whole array each time that an object in it ends.
class KeptValues final : public nlohmann::json_sax<json> {
 public:
  KeptValues(const JsonBounds& bounds, const KeepMember& keep)
      : bounds_(bounds), keep_(keep) {}

  // Of the text, once it was read; or why it was not.
  absl::StatusOr<json> Take() {
    if (!status_.ok()) return status_;
    return std::move(root_);
  }

  bool null() override { return Add(nullptr); }
  bool boolean(bool value) override { return Add(value); }
  bool number_integer(int64_t value) override { return Add(value); }
  bool number_unsigned(uint64_t value) override { return Add(value); }
  bool number_float(double value, const std::string&) override {
    return Add(value);
  }
  bool string(std::string& value) override { return Add(std::move(value)); }
  bool binary(json::binary_t& value) override { return Add(std::move(value)); }

  bool start_object(size_t) override { return Open(json::object()); }
  bool start_array(size_t) override { return Open(json::array()); }
  bool end_object() override { return Close(); }
  bool end_array() override { return Close(); }

  bool key(std::string& key) override {
    if (open_.back() == nullptr) return true;
    is_kept_ = keep_(static_cast<int>(open_.size()), key);
    key_ = std::move(key);
    return true;
  }

  bool parse_error(size_t, const std::string&,
                   const json::exception& error) override {
    status_ = Malformed(error.what());
    return false;
  }

 private:
  // Where the next value goes; null where it is not kept.
  json* Place(json&& value) {
    if (open_.empty()) {
      root_ = std::move(value);
      return &root_;
    }
    json* const parent = open_.back();
    if (parent == nullptr) return nullptr;
    if (parent->is_array()) {
      parent->push_back(std::move(value));
      return &parent->back();
    }
    if (!is_kept_) return nullptr;
    json& member = (*parent)[key_];
    member = std::move(value);
    return &member;
  }

  bool Add(json&& value) {
    if (++count_ > bounds_.max_values) {
      status_ = TooLarge("values", bounds_.max_values);
      return false;
    }
    Place(std::move(value));
    return true;
  }

  bool Open(json&& value) {
    if (open_.size() == bounds_.max_depth) {
      status_ = TooLarge("levels", bounds_.max_depth);
      return false;
    }
    if (++count_ > bounds_.max_values) {
      status_ = TooLarge("values", bounds_.max_values);
      return false;
    }
    open_.push_back(Place(std::move(value)));
    return true;
  }

  bool Close() {
    open_.pop_back();
    return true;
  }

  const JsonBounds bounds_;
  const KeepMember& keep_;
  json root_;
  // The arrays and objects that stand open; null for one that is not kept.
  std::vector<json*> open_;
  // Of the member that comes next.
  std::string key_;
  bool is_kept_ = true;
  size_t count_ = 0;
  absl::Status status_;
};

}  // namespace

absl::StatusOr<json> ParseJson(absl::string_view text, const JsonBounds& bounds,
                               const KeepMember& keep) {
  if (text.size() > bounds.max_bytes) {
    return TooLarge("bytes", bounds.max_bytes);
  }
  KeptValues values(bounds, keep);
  json::sax_parse(text.begin(), text.end(), &values);
  return values.Take();
}

}  // namespace gelenk

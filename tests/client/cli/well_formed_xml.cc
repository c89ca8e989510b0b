#include "tests/client/cli/well_formed_xml.h"

#include <regex>
#include <set>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace gelenk::cli {
namespace {

absl::Status Malformed(const std::string& what) {
  return absl::InvalidArgumentError(what);
}

// Text and attribute values: every & starts an entity.
bool IsEscaped(const std::string& text) {
  static const std::regex kText("([^<&]|&(amp|lt|gt|quot);)*");
  for (absl::string_view line : absl::StrSplit(text, '\n')) {
    if (!std::regex_match(std::string(line), kText)) return false;
  }
  return true;
}

// Counts `name` and its classes; `attributes` are what follows the name.
absl::Status CountOne(const std::string& name, std::string attributes,
                      std::map<std::string, int>& counts) {
  static const std::regex kAttribute("\\s+([A-Za-z0-9:_-]+)=\"([^\"<]*)\"");
  ++counts[name];
  std::set<std::string> seen;
  std::smatch match;
  while (std::regex_search(attributes, match, kAttribute,
                           std::regex_constants::match_continuous)) {
    if (!seen.insert(match[1]).second || !IsEscaped(match[2])) {
      return Malformed(absl::StrCat("attribute ", match[1].str()));
    }
    if (match[1] == "class") {
      for (absl::string_view text :
           absl::StrSplit(match[2].str(), ' ', absl::SkipEmpty())) {
        ++counts[absl::StrCat(name, ".", text)];
      }
    }
    attributes = match.suffix();
  }
  if (attributes.find_first_not_of(" \n") != std::string::npos) {
    return Malformed(absl::StrCat("<", name, "> has ", attributes));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::map<std::string, int>> CountElements(
    absl::string_view xml) {
  std::map<std::string, int> counts;
  std::vector<std::string> open;
  size_t at = 0;
  while (at < xml.size()) {
    const size_t begin = std::min(xml.find('<', at), xml.size());
    if (!IsEscaped(std::string(xml.substr(at, begin - at)))) {
      return Malformed(absl::StrCat("text ", xml.substr(at, begin - at)));
    }
    if (begin == xml.size()) break;
    const size_t end = xml.find('>', begin);
    if (end == absl::string_view::npos) return Malformed("<");
    std::string tag(xml.substr(begin + 1, end - begin - 1));
    at = end + 1;
    if (tag[0] == '/') {
      if (open.empty() || open.back() != tag.substr(1)) return Malformed(tag);
      open.pop_back();
      continue;
    }
    const bool is_empty = tag.back() == '/';
    if (is_empty) tag.pop_back();
    const size_t name_end = std::min(tag.find_first_of(" \n"), tag.size());
    const std::string name = tag.substr(0, name_end);
    const absl::Status status = CountOne(name, tag.substr(name_end), counts);
    if (!status.ok()) return status;
    if (!is_empty) open.push_back(name);
  }
  if (!open.empty()) return Malformed(absl::StrCat("no </", open.back(), ">"));
  return counts;
}

}  // namespace gelenk::cli

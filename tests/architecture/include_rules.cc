#include "tests/architecture/include_rules.h"

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <optional>
#include <regex>
#include <set>

namespace gelenk::architecture {
namespace {

namespace fs = std::filesystem;

// Length of the longest of `prefixes` that `text` starts with.
std::optional<size_t> LongestMatch(const std::string& text,
                                   const std::vector<std::string>& prefixes) {
  std::optional<size_t> longest;
  for (const std::string& prefix : prefixes) {
    if (text.starts_with(prefix)) {
      longest = std::max(longest.value_or(0), prefix.size());
    }
  }
  return longest;
}

bool IsAllowed(const std::string& include, const Room& room) {
  const std::optional<size_t> allowed = LongestMatch(include, room.allowed);
  const std::optional<size_t> forbidden = LongestMatch(include, room.forbidden);
  return allowed.has_value() && (!forbidden.has_value() || allowed > forbidden);
}

// What a line includes, in the form of the header comment.
std::optional<std::string> IncludeOf(const std::string& line) {
  static const std::regex kInclude(
      R"re(^\s*#\s*include\s*([<"])([^>"]+)[>"].*)re");
  std::smatch match;
  if (!std::regex_match(line, match, kInclude)) return std::nullopt;
  const std::string path = match[2];
  const bool standard =
      match[1] == "<" && path.find_first_of("./") == std::string::npos;
  return standard ? "<" + path + ">" : path;
}

const Room* RoomOf(const std::string& file, const std::vector<Room>& rooms) {
  const Room* innermost = nullptr;
  for (const Room& room : rooms) {
    if (!file.starts_with(room.path)) continue;
    if (innermost == nullptr || room.path.size() > innermost->path.size()) {
      innermost = &room;
    }
  }
  return innermost;
}

void CheckFile(const fs::path& root, const std::string& file, const Room& room,
               std::vector<Violation>& violations) {
  std::ifstream in(root / file);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::optional<std::string> include = IncludeOf(line);
    if (include.has_value() && !IsAllowed(*include, room)) {
      violations.push_back({file, number, *include, room.path});
    }
  }
}

}  // namespace

std::ostream& operator<<(std::ostream& out, const Violation& violation) {
  return out << violation.file << ":" << violation.line << ": "
             << violation.room << " must not include " << violation.include;
}

std::vector<std::string> SourceFiles(const fs::path& root,
                                     const std::string& folder) {
  std::vector<std::string> files;
  if (!fs::is_directory(root / folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    const fs::path extension = entry.path().extension();
    if (extension != ".h" && extension != ".cc") continue;
    files.push_back(entry.path().lexically_relative(root).generic_string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<Violation> CheckIncludes(const fs::path& root,
                                     const std::vector<Room>& rooms) {
  std::set<std::string> files;
  for (const Room& room : rooms) {
    for (const std::string& file : SourceFiles(root, room.path)) {
      files.insert(file);
    }
  }
  std::vector<Violation> violations;
  for (const std::string& file : files) {
    CheckFile(root, file, *RoomOf(file, rooms), violations);
  }
  return violations;
}

}  // namespace gelenk::architecture

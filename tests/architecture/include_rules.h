// The arrows between the rooms of the house, checked on every #include.
//
// A room is a folder (or one file) of the tree together with the include paths
// its files may use. An include is looked up by the text between its quotes or
// angle brackets, "gelenk/base/status.h" and Eigen/Core alike; a header of the
// standard library keeps its brackets, <vector>, so that it can be told from a
// folder and so that "<" stands for all of them.
#ifndef GELENK_TESTS_ARCHITECTURE_INCLUDE_RULES_H_
#define GELENK_TESTS_ARCHITECTURE_INCLUDE_RULES_H_

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace gelenk::architecture {

// Both lists hold prefixes; the longest one that fits an include decides, and
// an include that nothing fits is not allowed.
struct Room {
  std::string path;  // Relative to the root: "core/", or a single file.
  std::vector<std::string> allowed;
  std::vector<std::string> forbidden = {};
};

struct Violation {
  std::string file;  // Relative to the root.
  int line = 0;
  std::string include;
  std::string room;
};

// Prints as "core/a.cc:3: core/ must not include <thread>".
std::ostream& operator<<(std::ostream& out, const Violation& violation);

// The .h and .cc files below root/folder, relative to root, sorted. A folder
// that does not exist has none.
std::vector<std::string> SourceFiles(const std::filesystem::path& root,
                                     const std::string& folder);

// Checks every source file of the rooms. A file belongs to the room with the
// longest path that fits it.
std::vector<Violation> CheckIncludes(const std::filesystem::path& root,
                                     const std::vector<Room>& rooms);

}  // namespace gelenk::architecture

#endif  // GELENK_TESTS_ARCHITECTURE_INCLUDE_RULES_H_

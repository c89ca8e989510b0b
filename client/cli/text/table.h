// Text in columns, for people.
#ifndef CLIENT_CLI_TEXT_TABLE_H_
#define CLIENT_CLI_TEXT_TABLE_H_

#include <string>
#include <vector>

#include "absl/strings/string_view.h"

namespace gelenk::cli {

enum class Align { kLeft, kRight };

struct Column {
  std::string title;
  Align align = Align::kLeft;
};

class Table {
 public:
  // Without any title there is no line of titles.
  explicit Table(std::vector<Column> columns);

  // Missing cells are empty; there are at most as many as columns.
  void AddRow(std::vector<std::string> cells);

  // Two spaces between columns, none at the end of a line, every line ended.
  std::string ToString() const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

// A table of two columns: what, and how much.
class Facts {
 public:
  Facts() : table_({{""}, {""}}) {}
  void Add(absl::string_view name, absl::string_view value);
  std::string ToString() const { return table_.ToString(); }

 private:
  Table table_;
};

// Characters of UTF-8 text, as a terminal counts them for most scripts.
int DisplayWidth(absl::string_view text);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_TEXT_TABLE_H_

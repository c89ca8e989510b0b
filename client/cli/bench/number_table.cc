#include "client/cli/bench/number_table.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/cli/file_bytes.h"
#include "client/cli/text/number_list.h"

namespace gelenk::cli {
namespace {

absl::Status InLine(int line, absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat("line ", line, ": ", what));
}

absl::StatusOr<std::vector<std::string>> ParseColumns(absl::string_view line) {
  std::vector<std::string> columns;
  for (absl::string_view cell : absl::StrSplit(line, ',')) {
    const std::string name(absl::StripAsciiWhitespace(cell));
    if (name.empty()) return InLine(1, "a column has no name");
    if (std::find(columns.begin(), columns.end(), name) != columns.end()) {
      return InLine(1, absl::StrCat("column \"", absl::CHexEscape(name),
                                    "\" stands twice"));
    }
    columns.push_back(name);
  }
  return columns;
}

absl::Status ParseRow(absl::string_view text, int line, NumberTable& table) {
  size_t count = 0;
  for (absl::string_view cell : absl::StrSplit(text, ',')) {
    if (count == table.columns.size()) {
      return InLine(line, absl::StrCat("more than ", count, " cells"));
    }
    const absl::StatusOr<double> number =
        ParseNumber(absl::StripAsciiWhitespace(cell));
    if (!number.ok()) {
      return InLine(line, absl::StrCat("column \"", table.columns[count],
                                       "\": ", number.status().message()));
    }
    table.numbers.push_back(*number);
    ++count;
  }
  if (count < table.columns.size()) {
    return InLine(line, absl::StrCat("want ", table.columns.size(),
                                     " cells, got ", count));
  }
  return absl::OkStatus();
}

// Also files that are not compressed.
absl::StatusOr<std::string> ReadGzip(const std::string& path) {
  gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) {
    return absl::NotFoundError(absl::StrCat(path, ": cannot be opened"));
  }
  std::string text;
  std::array<char, 1 << 16> block;
  int count = 0;
  while (text.size() <= kMaxTableBytes &&
         (count = gzread(file, block.data(), block.size())) > 0) {
    text.append(block.data(), count);
  }
  // Only closing tells that a file ended in the middle.
  const bool whole = gzclose(file) == Z_OK && count >= 0;
  if (text.size() > kMaxTableBytes) {
    return InFile(path, absl::InvalidArgumentError(absl::StrCat(
                            "more than ", kMaxTableBytes, " bytes of text")));
  }
  if (!whole) {
    return InFile(path,
                  absl::InvalidArgumentError("damaged or cut off (gzip)"));
  }
  return text;
}

}  // namespace

int NumberTable::FindColumn(absl::string_view name) const {
  const auto found = std::find(columns.begin(), columns.end(), name);
  return found == columns.end() ? -1
                                : static_cast<int>(found - columns.begin());
}

absl::StatusOr<NumberTable> ParseNumberTable(absl::string_view text) {
  NumberTable table;
  int line = 0;
  for (absl::string_view row : absl::StrSplit(text, '\n')) {
    ++line;
    row = absl::StripAsciiWhitespace(row);
    if (row.empty()) continue;
    if (table.columns.empty()) {
      absl::StatusOr<std::vector<std::string>> columns = ParseColumns(row);
      if (!columns.ok()) return columns.status();
      table.columns = *std::move(columns);
      continue;
    }
    if (absl::Status status = ParseRow(row, line, table); !status.ok()) {
      return status;
    }
  }
  if (table.numbers.empty()) {
    return absl::InvalidArgumentError("has no rows of numbers");
  }
  return table;
}

absl::StatusOr<NumberTable> ReadNumberTable(const std::string& path) {
  // Asked first for its errors: zlib says nothing about folders and rights.
  if (absl::Status status = ReadFile(path).status(); !status.ok()) {
    return status;
  }
  const absl::StatusOr<std::string> text = ReadGzip(path);
  if (!text.ok()) return text.status();
  absl::StatusOr<NumberTable> table = ParseNumberTable(*text);
  if (!table.ok()) return InFile(path, table.status());
  return table;
}

}  // namespace gelenk::cli

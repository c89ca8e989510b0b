#include "client/cli/text/table.h"

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace gelenk::cli {
namespace {

constexpr absl::string_view kGap = "  ";

std::string Padded(absl::string_view cell, int width, Align align) {
  const std::string padding(std::max(0, width - DisplayWidth(cell)), ' ');
  return align == Align::kLeft ? absl::StrCat(cell, padding)
                               : absl::StrCat(padding, cell);
}

}  // namespace

int DisplayWidth(absl::string_view text) {
  // Every byte but those that continue a character.
  return static_cast<int>(std::count_if(
      text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

Table::Table(std::vector<Column> columns) : columns_(std::move(columns)) {}

void Table::AddRow(std::vector<std::string> cells) {
  cells.resize(columns_.size());
  rows_.push_back(std::move(cells));
}

std::string Table::ToString() const {
  std::vector<std::string> titles;
  bool has_titles = false;
  for (const Column& column : columns_) {
    titles.push_back(column.title);
    has_titles = has_titles || !column.title.empty();
  }
  std::vector<std::vector<std::string>> lines = rows_;
  if (has_titles) lines.insert(lines.begin(), titles);

  std::vector<int> widths(columns_.size(), 0);
  for (const std::vector<std::string>& cells : lines) {
    for (size_t i = 0; i < cells.size(); ++i) {
      widths[i] = std::max(widths[i], DisplayWidth(cells[i]));
    }
  }
  std::string text;
  for (const std::vector<std::string>& cells : lines) {
    std::string line;
    for (size_t i = 0; i < cells.size(); ++i) {
      if (i > 0) absl::StrAppend(&line, kGap);
      absl::StrAppend(&line, Padded(cells[i], widths[i], columns_[i].align));
    }
    absl::StripTrailingAsciiWhitespace(&line);
    absl::StrAppend(&text, line, "\n");
  }
  return text;
}

void Facts::Add(absl::string_view name, absl::string_view value) {
  table_.AddRow({std::string(name), std::string(value)});
}

}  // namespace gelenk::cli

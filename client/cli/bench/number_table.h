// Comma-separated numbers with a line of column names, plain or gzipped.
#ifndef CLIENT_CLI_BENCH_NUMBER_TABLE_H_
#define CLIENT_CLI_BENCH_NUMBER_TABLE_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace gelenk::cli {

// A gigabyte of text is a mistake, or a gzip bomb.
inline constexpr size_t kMaxTableBytes = size_t{1} << 30;

struct NumberTable {
  std::vector<std::string> columns;
  // Row by row, columns.size() numbers each.
  std::vector<double> numbers;

  int row_count() const {
    return columns.empty() ? 0
                           : static_cast<int>(numbers.size() / columns.size());
  }
  const double* row(int index) const {
    return numbers.data() + columns.size() * index;
  }
  // -1 when there is none.
  int FindColumn(absl::string_view name) const;
};

// INVALID_ARGUMENT naming line and column: a cell that is no finite number, too
// few or too many cells, a column named twice, no rows.
absl::StatusOr<NumberTable> ParseNumberTable(absl::string_view text);

// Errors name the file.
absl::StatusOr<NumberTable> ReadNumberTable(const std::string& path);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_BENCH_NUMBER_TABLE_H_

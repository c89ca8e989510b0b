// What fuzz targets share: checks that stop the process.
#ifndef GELENK_TESTS_FUZZ_FUZZ_CHECK_H_
#define GELENK_TESTS_FUZZ_FUZZ_CHECK_H_

#include <cstddef>
#include <cstdio>
#include <cstdlib>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/string_view.h"

#define GELENK_FUZZ_CHECK(condition)                                  \
  if (!(condition)) {                                                 \
    std::fprintf(stderr, "%s:%d: not true: %s\n", __FILE__, __LINE__, \
                 #condition);                                         \
    std::abort();                                                     \
  }

namespace gelenk {

// A decent refusal: the caller's mistake, in printable words, not endless.
inline void CheckRefusal(const absl::Status& status, size_t max_bytes) {
  GELENK_FUZZ_CHECK(status.code() == absl::StatusCode::kInvalidArgument);
  const absl::string_view message = status.message();
  GELENK_FUZZ_CHECK(message.size() < max_bytes);
  for (char c : message) {
    GELENK_FUZZ_CHECK(absl::ascii_isprint(static_cast<unsigned char>(c)));
  }
}

}  // namespace gelenk

#endif  // GELENK_TESTS_FUZZ_FUZZ_CHECK_H_

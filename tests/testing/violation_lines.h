// What is wrong with an input, as lines that a test can list.
#ifndef GELENK_TESTS_TESTING_VIOLATION_LINES_H_
#define GELENK_TESTS_TESTING_VIOLATION_LINES_H_

#include <string>
#include <vector>

#include "absl/status/status.h"

namespace gelenk::testing {

// "field: description" of every violation that `status` carries.
std::vector<std::string> ViolationLines(const absl::Status& status);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_VIOLATION_LINES_H_

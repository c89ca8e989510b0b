// What a test says about an error.
#ifndef GELENK_TESTS_TESTING_STATUS_MATCHERS_H_
#define GELENK_TESTS_TESTING_STATUS_MATCHERS_H_

#include <gmock/gmock.h>

#include "absl/status/status.h"
#include "absl/strings/match.h"

namespace gelenk::testing {

// An absl::Status of that code whose message holds `words`.
MATCHER_P2(Fails, code, words,
           absl::StatusCodeToString(code) + " and says \"" + words + "\"") {
  *result_listener << arg;
  return arg.code() == code && absl::StrContains(arg.message(), words);
}

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_STATUS_MATCHERS_H_

// Whether a sanitizer is at work, in the test and so in the server beside it:
// memory is then the sanitizer's, and says nothing about the program.
#ifndef GELENK_TESTS_TESTING_SANITIZER_H_
#define GELENK_TESTS_TESTING_SANITIZER_H_

namespace gelenk::testing {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_SANITIZER_H_

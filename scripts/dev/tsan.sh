# ./dev tsan: the tests labelled `concurrent` under ThreadSanitizer.
configure tsan -DGELENK_BUILD_BENCHMARKS=OFF
build tsan concurrent_tests
say "testing, label concurrent"
ctest --preset tsan -L '^concurrent$' --no-tests=error

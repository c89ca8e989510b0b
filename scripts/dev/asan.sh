# ./dev asan [core]: the unit tests under AddressSanitizer and
# UndefinedBehaviorSanitizer; with `core` those of the core library only, which
# needs neither contract nor server and builds in a third of the time.
service=ON
[ "${1:-}" = core ] && service=OFF
configure asan -DGELENK_BUILD_SERVICE=$service -DGELENK_BUILD_BENCHMARKS=OFF
build asan unit_tests
say "testing, label unit"
ctest --preset asan -j 2 -L '^unit$' --no-tests=error

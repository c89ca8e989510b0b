# ./dev asan [part]: the unit tests under AddressSanitizer and
# UndefinedBehaviorSanitizer. Parts: `core`, those of the core library only, which
# needs neither contract nor server; `fuzz`, of these the readers on broken input,
# which is what continuous integration always has the time for.
part=${1:-unit}
case "$part" in
  unit) service=ON ;;
  core | fuzz) service=OFF ;;
  *) die "no part \"$part\" of the unit tests; there are: core, fuzz" ;;
esac
label=$part
[ "$part" = core ] && label=unit
configure asan -DGELENK_BUILD_SERVICE="$service" -DGELENK_BUILD_BENCHMARKS=OFF
build asan "${label}_tests"
say "testing, label $label"
ctest --preset asan -j 2 -L "^$label$" --no-tests=error

# ./dev test [ctest argument]...: e.g. ./dev test -L architecture, -R pose_test
need_packages "tests on real motion clips" assimp-testmodels
need_buf || {
  [ "${CI:-}" != true ] || die "npm could not install buf"
  say "npm could not install buf: the tests that call it will be skipped"
}
configure release
build release
say "testing"
ctest --preset release -j 2 -LE soak "$@"

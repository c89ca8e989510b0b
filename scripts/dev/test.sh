# ./dev test [ctest argument]...: e.g. ./dev test -L architecture, -R pose_test
need_packages "tests on real motion clips" assimp-testmodels
need_buf || say "WARNING: no buf from npm, the tests that call it are skipped"
configure release
build release
say "testing"
ctest --preset release -j 2 -LE soak "$@"

# ./dev soak: the tests labelled `soak`, which take long on purpose.
need_packages "tests on real motion clips" assimp-testmodels
configure release
build release
say "testing, label soak"
ctest --preset release -L '^soak$' --no-tests=error "$@"

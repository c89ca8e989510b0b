# ./dev clean: removes what was built; installed packages stay.
# A private docker daemon has left files of root's there.
[ ! -d build/docker ] || as_root rm -rf build/docker
rm -rf build demo
say "removed build/ and demo/"

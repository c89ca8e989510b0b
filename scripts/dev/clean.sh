# ./dev clean: removes what was built; installed packages stay.
rm -rf build demo
say "removed build/ and demo/"

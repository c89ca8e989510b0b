# The project's own C++ files, one a line. Not from git: a bare machine has none
# installed, and new files count too.
cpp_sources() {
  find core proto server client tests -name node_modules -prune -o \
    \( -name '*.h' -o -name '*.cc' \) -type f -print | sort
}

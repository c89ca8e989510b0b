# ./dev lint [part]...: reports, changes nothing. Parts: format, buf, shell,
# tidy; all of them without an argument. `tidy` reads every .cc that is compiled,
# with its headers, about 6 s of a processor each; what was found clean and has
# not changed since is not read again. `tidy_core` reads the rooms without gRPC
# only, which is what continuous integration has the time for.
source scripts/dev/sources.sh

lint_format() {
  need_command "lint" clang-format clang-format
  cpp_sources | xargs clang-format --dry-run -Werror
}

lint_buf() {
  need_buf || {
    unchecked+=(buf)
    return 0
  }
  "$BUF" lint
}

lint_shell() {
  need_command "lint" shellcheck shellcheck
  shellcheck --shell=bash --external-sources --source-path=SCRIPTDIR/../.. \
    dev .ci/run scripts/dev/*.sh docker/*.sh
}

lint_tidy() { tidy_rooms core proto server client tests; }
lint_tidy_core() { tidy_rooms core proto; }

# tidy_rooms <folder>...
tidy_rooms() {
  need_command "lint" clang-tidy clang-tidy
  configure release
  # The generated headers have to be there; the rest need not be built.
  build release gelenk_proto gelenk_echo_proto
  mkdir -p build/tidy
  # Without the precompiled header: it is the compiler's own, and what clang-tidy
  # reads are the includes of the file.
  sed -E 's/-Winvalid-pch -include [^ ]*cmake_pch\.hxx//' \
    build/release/compile_commands.json >build/tidy/compile_commands.json
  ninja -C build/release -t deps >build/tidy/deps
  sed -En "s|^ *\"file\": \"$PWD/(.*)\"|\1|p" build/tidy/compile_commands.json |
    grep -E "^($(IFS='|' && echo "$*"))/" | sort -u |
    xargs -P "$(job_count)" -I FILE \
      bash scripts/dev/tidy_file.sh FILE build/tidy/deps
}

parts=("$@")
[ $# -gt 0 ] || parts=(format buf shell tidy)
failed=()
unchecked=()
for part in "${parts[@]}"; do
  say "lint: $part"
  "lint_$part" || failed+=("$part")
done
[ ${#unchecked[@]} = 0 ] ||
  say "lint: WARNING: not checked for want of the tool: ${unchecked[*]}"
[ ${#failed[@]} = 0 ] || die "lint found faults: ${failed[*]}"
say "lint: clean"

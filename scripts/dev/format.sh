# ./dev format: in place.
need_command "formatting" clang-format clang-format
source scripts/dev/sources.sh
say "clang-format over $(cpp_sources | wc -l) files"
cpp_sources | xargs clang-format -i
need_buf || die "npm could not install buf"
say "buf format"
"$BUF" format -w

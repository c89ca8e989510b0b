# ./dev format: in place.
need_command "formatting" clang-format clang-format
source scripts/dev/sources.sh
say "clang-format over $(cpp_sources | wc -l) files"
cpp_sources | xargs clang-format -i

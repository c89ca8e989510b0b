# tidy_file.sh <settings> <file>: clang-tidy on one file, unless the same file
# with the same settings (a digest of .clang-tidy and every header) was found
# clean before. Prints what it finds, all at once.
settings=$1 file=$2
stamp=build/tidy/${file//\//_}
digest="$(sha256sum <"$file") $settings"
[ -f "$stamp" ] && [ "$(cat "$stamp")" = "$digest" ] && exit 0
if output=$(clang-tidy -p build/release --quiet "$file" 2>/dev/null); then
  echo "$digest" >"$stamp"
else
  printf '%s\n' "$output"
  exit 1
fi

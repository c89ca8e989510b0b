# tidy_file.sh <file> <deps>: clang-tidy on one file, unless it was found clean
# before and nothing of ours that it reads has changed since. <deps> is what
# `ninja -t deps` printed in build/release. Prints what it finds, all at once.
file=$1 deps=$2
stamp=build/tidy/${file//\//_}

# The file, its headers, generated ones too, and the settings; every header of
# the tree when the file has not been compiled yet.
what_it_reads() {
  local own
  own=$(awk -v RS= -v source="/$file\n" 'index($0, source)' "$deps" |
    grep '^    ' | grep -v '^    /usr/' | sed 's/^ *//' | sort -u)
  echo "$PWD/.clang-tidy"
  echo "$PWD/tests/.clang-tidy"
  echo "$PWD/$file"
  [ -n "$own" ] && echo "$own" && return
  find "$PWD"/{core,proto,server,client,tests} -name '*.h' -o -name '*.proto'
}

digest=$(what_it_reads | (cd build/release && xargs cat) | sha256sum)
[ -f "$stamp" ] && [ "$(cat "$stamp")" = "$digest" ] && exit 0
if output=$(clang-tidy -p build/tidy --quiet "$file" 2>/dev/null); then
  echo "$digest" >"$stamp"
else
  printf '%s\n' "$output"
  exit 1
fi

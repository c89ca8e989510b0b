# Sourced by ./dev, from the root of the tree: progress lines, packages, builds.

SECONDS=0
export CCACHE_BASEDIR=${CCACHE_BASEDIR:-$PWD} CCACHE_NOHASHDIR=1
readonly BUF=tools/node/node_modules/.bin/buf

readonly BUILD_PACKAGES=(cmake ninja-build g++ libeigen3-dev libabsl-dev
  libprotobuf-dev protobuf-compiler libgrpc-dev libgrpc++-dev
  protobuf-compiler-grpc libspdlog-dev libcli11-dev libtinyxml2-dev
  nlohmann-json3-dev liblo-dev zlib1g-dev libgtest-dev libgmock-dev
  libbenchmark-dev)

# say <text>...: a progress line with the time since the start.
say() {
  printf '[dev] %d:%02d %s\n' $((SECONDS / 60)) $((SECONDS % 60)) "$*"
}

die() {
  say "$*" >&2
  exit 1
}

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

# quietly <log> <command>...: runs it, all output to the log, a line each 15 s;
# shows the end of the log if it fails.
quietly() {
  local log=$1 pid
  shift
  "$@" </dev/null >"$log" 2>&1 &
  pid=$!
  local next=$((SECONDS + 15))
  while kill -0 "$pid" 2>/dev/null; do
    sleep 0.3
    if [ "$SECONDS" -ge "$next" ]; then
      next=$((SECONDS + 15))
      say "  … $(tail -n 1 "$log" | cut -c 1-100)"
    fi
  done
  if ! wait "$pid"; then
    tail -n 25 "$log" >&2
    return 1
  fi
}

# need_packages <what for> <package>...: installs those that are missing.
need_packages() {
  local reason=$1 package missing=()
  shift
  if ! command -v dpkg-query >/dev/null; then
    say "not a Debian system: taking for granted, for $reason: $*"
    return
  fi
  for package in "$@"; do
    if [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" \
      2>/dev/null)" != installed ]; then
      missing+=("$package")
    fi
  done
  [ ${#missing[@]} = 0 ] || install_packages "$reason" "${missing[@]}"
}

install_packages() {
  local reason=$1 log
  shift
  log=$(mktemp)
  say "installing Debian packages for $reason: $*"
  quietly "$log" as_root apt-get update ||
    die "apt-get update failed; what was asked for: $*"
  quietly "$log" as_root env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y --no-install-recommends "$@" ||
    die "apt-get could not install: $*"
  rm -f "$log"
  say "installed"
}

# need_command <what for> <command> <package>...: for tools that often come from
# elsewhere than Debian.
need_command() {
  local reason=$1 command=$2
  shift 2
  command -v "$command" >/dev/null || need_packages "$reason" "$@"
}

# buf comes from npm, pinned in tools/node. Its binary is in a package of its
# own per platform, so no install script needs to run. Fails where npm's registry
# cannot be reached: the caller then says what goes unchecked.
need_buf() {
  local log
  need_command "buf" npm nodejs npm
  [ -x "$BUF" ] && [ "$BUF" -nt tools/node/package-lock.json ] && return
  log=$(mktemp)
  say "installing buf from npm (tools/node/package-lock.json)"
  quietly "$log" env npm_config_fetch_retries=1 \
    npm --prefix tools/node ci --ignore-scripts || return 1
  touch -h "$BUF"
  rm -f "$log"
}

# One compiler per processor, but not more than one per 1.5 GB of memory: that
# is what a source file with gRPC in it can take.
job_count() {
  local by_memory processors
  processors=$(nproc)
  by_memory=$(awk '/^MemAvailable/ {print int($2 / 1500000)}' /proc/meminfo)
  [ "$by_memory" -ge 1 ] || by_memory=1
  echo $((processors < by_memory ? processors : by_memory))
}

# configure <preset> [cmake argument]...
configure() {
  local preset=$1 log
  shift
  need_packages "the build" "${BUILD_PACKAGES[@]}"
  log=$(mktemp)
  say "configuring build/$preset"
  quietly "$log" cmake --preset "$preset" "$@" || die "cmake failed"
  rm -f "$log"
}

# build <preset> [target]...
build() {
  local preset=$1 targets=()
  shift
  [ $# = 0 ] || targets=(--target "$@")
  say "building $preset with $(job_count) jobs${*:+: $*}"
  cmake --build --preset "$preset" -j "$(job_count)" "${targets[@]}" ||
    die "the build failed"
  say "built"
}

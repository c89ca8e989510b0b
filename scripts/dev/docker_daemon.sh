# Sourced: gives `docker` a daemon. One that runs already is used as it is. On a
# machine without one (a container, a CI runner) use_docker starts a private one
# with a Debian base image made on the spot, and stop_docker ends it. Images and
# layers stay in build/docker for the next time.

docker_dir=$PWD/build/docker
# Sockets and the pid file of the private daemon; its path has to be short.
docker_run_dir=
base_image=debian:bookworm-slim
# How to build: with a private daemon there is no bridge network, and the
# builder that needs none is the classic one.
# shellcheck disable=SC2034  # Used where this is sourced.
docker_build=(docker build)

use_docker() {
  if command -v docker >/dev/null && docker info >/dev/null 2>&1; then
    say "using the running docker daemon"
    return
  fi
  need_packages "a private docker daemon" docker.io iptables mmdebstrap \
    procps
  start_docker
  # shellcheck disable=SC2034
  docker_build=(env DOCKER_BUILDKIT=0 docker build --network host)
  make_base
}

start_docker() {
  docker_run_dir=$(mktemp -d)
  mkdir -p "$docker_dir"
  export DOCKER_HOST=unix://$docker_run_dir/docker.sock
  say "starting a private docker daemon"
  as_root dockerd --iptables=false --ip6tables=false --bridge=none \
    --storage-driver=overlay2 --data-root "$docker_dir/data" \
    --exec-root "$docker_run_dir/exec" --pidfile "$docker_run_dir/pid" \
    --group "$(id -gn)" --host "$DOCKER_HOST" \
    </dev/null >"$docker_dir/dockerd.log" 2>&1 &
  for _ in $(seq 60); do
    ! docker info >/dev/null 2>&1 || return 0
    sleep 0.5
  done
  tail -n 20 "$docker_dir/dockerd.log" >&2
  die "the docker daemon did not start"
}

# Ends the private daemon, if there is one, and removes what it left mounted.
stop_docker() {
  local pid
  [ -n "$docker_run_dir" ] || return 0
  if [ -s "$docker_run_dir/pid" ]; then
    pid=$(cat "$docker_run_dir/pid")
    as_root kill -TERM "$pid" 2>/dev/null || true
    for _ in $(seq 150); do
      as_root kill -0 "$pid" 2>/dev/null || break
      sleep 0.1
    done
    as_root kill -KILL "$pid" 2>/dev/null || true
  fi
  as_root umount "$docker_run_dir/exec/netns/default" 2>/dev/null || true
  as_root rm -rf "$docker_run_dir"
}

# What debian:bookworm-slim is elsewhere: a minimal root without documentation,
# made from this machine's own apt sources and settings.
make_base() {
  local tar=$docker_dir/base.tar settings sources
  ! docker image inspect "$base_image" >/dev/null 2>&1 || return 0
  if [ ! -s "$tar" ]; then
    say "making $base_image with mmdebstrap"
    mapfile -t settings < <(apt_settings)
    mapfile -t sources < <(apt_sources)
    quietly "$docker_dir/base.log" as_root mmdebstrap "${base_options[@]}" \
      "${settings[@]}" bookworm "$tar.part" "${sources[@]}" ||
      die "mmdebstrap failed"
    as_root mv "$tar.part" "$tar"
  fi
  docker import "$tar" "$base_image" >/dev/null
}

base_options=(--variant=minbase --include=ca-certificates --format=tar
  --dpkgopt='path-exclude=/usr/share/man/*'
  --dpkgopt='path-exclude=/usr/share/locale/*'
  --dpkgopt='path-exclude=/usr/share/doc/*'
  --dpkgopt='path-include=/usr/share/doc/*/copyright')

# This machine's sources of bookworm; none means mmdebstrap's own choice.
apt_sources() {
  grep -lsE '^(deb .*|Suites:.*)\bbookworm\b' /etc/apt/sources.list \
    /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources || true
}

# Files with settings on how to fetch, a proxy for example.
apt_settings() {
  grep -lsE '^Acquire' /etc/apt/apt.conf /etc/apt/apt.conf.d/* |
    sed 's/^/--aptopt=/' || true
}

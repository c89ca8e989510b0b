# ./dev docker-test: builds the image, runs it with few rights, plays a clip
# against it from a second container, and stops it with SIGTERM.
source scripts/dev/docker_daemon.sh

image=gelenk:test
server=gelenk-test-$$
hardened=(--read-only --tmpfs /tmp --cap-drop ALL
  --security-opt no-new-privileges --pids-limit 256 --memory 512m)

remove_server() {
  docker rm --force "$server" >/dev/null 2>&1 || true
}
trap 'remove_server; stop_docker' EXIT
trap 'exit 130' INT TERM

build_image() {
  local log=$docker_dir/build.log arguments=() variable
  for variable in http_proxy https_proxy no_proxy; do
    [ -z "${!variable:-}" ] || arguments+=(--build-arg "$variable")
  done
  say "building the image"
  mkdir -p "$docker_dir"
  quietly "$log" "${docker_build[@]}" -f docker/Dockerfile -t "$image" \
    "${arguments[@]}" . || die "the image could not be built"
  say "image size: $(docker image inspect --format '{{.Size}}' "$image" |
    awk '{printf "%.0f MB", $1 / 1e6}')"
}

# The server has a network of its own with nothing but a loopback in it.
start_server() {
  say "starting gelenkd: ${hardened[*]}"
  docker run --detach --name "$server" --network none "${hardened[@]}" \
    "$image" --listen 127.0.0.1:50051 --port-file /tmp/port >/dev/null
  for _ in $(seq 100); do
    ! docker exec "$server" test -s /tmp/port 2>/dev/null || return 0
    sleep 0.1
  done
  docker logs "$server" >&2
  die "gelenkd did not come up"
}

# The client joins the server's network.
play_clip() {
  say "playing a clip against it"
  timeout 120 docker run --rm --network "container:$server" "${hardened[@]}" \
    --volume /usr/share/assimp/models/BVH:/clips:ro --entrypoint gelenk \
    "$image" --server 127.0.0.1:50051 play /clips/01_01.bvh \
    --out /tmp/01_01.bvh || die "the clip could not be played"
}

stop_server() {
  local code
  say "SIGTERM"
  docker kill --signal TERM "$server" >/dev/null
  code=$(timeout 60 docker wait "$server") || die "gelenkd does not end"
  docker logs "$server" 2>&1 | tail -n 5
  [ "$code" = 0 ] || die "gelenkd ended with $code, not 0"
}

need_packages "a recorded walk to play" assimp-testmodels
use_docker
build_image
start_server
play_clip
stop_server
say "docker-test: passed"

# ./dev docker-test: builds the image, runs it with few rights, plays a clip
# against it from a second container, and stops it with SIGTERM; then brings
# docker/compose.yaml up and down.
source scripts/dev/docker_daemon.sh

image=gelenk:test
clips=/usr/share/assimp/models/BVH
clip=01_01.bvh
hardened=(--read-only --tmpfs /tmp --cap-drop ALL
  --security-opt no-new-privileges --pids-limit 256 --memory 512m)
# gelenkd's own --drain, after which it may take 2 s more to close.
drain_seconds=20
server=
project=gelenk-test-$$
scratch=$(mktemp -d)

clean_up() {
  [ -z "$server" ] || docker rm --force "$server" >/dev/null 2>&1 || true
  [ ${#compose[@]} = 0 ] || run_compose down >/dev/null 2>&1 || true
  stop_docker
  rm -rf "$scratch"
}
compose=()
trap clean_up EXIT
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

# A port of loopback on which nobody listens, below those that the kernel gives
# to clients.
free_port() {
  local port
  while :; do
    port=$((20000 + RANDOM % 12000))
    (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null || break
  done
  echo "$port"
}

# wait_until_healthy <container>: until the image's own health check says so.
wait_until_healthy() {
  local status
  for _ in $(seq 150); do
    status=$(docker inspect --format '{{.State.Health.Status}}' "$1")
    [ "$status" != healthy ] || return 0
    sleep 0.2
  done
  docker inspect --format '{{json .State.Health}}' "$1" >&2
  docker logs "$1" >&2
  die "gelenkd is not healthy but $status"
}

start_server() {
  say "starting gelenkd: ${hardened[*]}"
  server=$(docker run --detach --network host "${hardened[@]}" \
    --health-interval 1s --env GELENKD_LISTEN="$address" "$image")
  wait_until_healthy "$server"
  say "healthy on $address"
}

check_unprivileged() {
  local users
  users=$(docker top "$server" -o pid,uid | awk 'NR > 1 {print $2}' | sort -u)
  [ "$users" = 10001 ] || die "gelenkd runs as user $users, not 10001"
}

# gelenk <argument>...: the command line, in a container of its own.
gelenk() {
  timeout 120 docker run --rm --network host "${hardened[@]}" \
    --volume "$clips:/clips:ro" --entrypoint /usr/local/bin/gelenk \
    "$image" --server "$address" "$@"
}

# Every frame of the clip has to be answered, on one connection.
play_clip() {
  local frames
  frames=$(awk '/^Frames:/ {print $2 + 0}' "$clips/$clip")
  say "playing $clip against it"
  gelenk play "/clips/$clip" --out "/tmp/$clip" | tee "$scratch/played" ||
    die "the clip could not be played"
  grep -Eq "^frames +$frames answered, 0 merged, 0 refused; 0 reconnects$" \
    "$scratch/played" || die "not every one of $frames frames was answered"
}

stop_server() {
  local code start=$SECONDS
  say "SIGTERM"
  docker kill --signal TERM "$server" >/dev/null
  code=$(timeout "$drain_seconds" docker wait "$server") ||
    die "gelenkd does not end within $drain_seconds s"
  docker logs "$server" 2>&1 | tail -n 5
  [ "$code" = 0 ] || die "gelenkd ended with $code, not 0"
  say "ended with 0 after $((SECONDS - start)) s"
}

find_compose() {
  if docker compose version >/dev/null 2>&1; then
    compose=(docker compose)
  else
    need_command "docker/compose.yaml" docker-compose docker-compose
    compose=(docker-compose)
  fi
}

run_compose() {
  GELENK_IMAGE=$image GELENKD_LISTEN=$address "${compose[@]}" \
    --project-name "$project" --file docker/compose.yaml "$@"
}

try_compose() {
  local log=$scratch/compose container code
  say "docker/compose.yaml up"
  run_compose config --quiet || die "compose.yaml is not valid"
  quietly "$log" run_compose up --detach --no-build || die "it does not come up"
  container=$(run_compose ps --quiet gelenkd)
  wait_until_healthy "$container"
  gelenk sessions || die "it does not answer"
  say "docker/compose.yaml down"
  quietly "$log" run_compose stop || die "it does not stop"
  code=$(docker inspect --format '{{.State.ExitCode}}' "$container")
  [ "$code" = 0 ] || die "gelenkd ended with $code, not 0"
  quietly "$log" run_compose down || die "it does not go down"
}

need_packages "a recorded walk to play" assimp-testmodels
use_docker
find_compose
build_image
address=127.0.0.1:$(free_port)
start_server
check_unprivileged
play_clip
stop_server
try_compose
say "docker-test: passed"

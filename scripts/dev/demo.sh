# ./dev demo: a recorded walk, played frame by frame through a running server.
need_packages "a recorded walk to play" assimp-testmodels
configure release
build release gelenkd gelenk

clip=/usr/share/assimp/models/BVH/01_01.bvh
bin=build/release
scratch=$(mktemp -d)
server_pid=

# Ends the server by its pid: politely, then after 5 s not.
stop_server() {
  local tries=0
  [ -n "$server_pid" ] || return 0
  kill -TERM "$server_pid" 2>/dev/null || true
  while kill -0 "$server_pid" 2>/dev/null && [ $((tries += 1)) -le 50 ]; do
    sleep 0.1
  done
  kill -KILL "$server_pid" 2>/dev/null || true
  wait "$server_pid" 2>/dev/null || true
  server_pid=
}
trap 'stop_server; rm -rf "$scratch"' EXIT
trap 'exit 130' INT TERM

"$bin/server/gelenkd" --listen 127.0.0.1:0 --port-file "$scratch/port" \
  </dev/null >"$scratch/gelenkd.log" 2>&1 &
server_pid=$!
for _ in $(seq 100); do
  [ ! -s "$scratch/port" ] || break
  kill -0 "$server_pid" 2>/dev/null || break
  sleep 0.1
done
[ -s "$scratch/port" ] || {
  cat "$scratch/gelenkd.log" >&2
  die "the server did not come up"
}
port=$(cat "$scratch/port")
say "gelenkd listens on 127.0.0.1:$port (pid $server_pid)"

mkdir -p demo
timeout 120 "$bin/client/gelenk" --server "127.0.0.1:$port" play "$clip" \
  --out demo/01_01.gelenk.bvh --picture demo/01_01.svg ||
  die "the clip could not be played"
stop_server
say "the server has stopped; written:"
ls -l demo/01_01.gelenk.bvh demo/01_01.svg

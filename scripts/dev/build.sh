# ./dev build [preset] [target]...
preset=${1:-release}
[ $# -gt 0 ] && shift
configure "$preset"
build "$preset" "$@"

# ./dev bench [name]: the benchmark programs whose name contains `name`.
need_packages "benchmarks beside other solvers" liborocos-kdl-dev
configure release
build release
mapfile -t programs < <(find build/release -name "*${1:-}*_benchmark" \
  -type f -perm -u+x | sort)
[ ${#programs[@]} -gt 0 ] || die "no benchmark contains \"${1:-}\""
for program in "${programs[@]}"; do
  say "${program#build/release/}"
  "$program"
done

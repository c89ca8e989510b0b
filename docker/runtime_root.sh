# runtime_root.sh ROOT PROGRAM...: fills ROOT with what an image needs to run the
# programs and nothing else: them, stripped, and the shared libraries that they
# load. With each library comes its package's copyright, and dpkg's record of it
# where scanners for vulnerabilities look (var/lib/dpkg/status.d).
set -eu
root=$1
shift

# What `ldd` says of the programs, as paths; the loader is one of them.
libraries() {
  ldd "$@" | awk '
    /not found/ {print > "/dev/stderr"; missing = 1}
    $3 ~ /^\// {print $3}
    $1 ~ /^\/.*ld-linux/ {print $1}
    END {exit missing}'
}

# package_of LIBRARY. dpkg knows some files by their path before /lib became
# /usr/lib.
package_of() {
  real=$(readlink -f "$1")
  dpkg-query -S "$real" 2>/dev/null || dpkg-query -S "${real#/usr}"
}

mkdir -p "$root/usr/local/bin" "$root/var/lib/dpkg/status.d"
install -d -m 1777 "$root/tmp"
install -s "$@" "$root/usr/local/bin"
libraries "$@" >/tmp/libraries
sort -u -o /tmp/libraries /tmp/libraries
xargs cp -L --parents -t "$root" </tmp/libraries
while read -r library; do
  package_of "$library"
done </tmp/libraries >/tmp/packages
sed 's/:.*//' /tmp/packages | sort -u | while read -r package; do
  dpkg-query -s "$package" >"$root/var/lib/dpkg/status.d/$package"
  cp -L --parents -t "$root" "/usr/share/doc/$package/copyright"
done
# Scanners want to know whose packages these are.
cp -L --parents -t "$root" /etc/os-release
install -D -m 644 docker/LICENSE "$root/usr/share/doc/gelenk/copyright"

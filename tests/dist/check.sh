#!/usr/bin/env bash
# Checks an archive of `make dist`: its files, its libraries, and that its program runs a study of piston and
# film, and exports it.  tests/dist/check.sh ARCHIVE
set -euo pipefail
archive=$(realpath "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
tar -xzf "$archive" -C "$folder"
cd "$folder"/billow-*

for file in billow README.md LICENSE-MIT LICENSE-APACHE LICENCES-OF-DEPENDENCIES.txt man/billow.1 \
  completions/billow.bash completions/billow.zsh completions/billow.fish; do
  [ -s "$file" ] || { echo "check.sh: $archive: $file is missing" >&2; exit 1; }
done
for part in hdf5-metno-src "The HDF Group" libz-sys polars; do
  grep -q "$part" LICENCES-OF-DEPENDENCIES.txt || { echo "check.sh: no licence of $part" >&2; exit 1; }
done

others=$(ldd billow | awk '{ print $1 }' |
  grep -vE '^(linux-vdso\.so\.1|libc\.so\.6|libm\.so\.6|libgcc_s\.so\.1|/lib64/ld-linux-x86-64\.so\.2)$' || true)
if [ -n "$others" ]; then
  echo "check.sh: the program needs $others; allowed: libc, libm, libgcc" >&2
  exit 1
fi

cat > study.json << 'STUDY'
{
  "design": {"fit": "height", "bottom_radius": "500 mm", "height": "1 m", "alpha1_over_phi": 1, "M": 3},
  "solver": {"end_time": "20 ms"},
  "grid": {"solver.model": ["piston", "film"], "N": [5, 6], "mass_flow_rate": ["1 g/s", "2 g/s"]}
}
STUDY
run=(env -i "HOME=$folder" ./billow)
"${run[@]}" run study.json --quiet > /dev/null
"${run[@]}" export results/study --out study.nc
echo "$(basename "$archive"): $(du -h "$archive" | cut -f 1), its program needs only libc, libm and libgcc"

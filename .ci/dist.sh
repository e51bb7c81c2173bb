#!/usr/bin/env bash
# Builds a self-contained program, with HDF5 and zlib compiled in, and packs it with README, licences,
# completions and a man page: target/dist/billow-VERSION-COMMIT-x86_64-linux.tar.gz. It is built in a target
# folder of its own, so that the normal build keeps its libraries.
set -euo pipefail
cd "$(dirname "$0")/.."

# HDF5's build needs CMake 3.26; Debian 12 has 3.25, PyPI a newer one.
cmake_version=3.31.6
target=${CARGO_TARGET_DIR:-target}
mkdir -p "$target/dist"
target=$(cd "$target" && pwd)
dist=$target/dist
venv=$dist/cmake-$cmake_version
if [ ! -x "$venv/bin/cmake" ]; then
  python3 -m venv "$venv"
  "$venv/bin/pip" install --quiet --disable-pip-version-check "cmake==$cmake_version"
fi

# It starts from what the normal build has compiled: all but HDF5, and what depends on it, is the same.
if [ ! -d "$dist/build" ] && [ -d "$target/release" ]; then
  rm -rf "$dist/build.part"
  mkdir "$dist/build.part"
  cp -a --reflink=auto "$target/release" "$dist/build.part"
  mv "$dist/build.part" "$dist/build"
fi

PATH=$venv/bin:$PATH LIBZ_SYS_STATIC=1 CARGO_TARGET_DIR=$dist/build \
  cargo build --release --locked -p billow-study --features self-contained

version=$(cargo metadata --format-version 1 --no-deps --locked |
  python3 -c 'import json, sys; print(json.load(sys.stdin)["packages"][0]["version"])')
commit=$(git rev-parse --short=12 HEAD 2> /dev/null || echo unknown)
[ -z "$(git status --porcelain --untracked-files=no 2> /dev/null)" ] || commit=$commit-changed
name=billow-$version-$commit-$(uname -m)-linux
folder=$dist/$name
rm -rf "$folder"
mkdir -p "$folder/completions" "$folder/man"
strip -o "$folder/billow" "$dist/build/release/billow"
cp README.md LICENSE-MIT LICENSE-APACHE "$folder"
cp study/assets/DejaVuSans-LICENSE.txt "$folder"
.ci/licences.py > "$folder/LICENCES-OF-DEPENDENCIES.txt"
for shell in bash zsh fish; do
  "$folder/billow" completions "$shell" > "$folder/completions/billow.$shell"
done
.ci/man_page.py "$folder/billow" > "$folder/man/billow.1"
# The same tree gives the same archive.
tar --sort=name --owner=0 --group=0 --numeric-owner --mtime='2000-01-01 00:00Z' -C "$dist" -cf - "$name" |
  gzip -n > "$folder.tar.gz.part"
mv "$folder.tar.gz.part" "$folder.tar.gz"
rm -rf "$folder"
tests/dist/check.sh "$folder.tar.gz"
echo "$folder.tar.gz"

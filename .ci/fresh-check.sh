#!/usr/bin/env bash
# Tries both README commands on a bare machine: a fresh Debian 12 root with gcc, make, git and apt
# only, this machine's Rust toolchain and its client configuration (certificates, apt, pip), and a
# fresh clone of the committed tree. Root only. Keeps nothing.
#
#   FRESH_TARGET=DIR  use (and keep) this folder for compiled dependencies; default: none, cold
set -euo pipefail
cd "$(dirname "$0")/.."

if [ "$(id -u)" -ne 0 ]; then
  echo "fresh-check builds a Debian root and needs root. Run: sudo make fresh-check" >&2
  exit 1
fi
if [ -z "${BILLOW_FRESH_MOUNTS:-}" ]; then
  "$(dirname "$0")/install.sh" debootstrap
  # In a mount namespace of its own, whatever is mounted below is gone when it ends.
  BILLOW_FRESH_MOUNTS=1 exec unshare --mount "$0"
fi
mount --make-rprivate /

root=$(mktemp -d)
cargo_home=${CARGO_HOME:-$HOME/.cargo}
rustup_home=${RUSTUP_HOME:-$HOME/.rustup}
clean() {
  # A folder of this machine may still be mounted below, on the same device: nothing is deleted through it.
  umount -R "$root" 2> /dev/null || umount -R -l "$root" 2> /dev/null || true
  if grep -qF " $root" /proc/self/mounts; then
    echo "$root is still in use and is left there; unmount what is below it, then remove it" >&2
    return
  fi
  rm -rf --one-file-system "$root"
}
trap clean EXIT

mirror=$(grep -rhoE 'https?://[^ ]+/debian/?( |$)' /etc/apt/sources.list /etc/apt/sources.list.d 2> /dev/null |
  head -n 1 | tr -d ' ' || true)
debootstrap --variant=minbase --include=gcc,libc6-dev,make,git,ca-certificates \
  bookworm "$root" ${mirror:+"$mirror"}
mount --bind "$root" "$root"

rm -f "$root/etc/apt/sources.list"
cp -a /etc/apt/. "$root/etc/apt/"
# Copied, not mounted: packages write there.
cp -a /etc/ssl/. "$root/etc/ssl/"
cp -a /usr/share/keyrings/. "$root/usr/share/keyrings/"
if [ -d /usr/local/share/ca-certificates ]; then
  mkdir -p "$root/usr/local/share/ca-certificates"
  cp -a /usr/local/share/ca-certificates/. "$root/usr/local/share/ca-certificates/"
fi
cp -L /etc/resolv.conf "$root/etc/resolv.conf"
[ ! -f /etc/pip.conf ] || cp /etc/pip.conf "$root/etc/pip.conf"
share() { # folder, mount options
  mkdir -p "$root$1"
  mount --bind "$1" "$root$1"
  [ -z "${2:-}" ] || mount -o "remount,bind,$2" "$root$1"
}
share "$rustup_home" ro
share "$cargo_home"
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"

git clone --quiet --no-hardlinks . "$root/billow"
inside=(env -i HOME=/root TERM=dumb LANG=C.UTF-8 "CARGO_HOME=$cargo_home" "RUSTUP_HOME=$rustup_home"
  "PATH=$cargo_home/bin:/usr/sbin:/usr/bin:/sbin:/bin")
for name in SSL_CERT_FILE SSL_CERT_DIR PIP_CERT PIP_INDEX_URL CARGO_HTTP_CAINFO http_proxy https_proxy \
  no_proxy RUSTUP_AUTO_INSTALL; do
  [ -z "${!name:-}" ] || inside+=("$name=${!name}")
done
if [ -n "${FRESH_TARGET:-}" ]; then
  mkdir -p "$FRESH_TARGET" "$root/target"
  mount --bind "$FRESH_TARGET" "$root/target"
  inside+=(CARGO_TARGET_DIR=/target)
fi

for target in study test; do
  start=$SECONDS
  echo "== fresh: make $target"
  chroot "$root" "${inside[@]}" make -C /billow "$target"
  echo "== fresh: make $target took $((SECONDS - start)) s"
done

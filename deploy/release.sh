#!/usr/bin/env bash
# Makes a release: one archive per target with a stripped binary, its papers, and a checksum beside it.
#
#   deploy/release.sh                                   # for this machine, into target/release-archives
#   deploy/release.sh --out DIR x86_64-unknown-linux-gnu aarch64-unknown-linux-gnu
#   deploy/release.sh --binary FILE                     # packs a binary that is built already
#
# An archive needs no compiler, no Rust and no network: maps, requests, templates and the configuration are in the
# binary. The same sources and compiler give the same archive.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() { echo "release: $*" >&2; exit 2; }
need() { command -v "$1" >/dev/null 2>&1 || fail "\`$1\` is missing: $2"; }

# Most that a program may take on a disk that was built here, bytes.
largest=90000000
out=target/release-archives binary='' targets=()
while [ $# -gt 0 ]; do
  case "$1" in
    --out) [ $# -gt 1 ] || fail "--out takes a folder"; out=$2; shift 2 ;;
    --binary) [ $# -gt 1 ] || fail "--binary takes a file"; binary=$2; shift 2 ;;
    -h | --help) sed -n '2,9s/^# \{0,1\}//p' "$0"; exit 0 ;;
    -*) fail "unknown option \`$1\`: --out DIR, --binary FILE and names of targets are known" ;;
    *) targets+=("$1"); shift ;;
  esac
done

need cargo "a Rust toolchain builds the binary"
need strip "it comes with the C compiler (Debian: apt-get install binutils)"
need tar "GNU tar packs the archive"
need sha256sum "it makes the checksum (Debian: apt-get install coreutils)"
host=$(rustc -vV | sed -n 's/^host: //p')
[ ${#targets[@]} -gt 0 ] || targets=("$host")
[ -z "$binary" ] || [ ${#targets[@]} -eq 1 ] || fail "--binary is of one target"
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
[ -n "$version" ] || fail "Cargo.toml names no version"

# Samples: a shipped scenario in every format of others, without its bundle, which holds times. They are the same for all targets, and
# are made by a program of this machine with every feature; a binary that was given makes those that it writes itself.
samples=$(mktemp -d)
trap 'rm -rf "$samples"' EXIT
if [ -n "$binary" ] && [ "${targets[0]}" = "$host" ]; then
  maker=$(realpath "$binary")
else
  cargo build --release --locked -p socrates --features parquet
  maker=$samples/socrates
  cp "${CARGO_TARGET_DIR:-target}/release/socrates" "$maker"
fi
requests=$PWD/maps
(
  cd "$samples"
  "$maker" run "$requests/office/scenarios/doorway.toml" --out doorway >&2 || fail "the sample was not made"
  "$maker" export --formats | while read -r format _; do
    "$maker" export doorway --to "$format" --out "samples/$format" >&2 || fail "no sample of \`$format\`"
  done
)

# Every paper that the README links to comes along, at its place, so that no link is dead.
papers=$(grep -oE '\]\([^)#: ]+' README.md | sed 's/^](//' | sort -u)
mkdir -p "$out"
for target in "${targets[@]}"; do
  built=$binary
  if [ -z "$built" ]; then
    if [ "$target" = "$host" ]; then
      cargo build --release --locked -p socrates
      built=${CARGO_TARGET_DIR:-target}/release/socrates
    else
      cargo build --release --locked -p socrates --target "$target"
      built=${CARGO_TARGET_DIR:-target}/$target/release/socrates
    fi
  fi
  [ -f "$built" ] || fail "there is no binary \`$built\`"
  name=socrates-$version-$target
  stage=$(mktemp -d)
  trap 'rm -rf "$stage" "$samples"' EXIT
  root=$stage/$name
  mkdir -p "$root/requests"
  install -m 755 "$built" "$root/socrates"
  strip_tool='strip'
  if [ "$target" != "$host" ] && command -v "${target%%-*}-linux-gnu-strip" >/dev/null 2>&1; then
    strip_tool=${target%%-*}-linux-gnu-strip
  fi
  "$strip_tool" "$root/socrates"
  size=$(stat -c %s "$root/socrates")
  [ -n "$binary" ] || [ "$size" -le $largest ] || fail "the program has $size bytes, more than $largest"
  install -m 644 README.md LICENSE "$root/"
  install -m 644 deploy/socrates.toml "$root/socrates.toml.default"
  for paper in $papers; do
    install -D -m 644 "$paper" "$root/$paper"
  done
  for request in maps/*/scenarios/*.toml; do
    install -m 644 "$request" "$root/requests/$(basename "$(dirname "$(dirname "$request")")")-$(basename "$request")"
  done
  cp -r "$samples/samples" "$root/samples"
  # What is linked in, with its license.
  {
    echo "The binary contains these packages, each under its own license:"
    cargo tree --locked -p socrates --edges normal --target "$target" --prefix none --format '{p}  {l}' |
      sed 's/ ([^)]*)//g' | grep -v '^socrates' | sort -u
  } >"$root/THIRD-PARTY.txt"
  archive=$name.tar.gz
  tar --sort=name --owner=0 --group=0 --numeric-owner --mtime="@${SOURCE_DATE_EPOCH:-0}" -C "$stage" -cf - "$name" | gzip -n >"$out/$archive"
  (cd "$out" && sha256sum "$archive" >"$archive.sha256")
  rm -rf "$stage"
  trap 'rm -rf "$samples"' EXIT
  echo "$out/$archive"
done

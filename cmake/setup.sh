# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by ./quickstart and ./check: installs what a list of packages names and is missing, then builds build/release.

# A program loads no library of its own that others may write to (lib/base/own_files.h).
umask 022

say() { printf '\n== %s\n' "$*"; }

# install_packages LIST...: what these files name, one package a line, `#` begins a comment.
install_packages() {
  local wanted missing=() p sudo=()
  mapfile -t wanted < <(sed 's/#.*//; s/[[:space:]]*$//; /^$/d' "$@")
  for p in "${wanted[@]}"; do
    [[ $(dpkg-query -W -f '${db:Status-Status}' "$p" 2>/dev/null || true) == installed ]] || missing+=("$p")
  done
  ((${#missing[@]})) || return 0
  if (($(id -u) != 0)); then
    command -v sudo >/dev/null || { echo "needs root, or sudo, to install: ${missing[*]}" >&2; return 73; }
    sudo=(sudo)
  fi
  say "Installing ${#missing[@]} packages with apt-get"
  "${sudo[@]}" apt-get update -q
  "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
}

# How many compilers run at once: one for each core, and no more than memory holds at 1.5 GB each.
jobs_that_fit() {
  local jobs cores available_kb
  cores=$(nproc)
  available_kb=$(awk '$1 == "MemAvailable:" { print $2 }' /proc/meminfo)
  jobs=$((${available_kb:-0} / 1500000))
  ((jobs <= cores)) || jobs=$cores
  ((jobs >= 1)) || jobs=1
  echo "$jobs"
}

# build_release [-DNAME=VALUE...] [--target TARGET...]: configures where there is no build yet, or where a value is another.
build_release() {
  local jobs define=()
  jobs=$(jobs_that_fit)
  while [[ ${1:-} == -D* ]]; do
    define+=("$1")
    shift
  done
  say "Building build/release, $jobs at a time"
  local d configure=0
  [[ -f build/release/build.ninja ]] || configure=1
  for d in "${define[@]}"; do
    d=${d#-D}
    grep -qx "${d%%=*}:BOOL=${d#*=}" build/release/CMakeCache.txt 2>/dev/null || configure=1
  done
  ((!configure)) || cmake --preset release "${define[@]}"
  cmake --build --preset release -j "$jobs" "$@"
}

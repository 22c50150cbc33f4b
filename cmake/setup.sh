# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by ./quickstart and ./check: installs what packages.txt names and is missing, then builds build/release.

say() { printf '\n== %s\n' "$*"; }

install_packages() {
  local wanted missing=() p sudo=()
  mapfile -t wanted < <(sed 's/#.*//; /^[[:space:]]*$/d' packages.txt)
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

build_release() {
  say "Building build/release"
  [[ -f build/release/build.ninja ]] || cmake --preset release
  cmake --build --preset release "$@"
}

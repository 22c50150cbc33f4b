#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Built with TREPHINE_HEADLESS the simulator loads nothing that draws, and has no command that would.
. "$(dirname "$0")/common.sh"
ldd "$TREPHINE" >"$work/libraries"
grep -q 'libstdc++' "$work/libraries" || fail "ldd says nothing: $(cat "$work/libraries")"
! grep -iE 'lib(GL|EGL|epoxy|glfw|X11|xcb|wayland|imgui|stb)' "$work/libraries" || fail "it loads these"
for command in play render; do expect 64 "$command" "$TREPHINE" "$command" "$work"; done

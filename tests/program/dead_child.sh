#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The decoding child is killed, by a fault and outright: one line, 70, no output, no core file, no temporary file (P5).
. "$(dirname "$0")/common.sh"
mkdir "$work/cwd"
cd "$work/cwd"
ulimit -c unlimited 2>/dev/null || true
for signal in SEGV KILL; do
  killed=no
  # The child lives for a fraction of a second: tried until it was met.
  for try in {1..20}; do
    "$TREPHINE" import "$SOURCE/sample_dicom" --output volume.nrrd --quiet >"$work/stdout" 2>"$work/stderr" &
    program=$!
    while kill -0 $program 2>/dev/null; do
      for child in $(cat /proc/$program/task/*/children 2>/dev/null); do
        if grep -aq dicom-decode "/proc/$child/cmdline" 2>/dev/null && kill -$signal "$child" 2>/dev/null; then killed=yes; fi
      done
    done
    code=0
    wait $program || code=$?
    [[ $killed == yes && $code != 0 ]] && break
    rm -f volume.nrrd
  done
  [[ $killed == yes ]] || fail "no decoding child was met"
  [[ $code == 70 ]] || { cat "$work/stderr"; fail "exit code $code after $signal"; }
  [[ $(wc -l <"$work/stderr") == 1 ]] || { cat "$work/stderr"; fail "not one line on stderr"; }
  grep -Eq "^trephine import: .*(signal|decode)" "$work/stderr" || { cat "$work/stderr"; fail "the line does not say what died"; }
  [[ -z $(ls -A) ]] || { ls -A; fail "files are left after $signal"; }
done
echo ok

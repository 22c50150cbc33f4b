#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The decoding child is killed, by a fault and outright: one line, 70, no output, no core file, no temporary file (P5).
. "$(dirname "$0")/common.sh"
: "${FAULT:?}"
mkdir "$work/cwd"
cd "$work/cwd"
ulimit -c unlimited 2>/dev/null || true
# In the child alone, early in its work and late, at the same place on any machine.
for signal in SEGV KILL; do
  for allocation in 2 20; do
    expect 70 '^trephine import: .*(signal|decode)' env "LD_PRELOAD=$FAULT" "TREPHINE_FAULT=signal:$allocation:$(kill -l $signal)" \
      TREPHINE_FAULT_IN=dicom-decode "$TREPHINE" import "$SOURCE/sample_dicom" --output volume.nrrd --quiet
    [[ -z $(ls -A) ]] || { ls -A; fail "files are left after $signal"; }
  done
done
echo ok

#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# library_faults.sh with every fault in turn.
LONG=1 PART=all exec bash "$(dirname "$0")/library_faults.sh"

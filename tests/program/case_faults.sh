#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# library_faults.sh for the run of one case alone.
PART=cases exec bash "$(dirname "$0")/library_faults.sh"

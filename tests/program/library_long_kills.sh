# SPDX-License-Identifier: GPL-3.0-or-later
# library_kills.sh with 100 kills.
LONG=1 exec bash "$(dirname "$0")/library_kills.sh"

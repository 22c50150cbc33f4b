# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_fluoro)
trephine_test(fluoro fluoro)
endif()

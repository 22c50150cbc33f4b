# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_peers)
trephine_test(touch touch haptics peers)
endif()

# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_haptics)
trephine_test(sound haptics)
endif()

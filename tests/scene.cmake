# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_scene)
trephine_test(scene scene)
endif()

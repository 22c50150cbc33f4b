# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_drill)
trephine_test(drill drill contact meshing)
endif()

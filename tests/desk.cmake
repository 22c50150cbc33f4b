# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine AND TARGET trephine_desk)
trephine_test(desk desk)
endif()

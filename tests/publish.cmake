# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_picture)
trephine_test(publish publish)
endif()

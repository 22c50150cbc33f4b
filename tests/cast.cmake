# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_cast)
trephine_test(cast cast contact)
endif()

# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_trade)
trephine_test(trade trade)
endif()

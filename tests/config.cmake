# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_config)
trephine_test(config publish)
endif()

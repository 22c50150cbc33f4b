# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_texts)
trephine_test(texts texts)
endif()

# SPDX-License-Identifier: GPL-3.0-or-later
list(APPEND TREPHINE_TEST_AT_ONCE apparatus)
trephine_test(apparatus body head phantom)

# SPDX-License-Identifier: GPL-3.0-or-later
list(APPEND TREPHINE_TEST_AT_ONCE outcome)
trephine_test(outcome outcome phantom)

# SPDX-License-Identifier: GPL-3.0-or-later
list(APPEND TREPHINE_TEST_AT_ONCE body)
trephine_test(body body head phantom)

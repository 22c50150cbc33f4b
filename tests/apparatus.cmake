# SPDX-License-Identifier: GPL-3.0-or-later
trephine_test(apparatus body head phantom)

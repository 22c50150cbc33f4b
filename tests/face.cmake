# SPDX-License-Identifier: GPL-3.0-or-later
list(APPEND TREPHINE_TEST_AT_ONCE face)
trephine_test(face face head phantom dicom meshing)

# SPDX-License-Identifier: GPL-3.0-or-later
list(APPEND TREPHINE_TEST_AT_ONCE craniometry)
trephine_test(craniometry head phantom cases dicom meshing boolean)

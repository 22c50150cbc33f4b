# SPDX-License-Identifier: GPL-3.0-or-later
list(APPEND TREPHINE_TEST_AT_ONCE landmarks)
trephine_test(landmarks head phantom cases dicom meshing boolean)

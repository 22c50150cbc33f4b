# SPDX-License-Identifier: GPL-3.0-or-later
trephine_test(landmarks head phantom cases dicom meshing boolean)

# SPDX-License-Identifier: GPL-3.0-or-later
trephine_test(face face head phantom dicom meshing)

# SPDX-License-Identifier: GPL-3.0-or-later
trephine_test(landmarks segmentation phantom cases meshing boolean)

# SPDX-License-Identifier: GPL-3.0-or-later
trephine_test(boolean boolean phantom segmentation dicom)
# Apart from boolean: each cut starts a child, which loads what the program links.
trephine_test(cut_surface boolean voxel metrics)

# SPDX-License-Identifier: GPL-3.0-or-later
trephine_test(rectify dicom phantom segmentation meshing metrics)
target_link_libraries(rectify_test PRIVATE Eigen3::Eigen)

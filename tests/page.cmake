# SPDX-License-Identifier: GPL-3.0-or-later
trephine_test(page page cases voxel face head phantom dicom segmentation)
target_link_libraries(page_test PRIVATE nlohmann_json::nlohmann_json)

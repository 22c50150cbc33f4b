# SPDX-License-Identifier: GPL-3.0-or-later
trephine_test(segmentation segmentation)
target_link_libraries(segmentation_test PRIVATE ZLIB::ZLIB)

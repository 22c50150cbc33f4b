# SPDX-License-Identifier: GPL-3.0-or-later
trephine_test(labels segmentation)
target_link_libraries(labels_test PRIVATE ZLIB::ZLIB)

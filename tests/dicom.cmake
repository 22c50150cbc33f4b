# SPDX-License-Identifier: GPL-3.0-or-later
find_package(GDCM 3.0 REQUIRED)
trephine_test(dicom dicom phantom segmentation meshing metrics)
# The tests make compressed files with GDCM; the library only decodes with it.
target_include_directories(dicom_test SYSTEM PRIVATE ${GDCM_INCLUDE_DIRS})
target_link_libraries(dicom_test PRIVATE gdcmMSFF gdcmDSED gdcmCommon ZLIB::ZLIB Eigen3::Eigen)

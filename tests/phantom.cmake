# SPDX-License-Identifier: GPL-3.0-or-later
find_package(GDCM REQUIRED)
trephine_test(phantom phantom)
# Series are read back with GDCM itself, not with our own importer.
target_include_directories(phantom_test SYSTEM PRIVATE ${GDCM_INCLUDE_DIRS})
target_link_libraries(phantom_test PRIVATE gdcmMSFF)

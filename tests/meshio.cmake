# SPDX-License-Identifier: GPL-3.0-or-later
trephine_test(meshio meshio head)
# Readers that the library itself does not use: a third opinion.
find_package(VTK REQUIRED COMPONENTS CommonCore CommonDataModel IOGeometry IOImage IOPLY)
target_link_libraries(meshio_test PRIVATE VTK::CommonCore VTK::CommonDataModel VTK::IOGeometry VTK::IOImage VTK::IOPLY)

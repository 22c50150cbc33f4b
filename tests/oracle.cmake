# SPDX-License-Identifier: GPL-3.0-or-later
# Our own filters beside ITK's and VTK's, on random volumes.
if(TARGET trephine-itk AND TARGET trephine_mask AND TARGET trephine_meshing)
trephine_test(oracle itk mask meshing)
find_package(ITK 5.2 REQUIRED COMPONENTS ITKCommon ITKConnectedComponents ITKDistanceMap ITKSmoothing ITKImageGrid ITKTransform ITKIONRRD ITKIOMINC ITKHDF5)
find_package(VTK REQUIRED COMPONENTS CommonCore CommonDataModel FiltersCore)
target_include_directories(oracle_test SYSTEM PRIVATE ${ITK_INCLUDE_DIRS})
target_link_libraries(oracle_test PRIVATE ${ITK_LIBRARIES} VTK::CommonCore VTK::CommonDataModel VTK::FiltersCore minc2 hdf5::hdf5)
add_dependencies(oracle_test trephine-itk)
endif()

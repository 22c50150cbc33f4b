# SPDX-License-Identifier: GPL-3.0-or-later
# Our own filters beside ITK's, on random volumes.
if(TARGET trephine-itk AND TARGET trephine_mask)
trephine_test(oracle itk mask)
find_package(ITK 5.2 REQUIRED COMPONENTS ITKCommon ITKConnectedComponents ITKDistanceMap ITKSmoothing ITKImageGrid ITKTransform ITKIONRRD)
target_include_directories(oracle_test SYSTEM PRIVATE ${ITK_INCLUDE_DIRS})
target_link_libraries(oracle_test PRIVATE ${ITK_LIBRARIES})
endif()

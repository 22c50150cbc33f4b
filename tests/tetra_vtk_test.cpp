// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include "case_samples.h"
#include "tetra/tetra_mesh.h"

using namespace trephine;

// VTK's own reader finds the points, cells, regions and names of the .vtu.
TEST(TetraVtu, ReadsInVtk) {
  tetra::TetraMesh m;
  m.regions = {"skull", "brain"};
  m.points_mm = {{0.1, 0, 0}, {1, 0, 1.0 / 3}, {0, 1, 0}, {0, 0, 1}, {2, 2, 2}};
  m.tetrahedra = {{0, 1, 2, 3}, {1, 4, 2, 3}};
  m.region_of = {1, 2};
  m.borders = {{1, 2, 3}, {0, 2, 1}};
  m.between = {{1, 2}, {1, 0}};
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->ReadFromInputStringOn();
  reader->SetInputString(tetra::encode_vtu(m));
  reader->Update();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  ASSERT_EQ(5, grid->GetNumberOfPoints());
  ASSERT_EQ(4, grid->GetNumberOfCells());
  for (vtkIdType n = 0; n < 5; ++n) {
    double p[3];
    grid->GetPoint(n, p);
    EXPECT_EQ(m.points_mm[std::size_t(n)], (Vec3{p[0], p[1], p[2]}));
  }
  EXPECT_EQ(10, grid->GetCellType(1));
  EXPECT_EQ(5, grid->GetCellType(2));
  EXPECT_EQ(4, grid->GetCell(1)->GetPointId(1));
  vtkDataArray *region = grid->GetCellData()->GetArray("region"), *beyond = grid->GetCellData()->GetArray("beyond");
  ASSERT_TRUE(region && beyond);
  EXPECT_EQ(2, region->GetTuple1(1));
  EXPECT_EQ(1, region->GetTuple1(2));
  EXPECT_EQ(2, beyond->GetTuple1(2));
  vtkDataArray* brain = grid->GetFieldData()->GetArray("brain");
  ASSERT_TRUE(brain);
  EXPECT_EQ(2, brain->GetTuple1(0));
}

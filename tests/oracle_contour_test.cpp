// SPDX-License-Identifier: GPL-3.0-or-later
// Our marching cubes beside VTK's, on random volumes.
#include <gtest/gtest.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkMarchingCubes.h>
#include <vtkMassProperties.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <tuple>

#include "base/splitmix64.h"
#include "mask/filters.h"
#include "meshing/contour.h"
#include "report_of.h"
#include "surface/trimesh.h"

using namespace trephine;
using namespace trephine::mask;

namespace {

// Blobs that nowhere touch the border, so that both give closed surfaces of the same thing.
grid::Field blobs(std::uint64_t seed) {
  grid::Lattice l;
  l.size = {58, 50, 44};
  l.spacing_mm = {0.5, 0.75, 1.25};
  grid::Field g(l);
  for (std::size_t n = 0; n < g.voxels.size(); ++n)
    g.voxels[n] = static_cast<float>(unit_of_bits(splitmix64_mixed(seed * 1000003 + n * splitmix64_step)) - 0.5);
  mask::gaussian(g, 1.1);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        if (i == 0 || j == 0 || k == 0 || i + 1 == l.size[0] || j + 1 == l.size[1] || k + 1 == l.size[2])
          g.at(i, j, k) = -0.05f - 1e-3f * static_cast<float>((i + j + k) % 7);
  return g;
}

vtkSmartPointer<vtkPolyData> contour_by_vtk(const grid::Field& g, double* seconds) {
  const auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(g.size[0], g.size[1], g.size[2]);
  image->SetSpacing(g.spacing_mm.x, g.spacing_mm.y, g.spacing_mm.z);
  const auto values = vtkSmartPointer<vtkFloatArray>::New();
  values->SetNumberOfTuples(static_cast<vtkIdType>(g.voxels.size()));
  for (std::size_t n = 0; n < g.voxels.size(); ++n) values->SetValue(static_cast<vtkIdType>(n), g.voxels[n]);
  image->GetPointData()->SetScalars(values);
  const auto filter = vtkSmartPointer<vtkMarchingCubes>::New();
  filter->SetInputData(image);
  filter->SetValue(0, 0);
  filter->ComputeNormalsOff();
  const auto start = std::chrono::steady_clock::now();
  filter->Update();
  *seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return filter->GetOutput();
}

using Edge = std::tuple<int, int, int, int>;

// The edge of the lattice that a point lies on, and how far along it; axis -1 and the voxel where it lies on a voxel,
// as VTK's do where a sample is almost zero. False where it lies on neither.
bool edge_of(Vec3 p, const grid::Lattice& l, Edge& edge, double& along) {
  const Vec3 v = l.to_index(p);
  int axis = -1, at[3];
  for (int a = 0; a < 3; ++a) {
    at[a] = static_cast<int>(std::lround(v[a]));
    if (std::fabs(v[a] - at[a]) < 1e-4) continue;
    if (axis >= 0) return false;
    axis = a;
    at[a] = static_cast<int>(std::floor(v[a]));
  }
  edge = {axis, at[0], at[1], at[2]};
  along = axis < 0 ? 0 : v[axis] - at[axis];
  return true;
}

}  // namespace

TEST(Oracle, MarchingCubesAreVtks) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const grid::Field g = blobs(seed);
    meshing::ContourParams params;
    params.min_component_mm3 = 0;
    params.keep_cavities = true;
    Report report;
    const auto start = std::chrono::steady_clock::now();
    const surface::TriMesh own = value_of(report, meshing::contour(g, params));
    const double ours = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    double theirs = 0;
    const auto vtk = contour_by_vtk(g, &theirs);

    std::map<Edge, double> wanted;
    for (vtkIdType n = 0; n < vtk->GetNumberOfPoints(); ++n) {
      const double* p = vtk->GetPoint(n);
      Edge edge;
      double along = 0;
      if (edge_of({p[0], p[1], p[2]}, g, edge, along)) wanted[edge] = along;
    }
    ASSERT_GT(wanted.size(), 5000u);
    std::size_t found = 0, between = 0, on_voxels = 0, of_voxels = 0;
    for (const auto& w : wanted) of_voxels += std::get<0>(w.first) < 0;
    double worst = 0;
    for (std::size_t n = 0; n < own.points_mm.size(); ++n) {
      Edge edge;
      double along = 0;
      if (!edge_of(own.world_mm(n), g, edge, along)) {
        ++between;
        continue;
      }
      auto at = wanted.find(edge);
      if (at == wanted.end()) {
        Edge end{-1, std::get<1>(edge), std::get<2>(edge), std::get<3>(edge)};
        if (along > 0.5) {
          int* of[] = {&std::get<1>(end), &std::get<2>(end), &std::get<3>(end)};
          ++*of[std::get<0>(edge)];
        }
        ASSERT_NE(wanted.find(end), wanted.end()) << "a point where VTK has none";
        EXPECT_LT(std::min(along, 1 - along), 0.0501);
        ++on_voxels;
        continue;
      }
      worst = std::max(worst, std::fabs(at->second - along));
      ++found;
    }
    const auto mass = vtkSmartPointer<vtkMassProperties>::New();
    mass->SetInputData(vtk);
    const double volume = std::fabs(surface::volume_mm3(own));
    std::printf(
        "%zu points (VTK %zu), %zu between edges, furthest off %.4f of an edge, volume %.2f mm3 (%.2f), %.1f ms "
        "(%.1f)\n",
        own.points_mm.size(), wanted.size(), between, worst, volume, mass->GetVolume(), 1000 * ours, 1000 * theirs);
    EXPECT_EQ(found, wanted.size() - of_voxels) << "VTK has points that ours lacks";
    EXPECT_GE(on_voxels, of_voxels);
    EXPECT_LE(worst, 0.0501);
    EXPECT_LT(between, own.points_mm.size() / 100);
    EXPECT_NEAR(volume, mass->GetVolume(), 0.005 * volume) << "ambiguous cells may be joined otherwise";
  }
}

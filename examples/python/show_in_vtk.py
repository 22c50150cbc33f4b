#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""python3-vtk9: the surfaces of a case as VTK sees them, without a copy, written as one .vtp with a colour for each point.

    python3 show_in_vtk.py CASE OUT.vtp
"""
import sys

import numpy as np

try:
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkAppendPolyData
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter
except ImportError:
    sys.exit("needs VTK for Python: apt-get install python3-vtk9")

import trephine


def poly_data(surface, rgb):
    """Keep the surface as long as what this gives: VTK reads its points where they are."""
    points, cells, poly = vtkPoints(), vtkCellArray(), vtkPolyData()
    points.SetData(numpy_to_vtk(surface.points_mm))
    corners = surface.triangles.astype(np.int64)
    cells.SetData(numpy_to_vtkIdTypeArray(np.arange(0, corners.size + 1, 3), deep=True),
                  numpy_to_vtkIdTypeArray(corners.ravel(), deep=True))
    colours = numpy_to_vtk(np.tile(np.round(np.array(rgb) * 255).astype(np.uint8), (len(surface.points_mm), 1)), deep=True)
    colours.SetName("colour")
    poly.SetPoints(points)
    poly.SetPolys(cells)
    poly.GetPointData().SetScalars(colours)
    return poly


case = trephine.load_case(sys.argv[1])
together = vtkAppendPolyData()
for name, surface in case.surfaces.items():
    together.AddInputData(poly_data(surface, case.colours_rgb[name]))
writer = vtkXMLPolyDataWriter()
writer.SetFileName(sys.argv[2])
writer.SetInputConnection(together.GetOutputPort())
writer.Write()
print(f"{together.GetOutput().GetNumberOfPolys()} triangles of {len(case.surfaces)} surfaces")

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "meshio/export_mesh.h"
#include "meshio/foreign_reader.h"

namespace trephine::meshio {

struct PreparedSurface;  // meshio/export_encode.h

/// How a format's numbers hold a position. In world coordinates float32 holds 1/16384 mm up to 1,024 mm from the
/// frame's origin and less beyond; text holds every double.
enum class Precision {
  float32_world,
  float32_local,  ///< about the mesh's origin_mm
  float64_world,
};

/// Which other program reads a file back, and what its reader returns for the comparison.
struct ReadBack {
  ForeignReader reader;
  double relative = 0;  ///< of the largest coordinate: what the reader's own numbers lose
  bool colour = false;
  bool opacity = false;  ///< where it is false, a colour is of points, in bytes
  bool names = false;
};

/// A format of surfaces, declared once. --format, its help, the reference pages, the writer and the comparison of what
/// was written come from the declaration.
///
/// A format is one source, NAME_format.cpp of this folder, which holds the writer and defines `ExportFormat
/// NAME_format()`. CMake finds it; no other place names a format.
struct ExportFormat {
  const char* name = "";     ///< "stl": what --format takes, and the extension without its dot
  const char* help = "";     ///< "stl (binary)": what a list of the formats says
  bool several = false;      ///< holds several surfaces
  bool texture = false;      ///< holds texture coordinates
  bool says_space = false;   ///< says SPACE=LPS where 3D Slicer reads it
  bool metres_y_up = false;  ///< as glTF, about the mesh's origin_mm, with linear colours; else LPS, mm, sRGB
  Precision precision = Precision::float64_world;
  /// Makes the files, the main one last. Takes one surface only, unless the format holds several.
  std::vector<ExportFile> (*encode)(const std::vector<PreparedSurface>& surfaces, const std::string& stem) = nullptr;
  ReadBack read_back;
};

/// All of them, by name of their source.
const std::vector<ExportFormat>& format_types();
/// The format with that name, or null.
const ExportFormat* find_export_format(std::string_view name);
/// Throws Error 70 where there is no such format.
const ExportFormat& export_format(std::string_view name);
/// The formats for which is_so is true, as "obj, wrl and x3d", with `word` before the last.
std::string format_names(bool (*is_so)(const ExportFormat&), const std::string& word = "and");

}  // namespace trephine::meshio

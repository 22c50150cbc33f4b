// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/refusal.h"
#include "base/srgb.h"
#include "base/text.h"
#include "meshio/export_encode.h"
#include "meshio/foreign.h"
#include "surface/bounds.h"

namespace trephine::meshio {
namespace {

// Transforms glTF's metres with Y up about the origin back to mm in LPS.
void turn_back(ForeignSurface& s, Vec3 origin_mm) {
  for (Vec3& p : s.points) p = origin_mm + Vec3{1000 * p.x, -1000 * p.z, 1000 * p.y};
}

[[noreturn]] void differs(const std::string& what) { throw refusal("re-read", what, {"choose another `format`"}); }

void compare_colour(const ExportFormat& format, const ExportSurface& wanted, const ForeignSurface& got) {
  const ReadBack& check = format.read_back;
  if (check.colour) {
    if (!got.has_colour) differs("the reader found no colour");
    const double tolerance = check.opacity ? 1e-5 : 0.51 / 255;
    for (std::size_t c = 0; c < 3; ++c) {
      const double rgb = wanted.colour_rgb[c], want = format.metres_y_up ? linear_of_srgb(rgb) : rgb;
      if (!(std::abs(got.colour[c] - want) <= tolerance))
        differs("colour " + to_text(got.colour[c]) + " instead of " + to_text(want));
    }
  }
  if (check.opacity && got.has_opacity && !(std::abs(got.opacity - wanted.opacity) <= 1e-5))
    differs("opacity " + to_text(got.opacity) + " instead of " + to_text(wanted.opacity));
  if (wanted.texture_coordinates && format.texture && got.texture_points == 0)
    differs("the reader found no texture coordinates");
}

void compare_surface(const std::vector<Vec3>& world, const ExportSurface& wanted, const ForeignSurface& got,
                     double relative, ExportCheck& all) {
  const auto& triangles = wanted.mesh->triangles;
  if (got.triangles.size() != triangles.size())
    differs(grouped_text(static_cast<long long>(got.triangles.size())) + " triangles instead of " +
            grouped_text(static_cast<long long>(triangles.size())));
  double scale = 0;
  for (const Vec3 p : world) scale = std::max({scale, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  const double tolerance_mm = relative * scale;
  double largest = 0;
  // Readers keep the order of triangles and corners, so that every corner is compared, not only the box.
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3 p = got.points[got.triangles[t][c]], d = p - world[triangles[t][c]];
      largest = std::max({largest, std::abs(d.x), std::abs(d.y), std::abs(d.z)});
      surface::include(all.bounds_mm, p);
    }
  if (!(largest <= tolerance_mm))
    differs("a corner lies " + to_text(largest) + " mm off, the limit is " + to_text(tolerance_mm) + " mm");
  all.largest_difference_mm = std::max(all.largest_difference_mm, largest);
  all.triangles += triangles.size();
}

}  // namespace

ExportCheck verify_export(const ExportFormat& format, const std::vector<ExportSurface>& surfaces,
                          const std::vector<ExportFile>& files, const Progress& progress) {
  const ReadBack& check = format.read_back;
  const char* program = name_of(check.reader.program);
  const ExportFile& file = files.back();
  return with_file(file.name, [&] {
    std::vector<ForeignSurface> read;
    try {
      read = read_foreign(check.reader, file.bytes, files.size() > 1 ? std::string_view(files[0].bytes) : "",
                          foreign_limits(file.bytes.size()), progress);
    } catch (const Error& e) {
      if (e.code() == ExitCode::bad_input) differs(std::string(program) + ": " + e.what());
      throw;
    }
    if (read.size() != surfaces.size())
      differs(std::to_string(read.size()) + " surfaces instead of " + std::to_string(surfaces.size()));
    ExportCheck all;
    all.read_by = program;
    for (std::size_t i = 0; i < read.size(); ++i)
      with_field(surfaces[i].name, [&] {
        if (format.metres_y_up) turn_back(read[i], surfaces[i].mesh->origin_mm);
        if (check.names && read[i].name != surfaces[i].name) differs("it is named " + printable(read[i].name));
        compare_surface(rounded_world(*surfaces[i].mesh, format.precision), surfaces[i], read[i], check.relative, all);
        compare_colour(format, surfaces[i], read[i]);
      });
    return all;
  });
}

}  // namespace trephine::meshio

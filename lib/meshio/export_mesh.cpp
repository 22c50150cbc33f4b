// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/export_mesh.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/error.h"
#include "base/refusal.h"
#include "base/write_file.h"
#include "meshing/normals.h"
#include "meshing/validity.h"
#include "meshio/export_encode.h"

namespace trephine::meshio {
namespace {

void check_surface(const ExportSurface& s) {
  const auto refuse = [](const std::string& what) { throw Error(ExitCode::internal, "", "export", what); };
  if (!s.mesh) refuse("a surface without a mesh");
  bool good = !s.name.empty() && s.name.size() <= 64;
  for (const char c : s.name)
    good = good && ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
                    c == '-' || c == '.');
  if (!good) refuse("a surface's name must be 1 to 64 letters, digits, _, - or .");
  for (const double c : s.colour_rgb)
    if (!(c >= 0 && c <= 1)) refuse("a colour must be 0 to 1");
  if (!(s.opacity >= 0 && s.opacity <= 1)) refuse("an opacity must be 0 to 1");
}

std::vector<Vec3> normals_of(const surface::TriMesh& mesh) {
  std::vector<Vec3> normals = mesh.normals;
  if (normals.empty()) {
    surface::TriMesh copy = mesh;
    meshing::NormalsParams params;
    params.weight = meshing::NormalWeight::area;  // no arc cosine, whose last digit is the C library's
    meshing::compute_normals(copy, params);
    normals = std::move(copy.normals);
  }
  for (Vec3& n : normals) {
    n = normalized(n);
    if (!(norm(n) > 0.5)) n = {0, 0, 1};
  }
  return normals;
}

// Checks what will be written, which are the rounded coordinates. The bounds are checked first, because float32 has a
// largest value.
void check_rounded(const PreparedSurface& s, const ExportFormat& format, const Progress& progress) {
  surface::TriMesh written;
  written.points_mm = s.world_mm;
  written.triangles = s.mesh().triangles;
  for (const Vec3 p : written.points_mm)
    if (!is_finite(p))
      throw refusal("", "a point is beyond what float32 can hold", {"choose a `format` of 64 bits, such as vtp"});
  if (s.source->to_look_at) return;
  const meshing::Validity v = meshing::check_validity(written, progress);
  if (v.valid()) return;
  const auto exact = [](const ExportFormat& f) { return f.precision == Precision::float64_world; };
  throw refusal("", std::string("not a valid surface as written to ") + format.name + ": " + v.text(),
                {exact(format) ? "mend it with `repair`"
                               : "far from the origin float32 is too coarse: choose another `format`, " +
                                     format_names(exact, "or")});
}

PreparedSurface prepare(const ExportFormat& format, const ExportSurface& source, const Progress& progress) {
  check_surface(source);
  return with_field(source.name, [&] {
    surface::check_mesh(*source.mesh);
    if (source.mesh->triangles.empty())
      throw refusal("", "the surface has no triangles", {"leave it out of `anatomy`, or make it anew with `contour`"});
    PreparedSurface s;
    s.source = &source;
    s.world_mm = rounded_world(*source.mesh, format.precision);
    check_rounded(s, format, progress);
    s.normals = normals_of(*source.mesh);
    if (source.texture_coordinates && format.texture) s.texture = spherical_texture(*source.mesh);
    return s;
  });
}

}  // namespace

std::vector<Vec3> rounded_world(const surface::TriMesh& mesh, Precision precision) {
  std::vector<Vec3> world(mesh.points_mm.size());
  const auto narrow = [](double v) {
    volatile float f = float(v);  // else GCC 12 at -O3 leaves two neighbours of a vector as they were
    return double(f);
  };
  for (std::size_t i = 0; i < world.size(); ++i) {
    Vec3 p = precision == Precision::float32_local ? mesh.points_mm[i] : mesh.world_mm(i);
    if (precision != Precision::float64_world) p = {narrow(p.x), narrow(p.y), narrow(p.z)};
    if (precision == Precision::float32_local) p += mesh.origin_mm;
    world[i] = p + Vec3{0, 0, 0};  // one zero, whatever its sign was
  }
  return world;
}

PlainSurface plain_surface(const PreparedSurface& s) {
  PlainSurface p;
  if (!s.textured()) {
    p.world_mm = s.world_mm;
    p.normals = s.normals;
    p.triangles = s.mesh().triangles;
    return p;
  }
  p.triangles = s.texture.triangles;
  for (const TexturePoint& t : s.texture.points) {
    p.world_mm.push_back(s.world_mm[t.point]);
    p.normals.push_back(s.normals[t.point]);
    p.texture.push_back({t.u, t.v});
  }
  return p;
}

std::array<unsigned char, 3> colour_bytes(const std::array<double, 3>& rgb) {
  std::array<unsigned char, 3> bytes;
  for (int i = 0; i < 3; ++i) bytes[i] = static_cast<unsigned char>(std::lround(rgb[i] * 255));
  return bytes;
}

std::vector<ExportFile> encode_surfaces(const ExportFormat& format, const std::vector<ExportSurface>& surfaces,
                                        const std::string& stem, const Progress& progress) {
  if (surfaces.empty() || (surfaces.size() > 1 && !format.several))
    throw Error(ExitCode::internal, "", "export", std::string(format.name) + " holds one surface a file");
  std::vector<PreparedSurface> all;
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    all.push_back(
        prepare(format, surfaces[i], progress.part(double(i) / surfaces.size(), (double(i) + 1) / surfaces.size())));
  progress.check();
  return format.encode(all, stem);
}

void write_export(const std::filesystem::path& folder, const std::vector<ExportFile>& files) {
  std::vector<std::unique_ptr<FileWriter>> writers;
  for (const ExportFile& f : files) {
    writers.push_back(std::make_unique<FileWriter>(folder / f.name));
    writers.back()->write(f.bytes);
  }
  for (const auto& w : writers) w->commit();
}

}  // namespace trephine::meshio

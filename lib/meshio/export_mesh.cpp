// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/export_mesh.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/error.h"
#include "base/write_file.h"
#include "cases/glb.h"
#include "meshing/normals.h"
#include "meshing/validity.h"
#include "meshio/export_encode.h"
#include "meshio/vtp_encode.h"

namespace trephine {
namespace {

struct FormatFacts {
  ExportFormat format;
  const char* name;
  bool several, texture;
  Precision precision;
};

constexpr FormatFacts facts[] = {
    {ExportFormat::stl, "stl", false, false, Precision::float32_world},
    {ExportFormat::ply, "ply", false, true, Precision::float32_world},
    {ExportFormat::obj, "obj", true, true, Precision::float64_world},
    {ExportFormat::vtp, "vtp", false, true, Precision::float64_world},
    {ExportFormat::vtk, "vtk", false, true, Precision::float64_world},
    {ExportFormat::wrl, "wrl", true, true, Precision::float64_world},
    {ExportFormat::x3d, "x3d", true, true, Precision::float64_world},
    {ExportFormat::glb, "glb", false, false, Precision::float32_local},
};

const FormatFacts& facts_of(ExportFormat format) {
  for (const FormatFacts& f : facts)
    if (f.format == format) return f;
  throw Error(ExitCode::internal, "", "export", "unknown format");
}

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

std::vector<Vec3> normals_of(const TriMesh& mesh) {
  std::vector<Vec3> normals = mesh.normals;
  if (normals.empty()) {
    TriMesh copy = mesh;
    Report ignored;
    NormalsParams params;
    params.weight = NormalWeight::area;  // no arc cosine, whose last digit is the C library's
    compute_normals(copy, params, ignored);
    normals = std::move(copy.normals);
  }
  for (Vec3& n : normals) {
    n = normalized(n);
    if (!(norm(n) > 0.5)) n = {0, 0, 1};
  }
  return normals;
}

// What is checked is what is written: the rounded coordinates. Bounds first: float32 has an end.
void check_rounded(const PreparedSurface& s, ExportFormat format, const Progress& progress) {
  TriMesh written;
  written.points_mm = s.world_mm;
  written.triangles = s.mesh().triangles;
  for (const Vec3 p : written.points_mm)
    if (!is_finite(p)) throw Error(ExitCode::quality, "", "", "a point is beyond what float32 can hold");
  const Validity v = check_validity(written, progress);
  if (v.valid()) return;
  const bool narrow = precision_of(format) != Precision::float64_world;
  throw Error(ExitCode::quality, "", "",
              std::string("not a valid surface as written to ") + name_of(format) + ": " + v.text() +
                  (narrow ? " (in float32; far from the origin choose obj, vtp, vtk, wrl or x3d)" : ""));
}

PreparedSurface prepare(ExportFormat format, const ExportSurface& source, const Progress& progress) {
  check_surface(source);
  return with_field(source.name, [&] {
    check_mesh(*source.mesh);
    if (source.mesh->triangles.empty()) throw Error(ExitCode::quality, "", "", "the surface has no triangles");
    PreparedSurface s;
    s.source = &source;
    s.world_mm = rounded_world(*source.mesh, precision_of(format));
    check_rounded(s, format, progress);
    s.normals = normals_of(*source.mesh);
    if (source.texture_coordinates && holds_texture_coordinates(format)) s.texture = spherical_texture(*source.mesh);
    return s;
  });
}

std::string vtp_of(const PreparedSurface& s) {
  VtpExtras extras;
  extras.name = s.source->name;
  extras.point_rgb = colour_bytes(s.source->colour_rgb);
  TriMesh copy;
  copy.origin_mm = s.mesh().origin_mm;
  if (!s.textured()) {
    copy = s.mesh();
    copy.normals = s.normals;
  } else {
    copy.triangles = s.texture.triangles;
    for (const TexturePoint& p : s.texture.points) {
      copy.points_mm.push_back(s.mesh().points_mm[p.point]);
      copy.normals.push_back(s.normals[p.point]);
      extras.texture.push_back({p.u, p.v});
    }
  }
  return encode_vtp(copy, extras);
}

std::string glb_of(const PreparedSurface& s) {
  GlbParams params;
  params.center_mm = s.mesh().origin_mm;
  params.name = s.source->name;
  params.colour_rgb = s.source->colour_rgb;
  params.opacity = s.source->opacity;
  return make_glb(s.mesh(), params);
}

}  // namespace

const std::vector<ExportFormat>& all_export_formats() {
  static const std::vector<ExportFormat> all = [] {
    std::vector<ExportFormat> v;
    for (const FormatFacts& f : facts) v.push_back(f.format);
    return v;
  }();
  return all;
}

const char* name_of(ExportFormat format) { return facts_of(format).name; }
bool holds_several_surfaces(ExportFormat format) { return facts_of(format).several; }
bool holds_texture_coordinates(ExportFormat format) { return facts_of(format).texture; }
Precision precision_of(ExportFormat format) { return facts_of(format).precision; }

std::optional<ExportFormat> find_export_format(std::string_view name) {
  for (const FormatFacts& f : facts)
    if (name == f.name) return f.format;
  return {};
}

std::vector<Vec3> rounded_world(const TriMesh& mesh, Precision precision) {
  std::vector<Vec3> world(mesh.points_mm.size());
  const auto narrow = [](double v) { return double(float(v)); };
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

std::vector<ExportFile> encode_surfaces(ExportFormat format, const std::vector<ExportSurface>& surfaces,
                                        const std::string& stem, const Progress& progress) {
  if (surfaces.empty() || (surfaces.size() > 1 && !holds_several_surfaces(format)))
    throw Error(ExitCode::internal, "", "export", std::string(name_of(format)) + " holds one surface a file");
  std::vector<PreparedSurface> all;
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    all.push_back(
        prepare(format, surfaces[i], progress.part(double(i) / surfaces.size(), (double(i) + 1) / surfaces.size())));
  progress.check();
  const std::string name = stem + "." + name_of(format);
  switch (format) {
    case ExportFormat::stl:
      return {{name, encode_stl(all[0])}};
    case ExportFormat::ply:
      return {{name, encode_ply(all[0])}};
    case ExportFormat::obj:
      return {{stem + ".mtl", encode_mtl(all)}, {name, encode_obj(all, stem + ".mtl")}};
    case ExportFormat::vtp:
      return {{name, vtp_of(all[0])}};
    case ExportFormat::vtk:
      return {{name, encode_legacy_vtk(all[0])}};
    case ExportFormat::wrl:
      return {{name, encode_vrml(all)}};
    case ExportFormat::x3d:
      return {{name, encode_x3d(all)}};
    case ExportFormat::glb:
      return {{name, glb_of(all[0])}};
  }
  throw Error(ExitCode::internal, "", "export", "unknown format");
}

void write_export(const std::filesystem::path& folder, const std::vector<ExportFile>& files) {
  std::vector<std::unique_ptr<FileWriter>> writers;
  for (const ExportFile& f : files) {
    writers.push_back(std::make_unique<FileWriter>(folder / f.name));
    writers.back()->write(f.bytes);
  }
  for (const auto& w : writers) w->commit();
}

}  // namespace trephine

// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/sdf_model.h"

#include <cstdlib>

#include "base/error.h"
#include "base/text.h"
#include "meshing/decimate.h"
#include "meshio/export_format.h"
#include "surface/inside_query.h"
#include "surface/moments.h"

namespace trephine::meshio {
namespace {

constexpr const char* quarter_turn = "1.5707963267948966";

// One density for each surface.
std::vector<double> densities_of(const std::vector<ExportSurface>& surfaces, const SdfParams& params) {
  std::vector<double> all(surfaces.size(), params.density_kg_per_m3);
  const auto refuse = [](const std::string& item, const std::string& what) {
    throw Error(ExitCode::usage, "", "--densities", item + ": " + what);
  };
  for (std::size_t at = 0; at < params.densities.size();) {
    const std::size_t end = std::min(params.densities.find(',', at), params.densities.size());
    const std::string item = params.densities.substr(at, end - at);
    at = end + 1;
    const std::size_t equals = item.find('=');
    if (equals == std::string::npos) refuse(item, "must be NAME=NUMBER");
    const auto value = parse_number(item.substr(equals + 1));
    if (!value || !(*value > 0 && *value <= 30000)) refuse(item, "must be above 0 and at most 30000 kg/m3");
    bool any = false;
    for (std::size_t n = 0; n < surfaces.size(); ++n)
      if (surfaces[n].name == item.substr(0, equals)) {
        all[n] = *value;
        any = true;
      }
    if (!any) refuse(item, "there is no surface of that name");
  }
  return all;
}

// The smallest surface that holds most of a surface's corners; none: its own number.
std::vector<std::size_t> holders_of(const std::vector<ExportSurface>& surfaces, const std::vector<double>& volume) {
  std::vector<std::size_t> holder(surfaces.size());
  for (std::size_t n = 0; n < surfaces.size(); ++n) holder[n] = n;
  for (std::size_t outer = 0; outer < surfaces.size(); ++outer) {
    const surface::InsideQuery query(*surfaces[outer].mesh);
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
      if (n == outer || volume[n] >= volume[outer]) continue;
      const surface::TriMesh& mesh = *surfaces[n].mesh;
      std::size_t inside = 0;
      for (std::size_t p = 0; p < mesh.points_mm.size(); ++p) inside += query.inside(mesh.world_mm(p));
      if (2 * inside <= mesh.points_mm.size()) continue;
      if (holder[n] == n || volume[outer] < volume[holder[n]]) holder[n] = outer;
    }
  }
  return holder;
}

// From mm and LPS to metres, front, left and up: x is -y, y is x.
std::array<double, 6> turned(const std::array<double, 6>& i) { return {i[1], i[0], i[2], -i[3], -i[5], i[4]}; }

void weigh(const std::vector<ExportSurface>& surfaces, const SdfParams& params, SdfResult& result) {
  std::vector<surface::Moments> moments;
  std::vector<double> volume;
  for (const ExportSurface& s : surfaces) {
    moments.push_back(surface::moments_of(*s.mesh));
    volume.push_back(moments.back().volume);
    if (!(volume.back() > 0)) throw Error(ExitCode::bad_input, "", s.name, "its surface encloses nothing");
  }
  const std::vector<double> density = densities_of(surfaces, params);
  const std::vector<std::size_t> holder = holders_of(surfaces, volume);
  surface::Moments mass;  // kg/m3 times mm3
  for (std::size_t n = 0; n < surfaces.size(); ++n)
    mass.add(moments[n], holder[n] == n ? density[n] : density[n] - density[holder[n]]);
  if (!(mass.volume > 0)) throw Error(ExitCode::bad_input, "", "densities", "give no mass");
  result.mass_kg = mass.volume * 1e-9;
  const Vec3 c = mass.centre();
  result.centre_m = {-c.y / 1000, c.x / 1000, c.z / 1000};
  result.inertia_kg_m2 = turned(mass.inertia());
  for (double& i : result.inertia_kg_m2) i *= 1e-15;
}

std::string numbers(const double* v, std::size_t count) {
  std::string out;
  for (std::size_t n = 0; n < count; ++n) out += (n > 0 ? " " : "") + to_text(v[n]);
  return out;
}

std::string element(const std::string& name, const std::string& content) {
  return "<" + name + ">" + content + "</" + name + ">";
}

std::string mesh_of(const std::string& model, const std::string& file) {
  return "<pose relative_to=\"ct_lps\">0 0 0 0 0 0</pose>\n<geometry><mesh>" +
         element("uri", "model://" + model + "/" + file) + element("scale", "0.001 0.001 0.001") +
         "</mesh></geometry>\n";
}

std::string model_text(const std::vector<ExportSurface>& surfaces, const std::string& name, const SdfResult& r) {
  const auto& i = r.inertia_kg_m2;
  std::string out =
      "<?xml version=\"1.0\"?>\n<!-- trephine. Metres; x to the front, y to the left, z upwards; the origin is that of "
      "the CT's "
      "patient coordinates.\n     A place (x, y, z) of DICOM's LPS in mm is (-y, x, z) / 1000 here. -->\n"
      "<sdf version=\"1.7\">\n<model name=\"" +
      name + "\">\n<frame name=\"ct_lps\"><pose>0 0 0 0 0 " + quarter_turn +
      "</pose></frame>\n<link name=\"patient\">\n<inertial>\n" +
      element("pose", numbers(r.centre_m.data(), 3) + " 0 0 0") + element("mass", to_text(r.mass_kg)) + "\n<inertia>" +
      element("ixx", to_text(i[0])) + element("iyy", to_text(i[1])) + element("izz", to_text(i[2])) +
      element("ixy", to_text(i[3])) + element("ixz", to_text(i[4])) + element("iyz", to_text(i[5])) +
      "</inertia>\n</inertial>\n";
  for (const ExportSurface& s : surfaces) {
    const std::string rgba = numbers(s.colour_rgb.data(), 3) + " 1";
    out += "<visual name=\"" + s.name + "\">\n" + mesh_of(name, s.name + ".obj") + "<material>" +
           element("ambient", rgba) + element("diffuse", rgba) + "</material>\n" +
           element("transparency", to_text(1 - s.opacity)) + "\n</visual>\n";
    out += "<collision name=\"" + s.name + "\">\n" + mesh_of(name, s.name + "_collision.obj") + "</collision>\n";
  }
  return out + "</link>\n</model>\n</sdf>\n";
}

}  // namespace

Outcome<std::vector<ExportFile>, SdfResult> sdf_model(const std::vector<ExportSurface>& surfaces,
                                                      const std::string& name, const SdfParams& params,
                                                      const Progress& progress) {
  Outcome<std::vector<ExportFile>, SdfResult> out;
  weigh(surfaces, params, out.result);
  const ExportFormat& obj = export_format("obj");
  const auto add = [&](const ExportSurface& of, const std::string& stem, const Progress& here) {
    std::vector<ExportFile> files = encode_surfaces(obj, {of}, stem, here.part(0, 0.5));
    verify_export(obj, {of}, files, here.part(0.5, 1));
    for (ExportFile& f : files) out.value.push_back(std::move(f));
  };
  meshing::DecimateParams coarse;
  coarse.max_deviation_mm = params.collision_mm;
  for (std::size_t n = 0; n < surfaces.size(); ++n) {
    const Progress here = progress.part(double(n) / double(surfaces.size()), double(n + 1) / double(surfaces.size()));
    const ExportSurface& s = surfaces[n];
    add(s, s.name, here.part(0, 0.2));
    const auto collision = with_field(s.name, [&] { return meshing::decimate(*s.mesh, coarse, here.part(0.2, 0.9)); });
    const ExportSurface simpler{&collision.value, s.name, s.colour_rgb, 1, false};
    add(simpler, s.name + "_collision", here.part(0.9, 1));
    out.result.collisions.emplace_back(
        s.name, SdfCollision{collision.value.triangles.size(), collision.result.deviation_max_mm});
  }
  out.value.push_back({"model.config", "<?xml version=\"1.0\"?>\n<model>\n" + element("name", name) + "\n" +
                                           element("version", "1.0") + "\n<sdf version=\"1.7\">model.sdf</sdf>\n" +
                                           "<author><name>trephine</name></author>\n" +
                                           element("description", "A patient made of a CT.") + "\n</model>\n"});
  out.value.push_back({"model.sdf", model_text(surfaces, name, out.result)});
  return out;
}

}  // namespace trephine::meshio

// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/truth.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/write_file.h"
#include "grid/nrrd.h"
#include "meshio/vtp.h"
#include "phantom/truth_json.h"

namespace trephine::phantom {
namespace {

using Json = nlohmann::ordered_json;
constexpr int truth_version = 1;

Json to_json(Vec3 v) { return Json::array({v.x, v.y, v.z}); }
Json to_json(const ParameterValue& value) {
  return std::visit([](const auto& v) { return Json(v); }, value);
}
Json to_json(const ImplantTruth& t) {
  Json out = {{"side", t.on_left ? "left" : "right"},
              {"hole_mm", to_json(t.hole_mm)},
              {"hole_out", to_json(t.hole_out)},
              {"hole_diameter_mm", t.hole_diameter_mm}};
  if (!t.has_catheter) return out;
  out["catheter_diameter_mm"] = t.catheter_diameter_mm;
  out["tip_mm"] = to_json(t.tip_mm);
  out["course_mm"] = Json::array();
  for (const Vec3& p : t.course_mm) out["course_mm"].push_back(to_json(p));
  return out;
}
template <class P>
Json params_to_json(const P& params) {
  Json out = Json::object();
  for (const Parameter& p : parameters_of<P>().parameters) out[p.name] = to_json(p.get(&params));
  return out;
}

/// Fills one block of labels: all alike where no boundary is near its middle, else by octants.
template <class Label>
void label_block(const Head& head, const Label& label_at, grid::Mask& mask, std::array<int, 3> from,
                 std::array<int, 3> size) {
  const Vec3 middle =
      mask.to_world_mm({from[0] + 0.5 * (size[0] - 1), from[1] + 0.5 * (size[1] - 1), from[2] + 0.5 * (size[2] - 1)});
  double radius = 0;
  for (int a = 0; a < 3; ++a) radius += std::pow(0.5 * (size[a] - 1) * mask.spacing_mm[a], 2);
  if (size == std::array<int, 3>{1, 1, 1} || head.label_clearance_mm(middle) > std::sqrt(radius)) {
    const std::uint8_t label = label_at(middle);
    for (int k = from[2]; k < from[2] + size[2]; ++k)
      for (int j = from[1]; j < from[1] + size[1]; ++j)
        std::fill_n(mask.voxels.begin() + static_cast<std::ptrdiff_t>(mask.index(from[0], j, k)), size[0], label);
    return;
  }
  std::array<int, 3> half;
  for (int a = 0; a < 3; ++a) half[a] = (size[a] + 1) / 2;
  for (int octant = 0; octant < 8; ++octant) {
    std::array<int, 3> f, s;
    for (int a = 0; a < 3; ++a) {
      const bool upper = octant >> a & 1;
      f[a] = from[a] + (upper ? half[a] : 0);
      s[a] = upper ? size[a] - half[a] : half[a];
    }
    if (s[0] > 0 && s[1] > 0 && s[2] > 0) label_block(head, label_at, mask, f, s);
  }
}

double number_at(const Json& j, const std::string& field) {
  if (!j.is_number()) throw Error(ExitCode::bad_input, "", field, "must be a number");
  return j.get<double>();
}
Vec3 vector_at(const Json& j, const std::string& field) {
  if (!j.is_array() || j.size() != 3) throw Error(ExitCode::bad_input, "", field, "must be three numbers");
  return {number_at(j[0], field), number_at(j[1], field), number_at(j[2], field)};
}
const Json& member(const Json& j, const std::string& name) {
  if (!j.is_object() || !j.contains(name)) throw Error(ExitCode::bad_input, "", name, "is missing: no phantom's truth");
  return j[name];
}

template <class P>
P params_from_json(const Json& j) {
  P params;
  for (const Parameter& p : parameters_of<P>().parameters) {
    if (p.came_later && j.is_object() && !j.contains(p.name)) continue;  // of an older program
    const Json& v = member(j, p.name);
    ParameterValue value;
    const auto text_of = [](const Json& j) { return j.is_string() ? j.get<std::string>() : j.dump(); };
    std::vector<std::string> items;
    if (v.is_array())
      for (const Json& item : v) items.push_back(text_of(item));
    else
      items.push_back(text_of(v));
    const std::string fault = parse_parameter(p, items, value);
    if (!fault.empty()) throw Error(ExitCode::bad_input, "", p.name, v.dump() + ": " + fault);
    p.set(&params, value);
  }
  return params;
}

}  // namespace

namespace {
template <class Label>
grid::Mask labelled(const Head& head, const grid::Lattice& lattice, const Label& label_at, const Progress& progress) {
  grid::Mask mask(lattice);
  constexpr int block = 16;
  const int layers = (lattice.size[2] + block - 1) / block;
  parallel_for(0, layers, 1, [&](std::int64_t from, std::int64_t to) {
    for (int layer = static_cast<int>(from); layer < to; ++layer)
      for (int j = 0; j < lattice.size[1]; j += block) {
        progress.check();
        for (int i = 0; i < lattice.size[0]; i += block) {
          const int k = layer * block;
          label_block(head, label_at, mask, {i, j, k},
                      {std::min(block, lattice.size[0] - i), std::min(block, lattice.size[1] - j),
                       std::min(block, lattice.size[2] - k)});
        }
      }
  });
  return mask;
}
}  // namespace

grid::Mask truth_labels(const Head& head, const grid::Lattice& lattice, const Progress& progress) {
  return labelled(
      head, lattice, [&](Vec3 p) { return head.label(p); }, progress);
}

grid::Mask truth_things(const Head& head, const grid::Lattice& lattice, const Progress& progress) {
  return labelled(
      head, lattice, [&](Vec3 p) { return static_cast<std::uint8_t>(head.thing(p)); }, progress);
}

Named<double> write_truth(const std::filesystem::path& folder, const Head& head, const Scan& scan,
                          const ScanParams& scan_params, const TruthParams& params, const Progress& progress) {
  Named<double> volumes;
  make_output_folder(folder);
  const ScannedRegion region = scanned_region(scan_params);
  const surface::Bounds& box = region.box_mm;
  Json json;
  json["trephine_phantom_truth"] = truth_version;
  json["frame"] = "DICOM patient LPS, mm; signed distances are negative inside";
  json["head"] = params_to_json(head.params());
  const bool hard = head.params().level == Level::hard;
  if (hard) json["hard"] = params_to_json(head.params().hard);
  if (!head.implants().empty()) {
    json["implants"] = params_to_json(head.params().implants);
    json["put_in"] = Json::array();
    for (const ImplantTruth& t : head.implants()) json["put_in"].push_back(to_json(t));
  }
  if (has_pose(scan_params)) json["head_to_scan"] = json_of(head_pose(scan_params));
  json["scan"] = params_to_json(scan_params);
  json["box_mm"] = Json::array({to_json(box.min_mm), to_json(box.max_mm)});
  if (has_lattice(scan_params)) {
    const grid::Lattice l = lattice_of(scan);
    json["lattice"] = {
        {"size", l.size},
        {"spacing_mm", to_json(l.spacing_mm)},
        {"origin_mm", to_json(l.origin_mm)},
        {"direction_columns",
         {to_json(l.direction.column[0]), to_json(l.direction.column[1]), to_json(l.direction.column[2])}}};
  }
  for (const auto& l : head.landmarks()) json["landmarks_mm"][l.first] = to_json(l.second);
  if (hard) {
    json["things_mm"] = Json::array();
    for (const auto& t : head.things_mm())
      json["things_mm"].push_back({{"thing", t.first}, {"position_mm", to_json(t.second)}});
  }
  json["fiducials"] = Json::array();
  if (scan_params.contents != Contents::head)
    for (const Fiducial& f : fiducials_of(scan_params))
      json["fiducials"].push_back(
          {{"centre_mm", to_json(f.centre_mm)}, {"sigma_mm", f.sigma_mm}, {"height_hu", f.height_hu}});

  if (scan_params.contents != Contents::fiducials) {
    double done = 0;
    for (const Anatomy a : all_anatomies) {
      const surface::TriMesh mesh = truth_mesh(head, a, region, params.mesh_step_mm > 0 ? params.mesh_step_mm : 2.0,
                                               progress.part(done, done + 0.2));
      const double volume = surface::volume_mm3(mesh) / 1000;
      json["volumes_in_box_ml"][name_of(a)] = volume;
      volumes.emplace_back(name_of(a), volume);
      if (params.mesh_step_mm > 0 && !mesh.triangles.empty())
        meshio::write_vtp(folder / (std::string(name_of(a)) + ".vtp"), mesh);
      progress.report(done += 0.2);
    }
    if (params.labels && has_lattice(scan_params))
      grid::write_nrrd(folder / "labels.nrrd",
                       truth_labels(head, lattice_of(scan), progress.part(0.8, hard ? 0.9 : 1)));
    if (hard && params.labels && has_lattice(scan_params))
      grid::write_nrrd(folder / "things.nrrd", truth_things(head, lattice_of(scan), progress.part(0.9, 1)));
  }
  write_file(folder / "truth.json", json.dump(1) + "\n");
  return volumes;
}

Truth read_truth(const std::filesystem::path& file) {
  const std::vector<char> bytes = read_file(file, 1 << 24);
  try {
    const Json json = Json::parse(bytes.begin(), bytes.end(), nullptr, false);
    if (json.is_discarded()) throw Error(ExitCode::bad_input, "", "", "is no JSON");
    const double version = number_at(member(json, "trephine_phantom_truth"), "trephine_phantom_truth");
    if (version != truth_version)
      throw Error(ExitCode::bad_input, "", "trephine_phantom_truth",
                  to_text(version) + ", this program reads version 1");
    HeadParams of_head = params_from_json<HeadParams>(member(json, "head"));
    if (of_head.level == Level::hard) of_head.hard = params_from_json<HardParams>(member(json, "hard"));
    if (of_head.level == Level::hard && json.contains("implants"))
      of_head.implants = params_from_json<ImplantParams>(json["implants"]);
    Truth truth{Head(of_head), {}, {}};
    const Json& box = member(json, "box_mm");
    if (!box.is_array() || box.size() != 2) throw Error(ExitCode::bad_input, "", "box_mm", "must be two corners");
    truth.scanned = scanned_region(params_from_json<ScanParams>(member(json, "scan")));
    truth.scanned.box_mm = {vector_at(box[0], "box_mm"), vector_at(box[1], "box_mm")};
    const Json& fiducials = member(json, "fiducials");
    for (const Json& f : fiducials)
      truth.fiducials.push_back({vector_at(member(f, "centre_mm"), "centre_mm"),
                                 number_at(member(f, "sigma_mm"), "sigma_mm"),
                                 number_at(member(f, "height_hu"), "height_hu")});
    return truth;
  } catch (Error& e) {
    e.in_file(file.string());
    throw;
  }
}

}  // namespace trephine::phantom

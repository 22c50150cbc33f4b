// SPDX-License-Identifier: GPL-3.0-or-later
#include "page/case_page.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "base/base64.h"
#include "base/parallel.h"
#include "page/html.h"
#include "page/pack.h"
#include "page/web_files.h"
#include "voxel/transfer.h"

namespace trephine::page {
namespace {

using Json = nlohmann::ordered_json;
constexpr int page_version = 2;
constexpr double page_overhead_bytes = 100e3;  // script, style and the JSON of figures

Json to_list(Vec3 v) { return Json::array({v.x, v.y, v.z}); }

Json to_list(const std::vector<voxel::TransferPoint>& points) {
  Json out = Json::array();
  for (const voxel::TransferPoint& p : points)
    out.push_back({p.hu, p.opacity, p.colour_rgb[0], p.colour_rgb[1], p.colour_rgb[2]});
  return out;
}

// How a shape of encoding `hu` is seen (voxel/transfer.h).
Json seen_by(const cases::CaseShape& shape) {
  return to_list(shape.transfer
                     ? voxel::resolved(*shape.transfer).points
                     : voxel::window_function(shape.window_low, shape.window_high, shape.material.colour_rgb).points);
}

Json to_json(const cases::CaseValues& values) {
  Json out = Json::object();
  for (const auto& [name, value] : values) out[name] = std::visit([](const auto& v) { return Json(v); }, value);
  return out;
}

// The page's data: JSON, and a block for what is large.
class PageMaker {
 public:
  PageMaker(const cases::LoadedCase& loaded, const PageNotes& notes, const PageParams& params, const Progress& progress)
      : case_(loaded), manifest_(loaded.manifest), notes_(notes), params_(params), progress_(progress) {}

  std::string make() {
    json_["page"] = page_version;
    json_["case"] = manifest_.case_token;
    add_anatomies();
    add_volumes();
    add_marks();
    add_text();
    for (const PageBlock& b : blocks_) json_["blocks"][b.id] = b.bytes;
    return html_page(web::template_html, web::style_css, web::viewer_js, json_.dump(), blocks_);
  }

 private:
  const cases::CaseShape* felt_shape(const std::string& name) const {
    for (const cases::CaseShape& shape : manifest_.haptic.shapes)
      if (shape.name == name && shape.displayed == "haptic" && case_.has_haptic()) return &shape;
    return nullptr;
  }

  PackedSurface packed(std::size_t anatomy) const {
    const cases::CaseAnatomy& a = manifest_.anatomies[anatomy];
    if (case_.surfaces[anatomy].triangles.empty()) {
      const cases::CaseShape* shape = felt_shape(a.name);
      return shape ? pack_surface(felt_surface_for_page(case_.haptic, shape->number)) : PackedSurface();
    }
    const auto deviation = notes_.deviation_mm.find(a.name);
    return pack_surface(case_.surfaces[anatomy],
                        deviation == notes_.deviation_mm.end() ? std::vector<float>() : deviation->second);
  }

  void add_anatomies() {
    std::vector<PackedSurface> surfaces(manifest_.anatomies.size());
    parallel_for(0, static_cast<std::int64_t>(surfaces.size()), 1, [&](std::int64_t from, std::int64_t) {
      progress_.check();
      surfaces[static_cast<std::size_t>(from)] = packed(static_cast<std::size_t>(from));
    });
    json_["anatomies"] = Json::array();
    for (std::size_t i = 0; i < surfaces.size(); ++i) add_anatomy(manifest_.anatomies[i], surfaces[i]);
  }

  void add_anatomy(const cases::CaseAnatomy& a, PackedSurface& surface) {
    Json out;
    out["name"] = a.name;
    out["from"] = !a.file.empty() ? "surface" : surface.triangles > 0 ? "haptic" : "none";
    out["colour_rgb"] = a.colour_rgb;
    out["opacity"] = a.opacity;
    out["case_triangles"] = a.triangles;
    out["volume_ml"] = a.volume_ml;
    if (!a.file.empty()) {
      out["area_cm2"] = a.area_cm2;
      out["deviation_mm"] = {{"max", a.deviation.max_mm}, {"p99", a.deviation.p99_mm}, {"rms", a.deviation.rms_mm}};
      out["budget_mm"] = {{"asked", a.budget_asked_mm}, {"used", a.budget_used_mm}};
    }
    if (surface.triangles > 0) {
      out["points"] = surface.points;
      out["triangles"] = surface.triangles;
      out["min_mm"] = to_list(surface.min_mm);
      out["size_mm"] = to_list(surface.size_mm);
      if (surface.has_deviation) {
        out["deviation_scale_mm"] = surface.deviation_scale_mm;
        out["deviation_p99_mm"] = surface.deviation_p99_mm;
      }
      const std::string id = "surface-" + std::to_string(json_["anatomies"].size());
      out["block"] = id;
      blocks_.push_back(page_block(id, surface.bytes));
    }
    json_["anatomies"].push_back(std::move(out));
  }

  void add_volume(PageBlock block, const grid::Lattice& lattice) {
    json_[block.id] = {{"block", block.id},
                       {"size", lattice.size},
                       {"spacing_mm", to_list(lattice.spacing_mm)},
                       {"origin_mm", to_list(lattice.origin_mm)}};
    blocks_.push_back(std::move(block));
  }

  // On voxels as large as the page's size wants it: a part of a CT compresses about as well as the whole.
  void add_ct(const grid::Grid<std::int16_t>& volume) {
    double room = params_.max_mb * 1e6 - page_overhead_bytes;
    for (const PageBlock& b : blocks_) room -= double(b.bytes_in_page());
    int side = page_volume_side;
    for (;;) {
      const PackedVolume packed = pack_ct(volume, side, progress_);
      PageBlock block = page_block("ct", predicted_bytes(packed), true);
      const int longest = *std::max_element(packed.lattice.size.begin(), packed.lattice.size.end());
      const double share = room / double(block.bytes_in_page());
      if (share >= 1 || longest <= page_volume_side / 2) {
        add_volume(std::move(block), packed.lattice);
        break;
      }
      const int smaller = int(longest * std::sqrt(std::max(share, 0.0))) / 4 * 4;
      side = std::clamp(smaller, page_volume_side / 2, std::max(longest - 4, page_volume_side / 2));
    }
    json_["ct"]["predicted"] = true;
    json_["ct"]["of_spacing_mm"] = to_list(volume.spacing_mm);
    json_["ct"]["levels"] = page_hu_levels;
    for (const std::string& name : voxel::preset_names())
      json_["transfers"][name] = to_list(voxel::preset_points(name));
  }

  void add_volumes() {
    progress_.check();
    if (case_.has_haptic()) {
      const PackedShapes felt = pack_shapes(case_.haptic, progress_);
      add_volume(page_block("felt", felt.numbers.bytes), felt.numbers.lattice);
      if (!felt.shares.empty()) {
        blocks_.push_back(page_block("felt_shares", felt.shares));
        json_["felt"]["shares"] = "felt_shares";
      }
    }
    const bool felt_hu = case_.has_haptic() && case_.haptic.encoding == voxel::HapticEncoding::hu;
    if (case_.has_ct()) {
      add_ct(case_.ct);
      json_["ct"]["from"] = "ct";
    } else if (felt_hu) {
      add_ct(case_.haptic.voxels);
      json_["ct"]["from"] = "haptic";
    }
    if (!case_.has_haptic()) return;
    for (const cases::CaseShape& s : manifest_.haptic.shapes) {
      Json shape = {{"name", s.name},
                    {"number", s.number},
                    {"colour_rgb", s.material.colour_rgb},
                    {"material", s.material.name},
                    {"volume_ml", s.volume_ml}};
      if (felt_hu) shape["transfer"] = seen_by(s);
      json_["felt"]["shapes"].push_back(std::move(shape));
    }
  }

  void add_marks() {
    json_["landmarks"] = json_["targets"] = json_["burr_holes"] = Json::array();
    for (const cases::CaseLandmark& l : manifest_.landmarks)
      json_["landmarks"].push_back({{"name", l.name},
                                    {"position_mm", to_list(l.position_mm)},
                                    {"confidence", l.confidence},
                                    {"source", l.source}});
    for (const cases::CaseTarget& t : manifest_.targets)
      json_["targets"].push_back({{"name", t.name},
                                  {"position_mm", to_list(t.position_mm)},
                                  {"confidence", t.confidence},
                                  {"anatomy", t.anatomy}});
    for (const cases::CaseBurrHole& b : manifest_.burr_holes)
      json_["burr_holes"].push_back({{"name", b.name},
                                     {"position_mm", to_list(b.position_mm)},
                                     {"direction", to_list(b.direction)},
                                     {"diameter_mm", b.diameter_mm},
                                     {"cut", b.cut},
                                     {"figures", to_json(b.figures)}});
  }

  void add_text() {
    json_["figures"] = to_json(manifest_.figures);
    json_["face"] = {{"policy", manifest_.face_policy}, {"reason", manifest_.face_reason}};
    json_["provenance"] = {{"program", manifest_.program_version},
                           {"input_sha256", manifest_.input_sha256},
                           {"parameters", to_json(manifest_.parameters)}};
    const Json notes = Json::parse(page_notes_json(notes_));
    json_["warnings"] = notes["warnings"];
    json_["severities"] = notes["severities"];
    if (notes.contains("trade")) json_["trade"] = notes["trade"];
  }

  const cases::LoadedCase& case_;
  const cases::CaseManifest& manifest_;
  const PageNotes& notes_;
  const PageParams& params_;
  const Progress& progress_;
  Json json_;
  std::vector<PageBlock> blocks_;
};

}  // namespace

std::string make_case_page(const cases::LoadedCase& loaded, const PageNotes& notes, const PageParams& params,
                           const Progress& progress) {
  return PageMaker(loaded, notes, params, progress).make();
}

std::string make_case_page(const std::filesystem::path& case_folder, const PageParams& params,
                           const Progress& progress) {
  const cases::LoadedCase loaded = cases::load_case(case_folder, cases::LoadParts{true});
  return make_case_page(loaded, read_page_notes(case_folder, loaded.manifest), params, progress);
}

std::string case_page_policy() {
  return "default-src 'none'; script-src '" + policy_hash(web::viewer_js) + "'; style-src '" +
         policy_hash(web::style_css) + "'; base-uri 'none'; form-action 'none'";
}

}  // namespace trephine::page

// SPDX-License-Identifier: GPL-3.0-or-later
// Lists what import would say of each series, without decoding pixels.
#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/text_table.h"
#include "dicom/catalogue.h"
#include "dicom/import.h"
#include "dicom/input_files.h"
#include "dicom/volume_import.h"
#include "itk/volume_file.h"

namespace trephine::dicom {
namespace {

SeriesSummary summary_of(const Series& series) {
  SeriesSummary s = series.summary;
  if (!series.slices.empty()) {
    const std::string& position = series.slices.front().header->patient_position;
    s.orientation = plane_of(series.stack) + (position.empty() ? "" : " " + position);
    try {  // what there is to measure, also of what is refused
      const StackGeometry g =
          analyse_stack(series.stack, GapPolicy::interpolate, std::numeric_limits<double>::infinity());
      s.tilt_deg = g.tilt_deg;
      s.smallest_step_mm = g.smallest_step_mm;
      s.largest_gap_mm = g.largest_step_mm;
      s.missing_slices = g.missing_steps;
      s.duplicates = static_cast<int>(series.slices.size() - g.levels.size());
    } catch (const Error&) {
    }
  }
  if (!s.usable)
    s.verdict = "refused: " + s.verdict;
  else if (!series.rectified_for.empty())
    s.verdict = "usable, rectified: " + (s.rectified_for = series.rectified_for);
  if (s.usable && !series.part_of.empty())
    s.verdict += ", but scans only a part of " + series.part_of + " again: taken where its token is given";
  return s;
}

}  // namespace

SeriesList list_series(const std::filesystem::path& folder_or_file, const ImportParams& params,
                       const Progress& progress) {
  if (auto volumes = volume_sources(folder_or_file, progress.part(0, 0.1)); !volumes.empty())
    return list_volumes(folder_or_file, std::move(volumes), params, progress);
  return with_scan(folder_or_file, [&] {
    Catalogue catalogue = scan(folder_or_file, params.modality, progress.part(0, 0.5));
    if (catalogue.series.empty()) choose(catalogue, {});  // says what there is instead
    SeriesList list;
    const double share = 0.5 / static_cast<double>(catalogue.series.size());
    for (std::size_t i = 0; i < catalogue.series.size(); ++i) {
      const double at = 0.5 + share * static_cast<double>(i);
      judge(catalogue.series[i], params, progress.part(at, at + share));
    }
    const Series* best = proposed(catalogue);
    for (const Series& s : catalogue.series) {
      list.series.push_back(summary_of(s));
      list.series.back().proposed = &s == best;
    }
    list.folder = describe_rest(catalogue, nullptr);
    if (const int others = best ? of_other_patients(catalogue, *best) : 0)
      list.folder.result.series_of_other_patients_count = others;
    return list;
  });
}

std::string list_text(const SeriesList& list) {
  std::vector<std::vector<std::string>> rows = {{"series", "proposed", "modality", "orientation", "image", "slices",
                                                 "spacing mm", "thickness", "kernel", "contrast", "tilt", "steps mm",
                                                 "transfer syntax", "verdict"}};
  for (const SeriesSummary& s : list.series) {
    std::string steps = fmt::format("{:.4g}", s.smallest_step_mm);
    if (s.largest_gap_mm - s.smallest_step_mm > 1e-3) steps += fmt::format(" to {:.4g}", s.largest_gap_mm);
    if (s.missing_slices > 0) steps += fmt::format(", {} gaps", s.missing_slices);
    if (s.duplicates > 0) steps += fmt::format(", {} double", s.duplicates);
    const auto or_dash = [](const std::string& t) { return t.empty() ? std::string("-") : t; };
    const bool measured = s.largest_gap_mm > 0;
    rows.push_back({s.token, s.proposed ? "yes" : "-", s.modality, or_dash(s.orientation), or_dash(origin_of(s)),
                    std::to_string(s.size[2]),
                    s.spacing_mm.x > 0
                        ? fmt::format("{:.4g} x {:.4g} x {:.4g}", s.spacing_mm.x, s.spacing_mm.y, s.spacing_mm.z)
                        : "-",
                    s.slice_thickness_mm > 0 ? fmt::format("{:.4g}", s.slice_thickness_mm) : "-", or_dash(s.kernel),
                    s.contrast_text(), measured ? fmt::format("{:.1f}", s.tilt_deg + 0.0) : "-", measured ? steps : "-",
                    s.transfer_syntax, s.verdict});
  }
  std::string out = text_table(rows, "l") + "\n";
  for (const SeriesSummary& s : list.series)
    for (const auto& [name, value] : s.seen.figures)
      out += fmt::format("{}: {}: {}\n", s.token, name, trephine::to_text(value));
  for (const auto& [name, value] : figures_of(list.folder.result))
    out += fmt::format("{}: {}\n", name, trephine::to_text(value));
  return out;
}

std::string list_json(const SeriesList& list) {
  using nlohmann::ordered_json;
  ordered_json all;
  all["trephine_series_list"] = 1;
  all["series"] = ordered_json::array();
  for (const SeriesSummary& s : list.series) {
    ordered_json j;
    j["token"] = s.token;
    j["modality"] = s.modality;
    j["size"] = s.size;
    j["spacing_mm"] = {s.spacing_mm.x, s.spacing_mm.y, s.spacing_mm.z};
    j["slice_thickness_mm"] = s.slice_thickness_mm;
    j["kernel"] = s.kernel;
    j["image_type"] = s.image_type;
    j["contrast"] = s.contrast.empty() ? ordered_json() : ordered_json(s.contrast == "yes");  // null: not told
    j["tilt_deg"] = s.tilt_deg;
    j["smallest_step_mm"] = s.smallest_step_mm;
    j["largest_gap_mm"] = s.largest_gap_mm;
    j["missing_slices_count"] = s.missing_slices;
    j["duplicates_count"] = s.duplicates;
    j["transfer_syntax"] = s.transfer_syntax;
    j["orientation"] = s.orientation;
    j["usable"] = s.usable;
    j["proposed"] = s.proposed;
    j["rectified_for"] = s.rectified_for;
    j["verdict"] = s.verdict;
    for (const auto& [name, value] : s.seen.figures) j["seen"][name] = trephine::to_text(value);
    for (const std::string& w : s.seen.warnings) j["seen"]["warnings"].push_back(w);
    all["series"].push_back(j);
  }
  ordered_json& rest = all["folder"] = ordered_json::object();
  for (const auto& [name, value] : figures_of(list.folder.result))
    if (const auto* count = std::get_if<std::int64_t>(&value)) rest[name] = *count;
  return all.dump(2) + "\n";
}

std::string SeriesSummary::line() const {
  std::string out =
      fmt::format("{}: {}, {:.4g} x {:.4g} x {:.4g} mm", token, modality, spacing_mm.x, spacing_mm.y, spacing_mm.z);
  if (!kernel.empty()) out += ", kernel " + kernel;
  if (slice_thickness_mm > 0) out += fmt::format(", slice thickness {:.4g} mm", slice_thickness_mm);
  if (!image_type.empty()) out += ", " + image_type;
  out += contrast == "yes" ? ", contrast" : contrast == "no" ? ", no contrast" : ", contrast not told";
  return out;
}

const char* SeriesSummary::contrast_text() const { return contrast.empty() ? "not told" : contrast.c_str(); }

}  // namespace trephine::dicom

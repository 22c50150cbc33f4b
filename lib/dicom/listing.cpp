// SPDX-License-Identifier: GPL-3.0-or-later
// Lists what import would say of each series, without decoding pixels.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text_table.h"
#include "dicom/catalogue.h"
#include "dicom/hu.h"
#include "dicom/import.h"
#include "dicom/input_files.h"
#include "dicom/mixtures.h"
#include "dicom/volume_import.h"
#include "itk/volume_file.h"

namespace trephine::dicom {
namespace {

std::string plane_of(const SliceStack& stack) {
  const Vec3 n = stack.normal();
  const double aligned = std::cos(30 * M_PI / 180);
  if (std::abs(n.z) > aligned) return "axial";
  if (std::abs(n.y) > aligned) return "coronal";
  if (std::abs(n.x) > aligned) return "sagittal";
  return "oblique";
}

bool is_native(const FrameRef& r) { return r.header->syntax->encoding == Encoding::native; }

/// Throws the error that import would throw for slices at one position whose pixels differ. Compressed slices are not
/// compared here.
void check_duplicates(const Series& series, const StackGeometry& geometry, const ImportParams& params) {
  const std::size_t pixels = std::size_t(series.stack.columns) * std::size_t(series.stack.rows);
  HuMapper<float> mapper;
  HuCounts ignored;
  for (const auto& level : geometry.levels) {
    if (level.size() < 2) continue;
    std::vector<FrameRef> frames;
    for (const int i : level) frames.push_back(series.slices[static_cast<std::size_t>(i)]);
    if (!std::all_of(frames.begin(), frames.end(), is_native)) continue;
    std::vector<float> first(pixels), other(pixels);
    read_frames(frames, [&](std::size_t i, const std::uint8_t* stored) {
      const FileHeader& h = *frames[i].header;
      mapper.apply(
          hu_rule(h, h.frames[static_cast<std::size_t>(frames[i].frame)], params.clamp_low_hu, params.clamp_high_hu),
          stored, pixels, i == 0 ? first.data() : other.data(), ignored);
      if (i > 0 && first != other) different_duplicates(h);
    });
  }
}

void check_streams(const Series& series, const Progress& progress) {
  const auto count = static_cast<std::int64_t>(series.slices.size());
  std::vector<std::exception_ptr> errors(series.slices.size());
  parallel_for(0, count, 8, [&](std::int64_t from, std::int64_t to) {
    progress.report(static_cast<double>(from) / static_cast<double>(count));
    for (auto i = static_cast<std::size_t>(from); i < static_cast<std::size_t>(to); ++i) try {
        if (!is_native(series.slices[i])) check_frame_stream(series.slices[i]);
      } catch (...) {
        errors[i] = std::current_exception();
      }
  });
  for (const auto& e : errors)  // the first in the stack's order, as import tells it
    if (e) std::rethrow_exception(e);
}

SeriesSummary summary_of(const Series& series, const ImportParams& params, const Progress& progress) {
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
  if (!s.usable) {
    s.verdict = "refused: " + s.verdict;
    return s;
  }
  try {
    const StackGeometry g = analyse_series(series, params);
    check_streams(series, progress);
    check_duplicates(series, g, params);
    s.rectified_for = g.reason;
    s.verdict = g.resampled ? "usable, rectified: " + g.reason : "usable";
  } catch (const Error& e) {
    s.usable = false;
    s.verdict = "refused: " + e.field() + ": " + e.what();
  }
  return s;
}

}  // namespace

SeriesList list_series(const std::filesystem::path& folder_or_file, const ImportParams& params,
                       const Progress& progress) {
  if (auto volumes = volume_sources(folder_or_file, progress.part(0, 0.1)); !volumes.empty())
    return list_volumes(folder_or_file, std::move(volumes), params, progress);
  return with_scan(folder_or_file, [&] {
    const Catalogue catalogue = scan(folder_or_file, params.modality, progress.part(0, 0.5));
    if (catalogue.series.empty()) choose(catalogue, "");  // says what there is instead
    SeriesList list;
    const double share = 0.5 / static_cast<double>(catalogue.series.size());
    for (const Series& s : catalogue.series) {
      const double at = 0.5 + share * static_cast<double>(list.series.size());
      list.series.push_back(summary_of(s, params, progress.part(at, at + share)));
    }
    list.folder = describe_rest(catalogue, nullptr);
    return list;
  });
}

std::string list_text(const SeriesList& list) {
  std::vector<std::vector<std::string>> rows = {{"series", "modality", "spacing mm", "thickness", "kernel", "contrast",
                                                 "tilt", "steps mm", "transfer syntax", "orientation", "verdict"}};
  for (const SeriesSummary& s : list.series) {
    std::string steps = fmt::format("{:.4g}", s.smallest_step_mm);
    if (s.largest_gap_mm - s.smallest_step_mm > 1e-3) steps += fmt::format(" to {:.4g}", s.largest_gap_mm);
    if (s.missing_slices > 0) steps += fmt::format(", {} gaps", s.missing_slices);
    if (s.duplicates > 0) steps += fmt::format(", {} double", s.duplicates);
    const auto or_dash = [](const std::string& t) { return t.empty() ? std::string("-") : t; };
    const bool measured = s.largest_gap_mm > 0;
    rows.push_back({s.token, s.modality,
                    s.spacing_mm.x > 0
                        ? fmt::format("{:.4g} x {:.4g} x {:.4g}", s.spacing_mm.x, s.spacing_mm.y, s.spacing_mm.z)
                        : "-",
                    s.slice_thickness_mm > 0 ? fmt::format("{:.4g}", s.slice_thickness_mm) : "-", or_dash(s.kernel),
                    s.contrast ? "yes" : "no", measured ? fmt::format("{:.1f}", s.tilt_deg + 0.0) : "-",
                    measured ? steps : "-", s.transfer_syntax, or_dash(s.orientation), s.verdict});
  }
  std::string out = text_table(rows, "l") + "\n";
  for (const auto& [name, value] : list.folder.figures) out += fmt::format("{}: {}\n", name, trephine::to_text(value));
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
    j["contrast"] = s.contrast;
    j["tilt_deg"] = s.tilt_deg;
    j["smallest_step_mm"] = s.smallest_step_mm;
    j["largest_gap_mm"] = s.largest_gap_mm;
    j["missing_slices_count"] = s.missing_slices;
    j["duplicates_count"] = s.duplicates;
    j["transfer_syntax"] = s.transfer_syntax;
    j["orientation"] = s.orientation;
    j["usable"] = s.usable;
    j["rectified_for"] = s.rectified_for;
    j["verdict"] = s.verdict;
    all["series"].push_back(j);
  }
  ordered_json& rest = all["folder"] = ordered_json::object();
  for (const auto& [name, value] : list.folder.figures)
    if (const auto* count = std::get_if<std::int64_t>(&value)) rest[name] = *count;
  return all.dump(2) + "\n";
}

}  // namespace trephine::dicom

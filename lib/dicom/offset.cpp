// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/offset.h"

#include <fmt/format.h>

#include "base/error.h"
#include "dicom/hu.h"
#include "grid/axes.h"

namespace trephine::dicom {

void require_offset(const grid::HuVolume& volume, const std::string& field) {
  constexpr double min_air = 0.02, min_tissue = 0.05, max_light = 0.001;
  constexpr std::size_t step = 7;  // a prime: no column of the picture alone
  std::size_t all = 0, light = 0, air = 0, between = 0, tissue = 0;
  std::visit(
      [&](const auto& g) {
        for (std::size_t i = 0; i < g.voxels.size(); i += step) {
          const double v = double(g.voxels[i]);
          if (v == air_hu) continue;
          ++all;
          light += v < -300;
          air += v >= -60 && v <= 124;
          between += v > 300 && v < 850;
          tissue += v >= 900 && v <= 1180;
        }
      },
      volume);
  const double of = all > 0 ? 1.0 / double(all) : 0;
  if (all == 0 || double(light) * of > max_light || double(air) * of < min_air || double(tissue) * of < min_tissue ||
      tissue < between)
    return;
  throw Error(
      ExitCode::bad_input, "", field,
      fmt::format("the values are those of a CT without its offset of -1024: {:.0f} % lie about 0, as air would, "
                  "{:.0f} % about 1050, as soft tissue would, and none where air and lung have their HU; ",
                  100 * double(air) * of, 100 * double(tissue) * of) +
          Setting{"offset_hu", "-1024"} + " adds it");
}

std::string sample_type_of(const grid::HuVolume& volume) {
  return std::holds_alternative<grid::Grid<std::int16_t>>(volume) ? "int16" : "float32";
}

void say_otherwise(ImportResult& result, const ImportParams& params) {
  ImportFigures& f = result.figures;
  if (params.offset_hu != 0) {
    f.offset_hu = params.offset_hu;
    result.warnings.push_back({"offset_added",
                               "{offset_hu:g} was added to every value, as the option asks",
                               {{"offset_hu", params.offset_hu}}});
  }
  if (!params.axes.empty()) {
    result.volume = grid::with_axes(std::move(result.volume), params.axes);
    f.axes = params.axes;
    result.warnings.push_back({"axes_given",
                               "columns, rows and slices rise to {axes} as the option asks, whatever the files "
                               "contain",
                               {{"axes", params.axes}}});
  }
  const auto note = [](std::optional<std::string>& figure, const std::string& reason) {
    if (!reason.empty()) figure = reason;
  };
  note(f.orientation_reason, params.orientation_reason);
  note(f.burned_in_reason, params.burned_in_reason);
  note(f.same_patient_reason, params.same_patient_reason);
}

}  // namespace trephine::dicom

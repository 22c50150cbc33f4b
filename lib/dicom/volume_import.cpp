// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/volume_import.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "dicom/hu.h"
#include "dicom/input_files.h"
#include "dicom/offset.h"
#include "itk/volume_file.h"

namespace trephine::dicom {
namespace {

constexpr int bin_hu = 25, first_hu = -1025, bins = 200;  ///< from -1025 to 3975 HU
constexpr double min_soft_share = 0.02;

struct Counts {
  std::int64_t padding = 0, clamped = 0;
  double min = 0, max = 0;
  std::array<std::int64_t, bins> histogram{};
  std::int64_t soft = 0, all = 0;
};

// Padding becomes air, values beyond the limits are clamped; all is counted.
template <class T>
Counts cleaned(grid::Grid<T>& grid, const ImportParams& params, bool hu) {
  Counts c;
  c.all = static_cast<std::int64_t>(grid.voxels.size());
  if (grid.voxels.empty()) return c;
  c.min = c.max = hu && double(grid.voxels[0]) < -1024 ? air_hu : double(grid.voxels[0]);
  for (T& v : grid.voxels) {
    double d = std::clamp(double(v) + params.offset_hu, double(std::numeric_limits<T>::lowest()),
                          double(std::numeric_limits<T>::max()));
    if (hu && d < -1024) d = air_hu, ++c.padding;
    const double held = std::clamp(d, params.clamp_low_hu, params.clamp_high_hu);
    c.clamped += held != d;
    if (held != double(v)) v = static_cast<T>(held);
    c.min = std::min(c.min, held);
    c.max = std::max(c.max, held);
    const double bin = (held - first_hu) / bin_hu;
    if (bin >= 0 && bin < bins) ++c.histogram[static_cast<std::size_t>(bin)];
    c.soft += held >= -200 && held <= 200;
  }
  return c;
}

std::int64_t count_between(const Counts& c, int low_hu, int high_hu) {
  std::int64_t sum = 0;
  for (int b = 0; b < bins; ++b)
    if (first_hu + b * bin_hu >= low_hu && first_hu + (b + 1) * bin_hu <= high_hu)
      sum += c.histogram[static_cast<std::size_t>(b)];
  return sum;
}

void require_hu(const Counts& c) {
  const auto refuse = [](const std::string& what) {
    throw Error(ExitCode::bad_input, "", "volume_values",
                Message("the values do not look like HU: " + what + "; ") + Setting{"volume_values", "any"} +
                    " takes them for what they are, of another modality");
  };
  if (c.min >= 0 && c.max <= 255)
    refuse("all lie from 0 to 255, as those of an 8-bit picture, in which HU are lost: export the CT with 16 bits");
  if (c.min >= -200)
    refuse(fmt::format("the smallest is {:g}, and air has -1000 (without its offset of -1024, or cut at the skin)",
                       c.min));
  const std::int64_t light = count_between(c, first_hu, -500), air = count_between(c, -1025, -875);
  if (light == 0 || double(air) < 0.3 * double(light)) refuse("what is lighter than lung does not lie at air, -1000");
  if (double(c.soft) < min_soft_share * double(c.all))
    refuse(
        fmt::format("{:.2f} % lie from -200 to 200, where soft tissue does", 100.0 * double(c.soft) / double(c.all)));
  if (c.max < 150) refuse(fmt::format("the largest is {:g}: there is no bone", c.max));
}

void require_values_said(const ImportParams& params) {
  if (params.volume_values == VolumeValues::unsaid)
    throw Error(ExitCode::usage, "", "volume_values",
                "must be given: a file that is no DICOM does not say whether its values are HU; " +
                    Message(Setting{"volume_values", "hu"}) + " says so, " + Setting{"volume_values", "any"} +
                    " that they are not");
}

// All but the hash.
ImportResult imported(itk::VolumeFile read, const ImportParams& params) {
  require_values_said(params);
  const bool hu = params.volume_values == VolumeValues::hu;
  if (hu && !read.modality.empty() && read.modality != "CT")
    throw Error(ExitCode::bad_input, "", "Modality",
                read.modality + ": its values are no HU; if they shall be taken as they are, give volume_values any");
  ImportResult result;
  const Counts counts = std::visit([&](auto& grid) { return cleaned(grid, params, hu); }, read.volume);
  if (hu) require_offset(read.volume, "volume_values");
  if (hu) require_hu(counts);
  const grid::Lattice& lattice = grid::lattice_of(read.volume);
  ImportFigures& f = result.figures;
  f.modality = hu ? "CT" : "any";
  f.format = read.format;
  f.slices_count = static_cast<std::size_t>(lattice.size[2]);
  f.size = lattice.size;
  f.spacing_x_mm = lattice.spacing_mm.x;
  f.spacing_y_mm = lattice.spacing_mm.y;
  f.spacing_z_mm = lattice.spacing_mm.z;
  f.padding_voxels_count = static_cast<std::int64_t>(counts.padding);
  f.clamped_voxels_count = static_cast<std::int64_t>(counts.clamped);
  f.hu_min = counts.min;
  f.hu_max = counts.max;
  f.sample_type = sample_type_of(read.volume);
  for (const std::string& w : read.warnings) result.warnings.push_back({"volume_file", w, {}});
  if (hu)
    result.warnings.push_back({"hu_by_word",
                               "a {format} file cannot say that its values are HU: it is taken from the option",
                               {{"format", read.format}}});
  result.volume = std::move(read.volume);
  say_otherwise(result, params);
  return result;
}

std::string token_of(const VolumeSource& source, const std::array<int, 3>& size) {
  return fmt::format("{}-{}x{}x{}", source.token, size[0], size[1], size[2]);
}

// An unpacked file has a name that says nothing to the user.
template <class F>
auto naming(const std::filesystem::path& path, const VolumeSource& volume, F&& f) {
  try {
    return std::forward<F>(f)();
  } catch (const Error& e) {
    if (!volume.unpacked) throw;
    throw Error(e).refiled(name_of_scan(path));
  }
}

SeriesSummary summary_of(const std::filesystem::path& path, VolumeSource& source, const ImportParams& params,
                         const Progress& progress) {
  SeriesSummary s;
  s.token = source.token;
  try {
    unpack(path, source, progress.part(0, 0.2));
    itk::VolumeFile read = itk::read_volume_file(source.file, progress.part(0.2, 1));
    const grid::Lattice& lattice = grid::lattice_of(read.volume);
    s.size = lattice.size;
    s.spacing_mm = lattice.spacing_mm;
    s.smallest_step_mm = s.largest_gap_mm = lattice.spacing_mm.z;
    s.token = token_of(source, s.size);
    s.modality = read.format;
    imported(std::move(read), params);
    s.usable = true;
    s.verdict = "usable";
  } catch (const Error& e) {
    s.verdict = "refused: " + e.field() + ": " + e.what();
  }
  return s;
}

}  // namespace

ImportResult import_volume(const std::filesystem::path& path, const VolumeSource& volume, const ImportParams& params,
                           const Progress& progress) {
  require_values_said(params);  // before anything is read
  return naming(path, volume, [&] {
    itk::VolumeFile read = itk::read_volume_file(volume.file, progress);
    const std::string token = token_of(volume, grid::lattice_of(read.volume).size);
    if (params.series.find('-') != std::string::npos && params.series != token)
      throw Error(ExitCode::usage, name_of_scan(path), "series",
                  params.series + " is now " + token + ": look at it again");
    ImportResult result = imported(std::move(read), params);
    result.input_sha256 = itk::hash_of_volume_file(volume.file);
    return result;
  });
}

std::string hash_of_volume(const std::filesystem::path& path, const VolumeSource& volume) {
  return naming(path, volume, [&] { return itk::hash_of_volume_file(volume.file); });
}

SeriesList list_volumes(const std::filesystem::path& path, std::vector<VolumeSource> volumes,
                        const ImportParams& params, const Progress& progress) {
  SeriesList list;
  const double share = 1.0 / static_cast<double>(volumes.size());
  for (VolumeSource& v : volumes) {
    const double at = share * static_cast<double>(list.series.size());
    list.series.push_back(summary_of(path, v, params, progress.part(at, at + share)));
    v.unpacked.reset();  // one unpacked file at a time
  }
  return list;
}

}  // namespace trephine::dicom

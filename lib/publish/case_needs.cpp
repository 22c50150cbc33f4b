// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/case_needs.h"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/calibration.h"
#include "base/error.h"
#include "base/memory_budget.h"
#include "base/text.h"

namespace trephine::publish {

// Measured values. Memory, with nine anatomies: 317 MB at 2.9 million voxels, 398 at 6.3, 467 at 28, 594 at 42, 607 to
// 647 at 50 and 2,430 to 2,480 at 262; with a skull alone 230 at 6.3, 303 at 28 and 400 at 50. A case: 2 MB at 16,000
// voxels, 37 MB at 50 million, with a page (6 MB) and a CT (noise hardly compresses) 47, 65, 80 and 82 MB at 24, 28, 42
// and 46. Its stages in the cache, fields (growing with volume) and surfaces (growing with area): 80 MB at 6.3 million,
// 560 MB at 50 million.
CaseNeeds case_needs(std::uint64_t voxels_count, std::size_t anatomies_count, bool with_ct, bool with_page) {
  const double mega = static_cast<double>(voxels_count) / 1e6;
  const double ct_mb = with_ct ? 0.85 * mega : 0, page_mb = with_page ? std::min(6.0, 1 + mega) : 0;
  const double anatomies = static_cast<double>(anatomies_count);
  const double of_surfaces_mb = 80 + std::sqrt(mega) * (65 + 8.3 * anatomies);  // their area
  const double of_volumes_mb = 200 + 21 * anatomies + (3.4 + 0.51 * anatomies) * mega;
  const double memory_mb = std::min(of_surfaces_mb, of_volumes_mb);
  return {memory_mb, 3 + 0.8 * mega + ct_mb + page_mb, 6 * mega + 20 * std::cbrt(mega * mega)};
}

std::uint64_t ScanRaster::count() const {
  return static_cast<std::uint64_t>(voxels_count[0] * voxels_count[1] * voxels_count[2]);
}

ScanRaster ScanRaster::on_voxels(const std::array<double, 3>& wanted_mm) const {
  ScanRaster out = *this;
  for (std::size_t a = 0; a < 3; ++a)
    if (wanted_mm[a] > 0) {
      out.voxels_count[a] = std::max(1.0, std::round(voxels_count[a] * spacing_mm[a] / wanted_mm[a]));
      out.spacing_mm[a] = wanted_mm[a];
    }
  return out;
}

ScanRaster ScanRaster::within(double length_mm) const {
  ScanRaster out = *this;
  for (std::size_t a = 0; a < 3; ++a)
    if (spacing_mm[a] > 0) out.voxels_count[a] = std::min(voxels_count[a], std::ceil(length_mm / spacing_mm[a]));
  return out;
}

ScanRaster raster_of(const dicom::ImportFigures& scan) {
  ScanRaster out;
  for (std::size_t a = 0; a < 3; ++a) out.voxels_count[a] = scan.size[a];
  out.spacing_mm = {scan.spacing_x_mm, scan.spacing_y_mm, scan.spacing_z_mm};
  return out;
}

std::string megabytes_text(double mb) {
  const auto rounded = [](double v) { return to_text(std::round(v * 10) / 10); };
  return mb < 1000 ? rounded(mb) + " MB" : rounded(mb / 1000) + " GB";
}

void require_disk(const std::filesystem::path& folder, double need_mb) {
  std::error_code error;
  const double free_mb = static_cast<double>(std::filesystem::space(folder, error).available) / 1e6;
  if (error || need_mb <= free_mb) return;
  throw Error(ExitCode::cannot_create, folder.string(), "disk",
              megabytes_text(need_mb) + " are needed by estimate, " + megabytes_text(free_mb) +
                  " are free; --no-check-disk begins all the same");
}

MemoryNeed memory_need(const ScanRaster& scan, const ScanRaster& used, std::size_t anatomies_count,
                       const mask::ShapeInterpolateParams* interpolated) {
  if (scan.count() < 1'000'000) return {};
  // Measured: 260 MB more than for the scan's own voxels where 48 million are added between slices of 2 mm, and none
  // where 35 million are between slices of 5 mm.
  constexpr double added_mb_per_million = 4;
  const auto need_mb = [&](const ScanRaster& r) {
    grid::Lattice l;
    for (int a = 0; a < 3; ++a) l.size[std::size_t(a)] = int(r.voxels_count[std::size_t(a)]);
    l.spacing_mm = {r.spacing_mm[0], r.spacing_mm[1], r.spacing_mm[2]};
    const double added = interpolated ? double(r.count()) * (mask::interpolated_steps(l, *interpolated) - 1) : 0;
    return case_needs(r.count(), anatomies_count, false, false).memory_mb + added_mb_per_million * added / 1e6;
  };
  const double there_mb = static_cast<double>(available_memory_bytes()) / 1e6, mb = need_mb(used);
  MemoryNeed need;
  need.text = "about " + megabytes_text(10 * std::round(mb / 10)) + " of memory by estimate, " +
              megabytes_text(there_mb) + " are available";
  if (mb <= there_mb) return need;
  need.remedy = "end other programs";
  constexpr double max_mm = 3;  // on larger voxels nothing is left of a head that anybody would look for
  for (double mm = 0.5; mm <= max_mm; mm += 0.1) {
    std::array<double, 3> larger{};
    for (std::size_t a = 0; a < 3; ++a) larger[a] = std::max(std::round(10 * mm) / 10, used.spacing_mm[a]);
    if (need_mb(used.on_voxels(larger)) > 0.9 * there_mb) continue;
    const auto text = [](double v) { return to_text(std::round(1000 * v) / 1000); };
    need.remedy += ", or take larger voxels: `--set resample.spacing_mm=[" + text(larger[0]) + "," + text(larger[1]) +
                   "," + text(larger[2]) + "]`";
    break;
  }
  return need;
}

void give_large_blocks_back(const ScanRaster& scan) {
  constexpr std::uint64_t from_voxels = 20'000'000;
  constexpr int from_bytes = 2 << 20;
  if (scan.count() >= from_voxels) ::mallopt(M_MMAP_THRESHOLD, from_bytes);
}

std::vector<std::string> overrun(const config::CaseTrade& trade, double seconds) {
  const double budget_s = trade.rule.seconds;
  if (budget_s <= 0 || seconds <= budget_s) return {};
  return {"took " + to_text(ParameterValue(std::round(10 * seconds) / 10)) + " s, the budget is " +
          to_text(ParameterValue(budget_s)) + " s: this machine or its load is not that of " + trade.front_names()};
}

std::string seconds_expected(const config::CaseTrade& trade) {
  if (trade.rule.empty() || !(trade.calibration_s > 0)) return "";
  const double slower = calibration_seconds() / trade.calibration_s;
  return "this machine takes " + to_text(ParameterValue(std::round(100 * slower) / 100)) +
         " times as long as that of " + trade.front_names() + ": expect about " +
         std::to_string(std::lround(trade.choice.point.seconds * slower)) +
         " s for a scan of the size that was measured there";
}

}  // namespace trephine::publish

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "phantom/head.h"
#include "phantom/print_scan.h"
#include "phantom/scan.h"
#include "phantom/second_scan.h"
#include "phantom/series.h"
#include "phantom/spine.h"
#include "phantom/truth.h"

namespace trephine::phantom {

/// All parameters of `trephine phantom`, in groups of their own declarations; names differ across groups.
struct PhantomParams {
  HeadParams head;
  ScanParams scan;
  SeriesParams series;
  TruthParams truth;
  SecondScanParams second;
  BodyParams body;
  PrintedParams printed;
};

/// The effective parameters as text, one `name=value` a line: what the files' UIDs are derived from.
std::string identity_of(const PhantomParams& params);

struct PhantomResult {
  std::int64_t slices_count = 0;
  double series_mb = 0;
  std::optional<double> second_series_mb;         ///< of the other kernel
  Named<double> volume_ml;                        ///< of a head's anatomies, as far as they were scanned
  std::optional<std::int64_t> pedicles_count;     ///< of a spine, in the truth
  std::optional<std::int64_t> truth_lines_count;  ///< of a chest
  template <class V>
  static void describe(V& v) {
    using P = PhantomResult;
    v.integer(&P::slices_count, "slices_count", Range{}, "Slices.");
    v.number(&P::series_mb, "series_mb", Range{}, "Size of the series.");
    v.number(&P::second_series_mb, "second_series_mb", "Size of the series of the other kernel.");
    v.map(&P::volume_ml, "volume", "Volume of an anatomy, as far as it was scanned.").items_between("", "_volume_ml");
    v.integer(&P::pedicles_count, "pedicles_count", "Pedicles in the truth.");
    v.integer(&P::truth_lines_count, "truth_lines_count", "Lines in the truth.");
  }
};

/// Makes out/dicom/slice_*.dcm, out/truth/* and, where asked for, out/second/*: the same bytes for the same parameters.
/// Of a print there is no truth. Of a spine or a chest, what is of other bodies must be as by default, and the other
/// way round. Throws as write_series and write_truth do, 64 for parameters that contradict each other.
PhantomResult make_phantom(const std::filesystem::path& out, const PhantomParams& params,
                           const Progress& progress = {});

/// The scan as a grid, HU. Throws 64 as lattice_of does.
grid::Grid<std::int16_t> volume_of(const Scan& scan);

/// What sample_dicom/ was made with.
PhantomParams sample_phantom();

}  // namespace trephine::phantom

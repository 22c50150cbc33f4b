// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "base/progress.h"
#include "base/report.h"
#include "grid/grid.h"
#include "phantom/head.h"
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
};

/// The effective parameters as text, one `name=value` a line: what the files' UIDs are derived from.
std::string identity_of(const PhantomParams& params);

/// Makes out/dicom/slice_*.dcm, out/truth/* and, where asked for, out/second/*: the same bytes for the same parameters.
/// Of a spine or a chest, what is of other bodies must be as by default, and the other way round.
/// Throws as write_series and write_truth do, 64 for parameters that contradict each other.
Report make_phantom(const std::filesystem::path& out, const PhantomParams& params, const Progress& progress = {});

/// The scan as a grid, HU. Throws 64 as lattice_of does.
grid::Grid<std::int16_t> volume_of(const Scan& scan);

/// What sample_dicom/ was made with.
PhantomParams sample_phantom();

}  // namespace trephine::phantom

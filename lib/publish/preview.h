// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "base/params.h"
#include "base/report.h"
#include "config/config.h"
#include "pipeline/executor.h"

namespace trephine::publish {

struct PreviewParams {
  std::string stage;
  double cell_mm = 2;
  int size_px = 480;
  double window_center_hu = 40, window_width_hu = 400;
  std::array<double, 3> at_mm{0, 0, 0};
  bool allow_external = false;
  template <class V>
  static void describe(V& v) {
    using P = PreviewParams;
    v.text(&P::stage, "stage",
           "Of a configuration: the stage whose result is drawn, as ANATOMY.STAGE, or a stage of the whole scan.");
    v.number(&P::cell_mm, "cell_mm", Range{0.2, 20},
             "Cells on which stages are computed and surfaces drawn; 0: those of the scan, which takes longer.")
        .none_at_zero();
    v.integer(&P::size_px, "size_px", Range{100, 2000}, "Side of each of the four pictures.");
    v.number(&P::window_center_hu, "window_center_hu", Range{-2000, 4000}, "Middle of the HU that the slices show.");
    v.number(&P::window_width_hu, "window_width_hu", Range{1, 8000}, "Range of the HU that the slices show.");
    v.numbers(&P::at_mm, "at_mm", Range{-1e5, 1e5},
              "Point through which the slices go, LPS; 0, 0, 0: the middle of what is drawn.");
    v.flag(&P::allow_external, "allow_external",
           "Allow the stage external to run the programs that the recipe names, as for `run`.");
  }
};

/// A picture of something in a scan: an axial, a coronal and a sagittal slice with its outline, and its surface.
struct Preview {
  std::string png;
  Report report;  ///< drawn (its kind), and of each shape NAME.volume_ml on the cells of the surface
};

/// Draws data of any kind that has a place: volumes (at 226.5 HU), fields, surfaces, haptic volumes, labels, cutters,
/// landmarks. `volume` is what the slices show; without it there are none, but a volume shows itself. Outlines are
/// exact; the surface is that of every n-th voxel, so that it has cells of about cell_mm: thin parts may be missing
/// there, and the volumes are rough. Throws Error 64 for a report, which has no place; 80 where there is nothing to be
/// seen; Cancelled.
Preview draw_preview(const std::string& name, const stages::StageData& data, const grid::HuVolume* volume,
                     const PreviewParams& params, const Progress& progress = {});

struct PreviewRequest {
  std::filesystem::path config;
  config::ConfigOverrides overrides;
  PreviewParams params;
  std::filesystem::path cache;  ///< empty: nothing is kept
};

/// Computes one stage of a case and what it needs, nothing else, on cells of cell_mm, and draws it on the scan: the
/// original one, or the one without its face where the scene takes the face away. Publishes nothing. Throws what
/// read_case_config, the stages and draw_preview throw; 64 where neither the scene nor that anatomy has such a stage,
/// naming the nearest. An anatomy that the scene does not show is computed as if it did.
Preview preview_stage(const PreviewRequest& request, pipeline::RunObserver& observer);

}  // namespace trephine::publish

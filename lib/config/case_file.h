// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <vector>

#include "boolean/burr_hole_params.h"
#include "config/case_scans.h"
#include "config/said.h"
#include "config/trade_front.h"
#include "dicom/import.h"

namespace trephine::config {

/// The declaration of a case's configuration file (configs/*.yaml).

/// Bounds of accuracy. Of all measured points that keep them, the fastest is taken.
struct AccuracyParams {
  double max_deviation_mm = 0, p99_deviation_mm = 0, rms_deviation_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = AccuracyParams;
    const Range range{1e-3, 1e12};
    v.number(&P::max_deviation_mm, "max_deviation_mm", range, "Largest deviation that any anatomy may have.")
        .none_at_zero();
    v.number(&P::p99_deviation_mm, "p99_deviation_mm", range, "Largest 99th percentile of the deviations.")
        .none_at_zero();
    v.number(&P::rms_deviation_mm, "rms_deviation_mm", range, "Largest root mean square of the deviations.")
        .none_at_zero();
  }
  std::string fault() const {
    return max_deviation_mm + p99_deviation_mm + rms_deviation_mm > 0 ? "" : "asks for nothing";
  }
};

/// Limits on what a case may cost.
struct BudgetParams {
  double seconds = 0;
  std::int64_t triangles = 0, bytes = 0;
  template <class V>
  static void describe(V& v) {
    using P = BudgetParams;
    v.number(&P::seconds, "seconds", Range{1e-3, 1e12}, "Seconds of all stages together.").none_at_zero();
    v.integer(&P::triangles, "triangles", Range{1, 1e12}, "Triangles of all anatomies together.").none_at_zero();
    v.integer(&P::bytes, "bytes", Range{1, 1e12}, "Bytes of all files of the case together.").none_at_zero();
  }
  std::string fault() const { return seconds > 0 || triangles > 0 || bytes > 0 ? "" : "asks for nothing"; }
};

struct CaseFileParams : VersionParams {
  std::string case_token, series, pipeline, scene, landmarks_file, profile;
  dicom::ImportParams import;
  Named<CaseScanParams> scans;
  Named<SaidPosition> landmarks;
  std::vector<boolean::BurrHoleParams> burr_holes;
  std::vector<SaidPath> trade;
  std::optional<AccuracyParams> accuracy;
  std::optional<BudgetParams> budget;
  Named<SaidPath> corrections;
  Named<SaidValue> set;

  template <class V>
  static void describe(V& v) {
    using P = CaseFileParams;
    v.template all_of<VersionParams>();
    v.text(&P::case_token, "case", "Name of the case: a-z, 0-9, _ and -; never a patient's name.");
    v.text(&P::series, "series", "Folder, ZIP archive or file with the CT series.").names("file");
    v.text(&P::pipeline, "pipeline", "The recipe: which stages make which anatomy.").names("file").is_required();
    v.text(&P::scene, "scene", "The scene: which anatomies are wanted, and how good.").names("file").is_required();
    v.group(&P::import, "import", "How the series is read.");
    v.map(&P::scans, "scans",
          "Further scans of the patient by name, such as {mr: {modality: mr, series: ../mr}}; steps of the recipe read "
          "them by `scan: mr`.")
        .at_most(8);
    v.map(&P::landmarks, "landmarks", "Known landmarks by name, LPS in mm; they replace found ones.");
    v.text(&P::landmarks_file, "landmarks_file",
           "Known landmarks: a file of 3D Slicer (.mrk.json, .fcsv) or of `trephine landmarks` (.json).")
        .names("file");
    v.list(&P::burr_holes, "burr_holes", "The burr holes, where the scene cuts them.").at_most(16);
    v.list(&P::trade, "trade",
           "What `trephine trade` measured: a file, or a list of files whose points must hold in all of them.");
    v.group(&P::accuracy, "accuracy", "Take the fastest measured point that keeps these bounds.");
    v.group(&P::budget, "budget", "Take the most accurate measured point within these limits.");
    v.word(&P::profile, "profile", profile_names, "A named point of the trade, instead of accuracy and budget.");
    v.map(&P::corrections, "corrections",
          "What a person painted, by anatomy: files that `trephine correction` wrote, such as {skull: skull.nrrd}.");
    v.map(&P::set, "set", "Parameters by their paths, such as skull.decimate.max_deviation_mm: 0.2.");
  }
};

}  // namespace trephine::config

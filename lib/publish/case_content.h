// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "cases/case.h"
#include "config/config.h"
#include "pipeline/executor.h"
#include "pipeline/graph.h"
#include "publish/case_pictures.h"
#include "publish/case_table.h"

namespace trephine::publish {

/// A case in memory: everything that will be published, before anything is written.
struct CaseContent {
  struct File {
    std::string stem, extension;  ///< as write_case_file takes them
    std::string bytes;
  };
  cases::CaseManifest manifest;
  std::vector<File> files;
  std::vector<AnatomyResult> anatomies;
  std::vector<CasePicture> pictures;
  std::vector<stages::Evidence> evidence;  ///< what speaks against its anatomies
  std::vector<std::string> remarks;        ///< that its verdict ends with
};

/// Of what a case has pictures (face_clearance.h).
enum class PicturesOf { nothing, surfaces, surfaces_and_scan };
struct PictureWish {
  PicturesOf of = PicturesOf::nothing;
  bool all_sides = false;  ///< also each surface from six sides
};

/// The nodes whose data or report the case needs, and those that its pictures and its page need beside. Only these and
/// their sources are computed.
std::vector<int> wanted_nodes(const pipeline::Graph& graph, bool pictures, bool page = false);

/// Makes the case from a run's results and checks it against the scene's limits. Throws Error 80, naming the anatomy,
/// where a surface is not valid in float32, exceeds the scene's triangles or deviation, or a burr hole is not free.
CaseContent make_case_content(const config::CaseConfig& config, const pipeline::Graph& graph,
                              const std::vector<pipeline::NodeResult>& results, const std::string& program_version,
                              const std::string& input_sha256, PictureWish pictures, const Progress& progress);

}  // namespace trephine::publish

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "config/config.h"

namespace trephine {

/// One computation of a case: a stage with its parameters and where its inputs come from.
struct Node {
  std::string name;  ///< "import", "skull.decimate"
  const StageType* type = nullptr;
  AnyParams params;
  std::map<std::string, int> sources;              ///< port -> node
  std::map<std::string, std::string> file_sha256;  ///< of parameters that name files: their content stands for them
  std::string key;  ///< SHA-256 of all that its output depends on: stage, version, parameters, keys of its sources
  DataKind output = DataKind::volume;
  /// What a case records of its parameters, those within others by their place: values, or a file's hash.
  std::vector<std::pair<std::string, ParameterValue>> recorded() const;
};

/// The nodes of what the scene demands and nothing else, sources before their readers. Node 0 is the import, a stage as
/// any. Where the scene's policy takes the face away, that is done to the scan before any anatomy is made of it; nodes
/// that still see the face are named "original....".
struct Graph {
  std::vector<Node> nodes;
  struct Anatomy {
    std::string name;
    int first_surface = -1;  ///< the contour: what deviations are measured against
    int finished = -1;       ///< decimated, smoothed
    int surface = -1;        ///< what is published: finished, or that with its burr holes
    int measure = -1;        ///< of `finished`: a burr hole is no deviation
  };
  std::vector<Anatomy> anatomies;  ///< as in the scene
  int scan = 0;                    ///< the volume that anatomies, pictures and haptic volume are made of
  int landmarks = -1;              ///< -1: none need be found
  int given_landmarks = -1;        ///< -1: none are given, or none are needed
  int anatomy_gate = -1, face_gate = -1;
  std::vector<int> burr_holes;     ///< their cutters, as in the configuration
  int haptic = -1, mismatch = -1;  ///< -1: not wanted
  int find(const std::string& name) const;
};

/// `input_hash` identifies the series' content (hash_of_series_input).
Graph make_graph(const CaseConfig& config, const std::string& input_hash);

}  // namespace trephine

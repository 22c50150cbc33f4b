// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "config/config.h"
#include "dicom/import.h"

namespace trephine::pipeline {

/// One computation of a case: a stage with its parameters and the sources of its inputs.
struct Node {
  std::string name;  ///< "import", "skull.decimate"
  const stages::StageType* type = nullptr;
  AnyParams params;
  std::map<std::string, int> sources;  ///< port -> node
  std::map<std::string, std::string>
      file_sha256;  ///< for parameters that name files: the hash of the content stands for the path
  std::string key;  ///< SHA-256 of what the output depends on: stage, version, parameters, sources' keys
  stages::DataKind output = stages::DataKind::volume;
  bool may_be_missing = false;  ///< it belongs to an anatomy that may be missing, or has a stand-in
  bool wanted = false;          ///< the case itself reads its data or report
  bool is_early = false;        ///< a check with its first inputs alone: what it reports the whole check does too
  std::string serves;           ///< what the case has of it, in words
  /// The anatomy of whose recipe it is a step; empty: of none.
  std::string anatomy() const;
  /// The parameters that a case records, nested ones by their path: their values, or a file's hash. Of a stage that
  /// runs somebody else's program, the absolute paths without their folders.
  std::vector<std::pair<std::string, ParameterValue>> recorded() const;
  /// The parameters as text; the hash of a file's content stands for its path.
  std::string parameters_text() const;
};

/// The node that imports the case's series, or the further scan of that name; its parameters are set under that name.
std::string import_name(const std::string& scan = "");

/// The nodes that the scene needs and no others, sources before their readers. Node 0 is the import, which is a stage
/// like any other. Where the scene's policy takes the face away, this is done to the scan before any anatomy is made of
/// it; nodes that still see the face are named "original....".
struct Graph {
  std::vector<Node> nodes;
  struct Anatomy {
    std::string name;
    int first_surface = 0;  ///< the contour, against which deviations are measured
    int finished = 0;       ///< decimated and smoothed; a burr hole is no deviation
    int surface = 0;        ///< the published one: `finished`, or `finished` with its burr holes
  };
  std::vector<Anatomy> anatomies;  ///< as in the scene
  struct Removal {
    int before = 0, after = 0;
  };
  /// The scan before and after each stage that draws what it takes off. Empty where the scene takes the face away:
  /// apparatus that lies on a face has its shape.
  std::vector<Removal> removals;
  int scan = 0;  ///< the volume that anatomies, pictures and haptic volume are made of, and the CT that is published
  std::map<std::string, int> scans;  ///< further scans that a stage reads, on the CT's voxels, by name
  /// What the case has of that kind, such as its haptic volume and its landmarks: the first such node that it reads
  /// itself; -1: none. Of burr holes, all.
  int result(stages::DataKind kind) const;
  std::vector<int> results(stages::DataKind kind) const;
  /// The node, and all that it is made of.
  std::vector<int> needs_of(int node) const;
  /// -1: none.
  int find(const std::string& name) const;
  /// The first node of the stage with those parameters, of that anatomy or further scan, or (empty) of any; -1: none.
  int find_stage(const ParameterSet& params, const std::string& of) const;
  template <class P>
  int find_stage(const std::string& of = "") const {
    return find_stage(parameters_of<P>(), of);
  }
};

/// Throws Error 64 where a node runs a program that the configuration names (StageType::runs_program) and the user did
/// not allow it. Whoever computes nodes asks this before the first one.
void require_allowed(const Graph& graph, bool allow_external);

/// The hash of a further scan's content, by the scan's name.
using HashOfScan = std::function<std::string(const std::string& name, const dicom::SeriesChoice& series)>;

/// `input_hash` identifies the series' content (hash_of_series_input). The content of further scans is hashed as well,
/// of those alone that a stage of the graph reads: by `hash_of_scan`, or hash_of_series_input where there is none.
/// Throws what that throws, 78 where a stage reads a scan that the case has not, and 64 where it is not said where that
/// scan lies.
Graph make_graph(const config::CaseConfig& config, const std::string& input_hash, const HashOfScan& hash_of_scan = {});

}  // namespace trephine::pipeline

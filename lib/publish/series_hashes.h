// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>

#include "base/error.h"
#include "base/progress.h"
#include "pipeline/graph.h"

namespace trephine::publish {

/// The content of the series that a case reads. Each is hashed once, though an anatomy that is left out needs another
/// graph.
class SeriesHashes {
 public:
  explicit SeriesHashes(const Progress& cancelled) : cancelled_(cancelled) {}

  /// Throws what make_graph and hash_of_series_input throw.
  pipeline::Graph graph_of(const config::CaseConfig& config);
  /// The hash of the case's own series.
  const std::string& input(const config::CaseConfig& config);
  /// What else the folders of series hold, by the node that imports each.
  const std::map<std::string, dicom::FolderRest>& folders() const { return folders_; }

 private:
  const std::string& hash(const std::string& import, const dicom::SeriesChoice& series);

  const Progress& cancelled_;
  std::map<std::string, std::string> sha256_;
  std::map<std::string, dicom::FolderRest> folders_;
};

}  // namespace trephine::publish

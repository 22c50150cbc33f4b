// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/series_hashes.h"

#include <string>

#include "base/error.h"

namespace trephine::publish {
pipeline::Graph SeriesHashes::graph_of(const config::CaseConfig& config) {
  return pipeline::make_graph(config, input(config), [&](const std::string& name, const dicom::SeriesChoice& scan) {
    return hash(pipeline::import_name(name), scan);
  });
}

const std::string& SeriesHashes::input(const config::CaseConfig& config) {
  return hash(pipeline::import_name(), {config.series, config.import});
}

const std::string& SeriesHashes::hash(const std::string& import, const dicom::SeriesChoice& series) {
  std::string& sha256 = sha256_[import];
  if (sha256.empty()) try {
      sha256 = dicom::hash_of_series_input(series.folder_or_file, series.params, cancelled_, &folders_[import]);
    } catch (Error& e) {
      e.worded_for(import);
      throw;
    }
  return sha256;
}

}  // namespace trephine::publish

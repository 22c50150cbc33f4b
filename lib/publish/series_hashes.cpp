// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/series_hashes.h"

#include "base/error.h"

namespace trephine::publish {

pipeline::Graph SeriesHashes::graph_of(const config::CaseConfig& config) {
  return pipeline::make_graph(config, input(config), [&](const std::string& name, const dicom::SeriesChoice& scan) {
    return hash(name + ".import", scan);
  });
}

const std::string& SeriesHashes::input(const config::CaseConfig& config) {
  try {
    return hash("import", {config.series, config.import});
  } catch (const Error& e) {
    if (e.code() != ExitCode::usage) throw;
    throw Error(e.code(), e.file(), e.field(), std::string(e.what()) + "; --set import.series=s1 chooses the first");
  }
}

const std::string& SeriesHashes::hash(const std::string& import, const dicom::SeriesChoice& series) {
  std::string& sha256 = sha256_[import];
  if (sha256.empty())
    sha256 = dicom::hash_of_series_input(series.folder_or_file, series.params, cancelled_, &folders_[import]);
  return sha256;
}

}  // namespace trephine::publish

// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/series_hashes.h"

#include <string>
#include <utility>

#include "base/error.h"

namespace trephine::publish {
namespace {

std::string with_settings(const Error& e, const std::string& import) {
  std::string what = e.what();
  for (const auto& [flag, setting] : {std::pair{"--gaps interpolate", "gaps=interpolate"},
                                      {"--modality any", "modality=any"},
                                      {"--units any", "units=any"},
                                      {"--series-rule best", "series_rule=best"},
                                      {"--volume-values hu", "volume_values=hu"},
                                      {"--volume-values any", "volume_values=any"},
                                      {"--offset-hu -1024", "offset_hu=-1024"}})
    for (std::size_t at = 0; (at = what.find(flag, at)) != std::string::npos;) {
      const std::string named = "--set " + import + "." + setting;
      what.replace(at, std::string(flag).size(), named);
      at += named.size();
    }
  if (e.code() == ExitCode::usage && e.field() == "series")
    what += "; --set " + import + ".series=s1 chooses the first";
  return what;
}

bool is_importing(const std::string& node) {
  const std::size_t dot = node.rfind('.');
  return node == pipeline::import_name(dot == std::string::npos ? "" : node.substr(0, dot));
}

}  // namespace

Error in_settings(const Error& error) {
  const std::string node = error.field().substr(0, error.field().find(": "));
  if (!is_importing(node)) return error;
  Error told(error.code(), error.file(), error.field(), with_settings(error, node));
  told.in_case(error.case_token());
  return told;
}

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
    } catch (const Error& e) {
      throw Error(e.code(), e.file(), e.field(), with_settings(e, import));
    }
  return sha256;
}

}  // namespace trephine::publish

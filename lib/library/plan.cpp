// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/plan.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "base/hash.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/text.h"
#include "base/write_file.h"
#include "library/series_state.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

constexpr int token_digits = 10;

// Measured at 512 x 512 x 192: 0.5 GB. Lossless JPEG-LS of noisy slices takes about one byte for each voxel.
publish::CaseNeeds phantom_estimate(const phantom::ScanParams& scan) {
  const double mega = 1e-6 * scan.columns_count * scan.rows_count * scan.slices_count;
  return {100 + 12 * mega, 5 + 2 * mega, 0};
}

std::uint64_t voxels_of(const phantom::ScanParams& scan) {
  return std::uint64_t(scan.columns_count) * std::uint64_t(scan.rows_count) * std::uint64_t(scan.slices_count);
}

std::string identity_of(const LibraryPhantom& p, const std::string& program_version) {
  Sha256 sha;
  sha.text(program_version).text(phantom::identity_of(p.params));
  sha.text(to_text(p.params.truth.mesh_step_mm)).integer(p.params.truth.labels);
  return sha.hex();
}

// Finds why the phantom must be made, or which series it is.
void look_at_phantom(const LibraryState& state, PlannedPhantom& p) {
  try {
    const std::vector<char> bytes = read_file(state.phantom_record(p.name), 1 << 16);
    const auto json = nlohmann::json::parse(bytes.begin(), bytes.end());
    if (json.at("identity") != p.identity)
      p.reasons = {"its parameters or the program changed"};
    else if (json.at("files") != sign_files(state.phantom_folder(p.name) / "dicom").sha256)
      p.reasons = {"its files changed"};
    else
      p.series_sha256 = json.at("series").get<std::string>();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    p.reasons = {"it was never made"};
  }
}

class Planner {
 public:
  Planner(const LibraryConfig& config, const LibraryState& state, const PlanOptions& options, const Progress& progress)
      : config_(config), state_(state), options_(options), progress_(progress), memory_(state.series_file()) {}

  LibraryPlan make() {
    for (const LibraryPhantom& p : config_.phantoms) {
      PlannedPhantom planned;
      planned.name = p.name;
      planned.identity = identity_of(p, options_.program_version);
      look_at_phantom(state_, planned);
      planned.estimate = phantom_estimate(p.params.scan);
      plan_.phantoms.push_back(std::move(planned));
    }
    for (const LibraryCase& entry : config_.cases) {
      PlannedCase one;
      one.entry = entry;
      one.token = entry.token.empty() ? entry.origin : entry.token;
      plan_.cases.push_back(std::move(one));
    }
    choose();
    read_all_settings();
    read_all_series();
    drop_repeated();
    for (const std::string& token : options_.only)
      if (std::none_of(plan_.cases.begin(), plan_.cases.end(), [&](const PlannedCase& c) { return c.token == token; }))
        throw Error(ExitCode::usage, config_.file.string(), token, unknown_case(token));
    if (!options_.only.empty()) keep_only();
    find_reasons();
    if (options_.write) record();
    return std::move(plan_);
  }

 private:
  bool is_asked_for(const std::string& token) const {
    return options_.only.empty() || std::find(options_.only.begin(), options_.only.end(), token) != options_.only.end();
  }
  // Chooses the requested cases among those with a token of their own; found cases have none yet.
  void choose() {
    if (options_.only.empty()) return;
    for (const PlannedCase& c : plan_.cases) known_.push_back(c.token);
    auto& cases = plan_.cases;
    cases.erase(std::remove_if(cases.begin(), cases.end(),
                               [&](const PlannedCase& c) { return !c.entry.token.empty() && !is_asked_for(c.token); }),
                cases.end());
  }
  void keep_only() {
    auto& cases = plan_.cases;
    cases.erase(
        std::remove_if(cases.begin(), cases.end(), [&](const PlannedCase& c) { return !is_asked_for(c.token); }),
        cases.end());
  }
  std::string unknown_case(const std::string& token) const {
    const std::string near = nearest_name(token, known_);
    return "the library has no such case" + (near.empty() ? "" : ", did you mean " + near + "?");
  }

  void read_all_settings() {
    std::map<std::tuple<fs::path, fs::path, std::vector<std::string>>, std::shared_ptr<const CaseSettings>> known;
    std::map<fs::path, int> users;
    for (const PlannedCase& c : plan_.cases) ++users[c.entry.config];
    // Further scans are remembered as the first ones are, so that a plan reads no series that did not change.
    bool of_scan = false;
    const auto hash_of_scan = [&](const std::string&, const dicom::SeriesChoice& scan) {
      try {
        return memory_
            .content_of(scan.folder_or_file, scan.params, options_.rehash, Progress([](double) {}, &cancel_requested()))
            .sha256;
      } catch (const Error&) {
        of_scan = true;
        throw;
      }
    };
    for (PlannedCase& c : plan_.cases) {
      progress_.check();
      of_scan = false;
      auto& settings = known[{c.entry.config, c.entry.landmarks, c.entry.set}];
      try {
        if (!settings)
          settings = std::make_shared<const CaseSettings>(
              read_case_settings(c.entry, config_.roots, options_.pictures, options_.program_version, hash_of_scan));
        c.settings = settings;
        c.inputs.settings_sha256 = settings->sha256;
      } catch (const Error& e) {
        // A fault that all cases share is reported once and unchanged, with every line.
        const bool own = !c.entry.landmarks.empty() || users[c.entry.config] < static_cast<int>(plan_.cases.size());
        if (!own || plan_.cases.size() == 1) throw;
        c.fault = e;
        if (of_scan) c.fault->refiled("");  // a second scan's folder may be named after the patient
      }
    }
  }

  void read_all_series() {
    using Key = std::tuple<fs::path, std::string, int>;
    std::map<Key, std::vector<PlannedCase*>> groups;
    for (PlannedCase& c : plan_.cases) {
      if (c.fault) continue;
      c.series = c.entry.series;
      if (c.entry.phantom >= 0) {
        const auto index = static_cast<std::size_t>(c.entry.phantom);
        c.series = state_.phantom_folder(plan_.phantoms[index].name) / "dicom";
        c.voxels = voxels_of(config_.phantoms[index].params.scan);
        PlannedPhantom& p = plan_.phantoms[index];
        if (p.reasons.empty() && (!options_.rehash || look_again(p, c.series)))
          c.inputs.series_sha256 = p.series_sha256;
        continue;
      } else if (c.series.empty()) {
        c.series = c.settings->series;
      }
      if (c.series.empty()) {
        c.fault = Error(ExitCode::bad_config, "", "series", "neither the library nor the configuration names one");
        continue;
      }
      const dicom::ImportParams& import = c.settings->import;
      groups[{c.series, import.series, static_cast<int>(import.modality)}].push_back(&c);
    }
    std::vector<std::vector<PlannedCase*>> list;
    for (auto& [key, cases] : groups) list.push_back(cases);
    std::atomic<std::int64_t> done{0};
    const Progress quiet([](double) {}, &cancel_requested());
    parallel_for(0, static_cast<std::int64_t>(list.size()), 1, [&](std::int64_t from, std::int64_t to) {
      for (auto i = from; i < to; ++i) {
        read_series(list[static_cast<std::size_t>(i)], quiet);
        progress_.report(static_cast<double>(++done) / static_cast<double>(list.size()));
      }
    });
    if (options_.only.empty()) memory_.forget_others();
    if (options_.write) memory_.save(true);
  }

  // Reads a phantom's whole series; returns false where it is not the one that was made.
  bool look_again(PlannedPhantom& p, const fs::path& series) {
    try {
      if (!looked_.insert(p.name).second || dicom::hash_of_series_input(series, {}) == p.series_sha256) return true;
    } catch (const Error&) {  // the phantom is made again, whatever is there
    }
    p.reasons = {"its files changed"};
    return false;
  }

  void read_series(const std::vector<PlannedCase*>& cases, const Progress& progress) {
    SeriesContent content;
    std::optional<Error> fault;
    try {
      const PlannedCase& first = *cases.front();
      content = memory_.content_of(first.series, first.settings->import, options_.rehash, progress);
      if (options_.write) memory_.save(false);
    } catch (const Error& e) {
      if (e.code() == ExitCode::io || e.code() == ExitCode::cannot_create) throw;
      // A folder's name may identify the patient, so the case's token stands for it.
      fault = Error(e.code(), "", e.field().empty() ? "its series" : e.field(), e.what());
    }
    for (PlannedCase* c : cases) {
      c->fault = fault;
      if (fault && !c->entry.series_at.empty()) c->fault->refiled(c->entry.series_at);
      c->inputs.series_sha256 = content.sha256;
      c->voxels = content.voxels;
      if (c->entry.token.empty() && !fault)
        c->token = "case-" + content.sha256.substr(0, token_digits) + c->entry.suffix;
    }
  }

  // The same series in two folders is one patient. If a found series is also listed, the listed case counts.
  void drop_repeated() {
    std::set<std::string> tokens, listed;
    std::vector<PlannedCase> kept;
    for (const PlannedCase& c : plan_.cases)
      if (!c.entry.token.empty() && !c.inputs.series_sha256.empty()) listed.insert(c.inputs.series_sha256);
    for (PlannedCase& c : plan_.cases) {
      const bool again =
          c.entry.token.empty() && !c.fault && (listed.count(c.inputs.series_sha256) || tokens.count(c.token));
      plan_.repeated += again;
      if (again) continue;
      tokens.insert(c.token);
      kept.push_back(std::move(c));
    }
    plan_.cases = std::move(kept);
  }

  void find_reasons() {
    parallel_for(0, static_cast<std::int64_t>(plan_.cases.size()), 8, [&](std::int64_t from, std::int64_t to) {
      for (auto i = from; i < to; ++i) find_reasons_of(plan_.cases[static_cast<std::size_t>(i)]);
    });
    for (PlannedCase& c : plan_.cases)
      if (c.entry.phantom >= 0 && !c.fault && !c.reasons.empty())
        plan_.phantoms[static_cast<std::size_t>(c.entry.phantom)].needed = true;
  }

  // How many anatomies the scene names; where nothing is known of it, as many as that of a head.
  static std::size_t anatomies_of(const PlannedCase& c) {
    if (!c.settings) return 9;
    const std::string before = "scene.anatomies.";
    std::set<std::string> names;
    for (auto at = c.settings->values.lower_bound(before);
         at != c.settings->values.end() && at->first.rfind(before, 0) == 0; ++at)
      names.insert(at->first.substr(before.size(), at->first.find('.', before.size()) - before.size()));
    return names.size();
  }

  void find_reasons_of(PlannedCase& c) {
    if (c.fault) return;
    const bool with_ct = c.settings && c.settings->values.count("scene.ct.margin_mm") > 0;
    c.estimate = publish::case_needs(c.voxels, anatomies_of(c), with_ct, options_.pictures);
    const fs::path folder = state_.library() / c.token;
    const auto built = read_built(state_, c.token);
    if (options_.rebuild) c.reasons.emplace_back("everything is built anew");
    if (!built) {
      std::error_code ignored;
      c.reasons.emplace_back(fs::exists(folder / "case.json", ignored) ? "no record says what it was built of"
                                                                       : "it was never built");
    } else {
      if (c.entry.phantom >= 0 && c.inputs.series_sha256.empty())
        c.reasons.emplace_back("its phantom is made");
      else if (built->inputs.series_sha256 != c.inputs.series_sha256)
        c.reasons.emplace_back("its series changed");
      if (built->inputs.settings_sha256 != c.inputs.settings_sha256) {
        const auto before = read_settings(state_, built->inputs.settings_sha256);
        std::vector<std::string> lines;
        if (before) lines = explain_difference(*before, c.settings->values);
        if (lines.empty()) lines = {"its settings changed"};
        c.reasons.insert(c.reasons.end(), lines.begin(), lines.end());
      }
      const std::string fault = fault_of_built(folder, *built);
      if (!fault.empty()) c.reasons.push_back(fault);
    }
    if (c.reasons.empty()) return;
    // The memory of the last build with some room, where that is more than the estimate from other cases.
    if (const auto last = read_result(state_, c.token); last && last->code == 0)
      c.estimate.memory_mb = std::max(c.estimate.memory_mb, 1.1 * last->memory_mb);
  }

  void record() {
    std::set<std::string> settings;
    for (const PlannedCase& c : plan_.cases) {
      if (c.fault) continue;
      const fs::path file = state_.settings_file(c.inputs.settings_sha256);
      if (settings.insert(c.inputs.settings_sha256).second && !read_settings(state_, c.inputs.settings_sha256))
        write_file(file, settings_json(*c.settings));
      write_inputs(state_, c.token, c.inputs);
    }
  }

  const LibraryConfig& config_;
  const LibraryState& state_;
  const PlanOptions& options_;
  const Progress& progress_;
  SeriesMemory memory_;
  LibraryPlan plan_;
  std::vector<std::string> known_;
  std::set<std::string> looked_;
};

}  // namespace

LibraryPlan make_plan(const LibraryConfig& config, const LibraryState& state, const PlanOptions& options,
                      const Progress& progress) {
  return Planner(config, state, options, progress).make();
}

}  // namespace trephine::library

// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/keeping.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <set>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "base/write_file.h"
#include "cases/load_case.h"
#include "cases/new_case.h"
#include "library/batch.h"
#include "library/catalogue.h"
#include "library/dropped.h"
#include "library/library_config.h"
#include "pipeline/stage_cache.h"
#include "publish/case_lock.h"
#include "publish/refused.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

constexpr const char* cache_name = ".trephine-cache";
// Storing in the cache writes the data first and its index soon after.
constexpr double torn_s = 3600;
constexpr int verify_tries = 3;

double age_of(const fs::path& file) {
  std::error_code error;
  const auto written = fs::last_write_time(file, error);
  return error ? 0 : std::chrono::duration<double>(fs::file_time_type::clock::now() - written).count();
}

std::string line_of(const Error& e, const fs::path& library) {
  std::string file = e.file();
  if (!file.empty()) file = fs::path(file).lexically_proximate(library).string();
  for (const std::string& part : {e.field(), std::string(e.what())})
    if (!part.empty()) file += (file.empty() ? "" : ": ") + part;
  return printable(file);
}

std::string verify_case(const fs::path& library, const std::string& token, bool load, VerifyResult& sum,
                        std::mutex& mutex) {
  const fs::path folder = library / token;
  for (int attempt = 1;; ++attempt) {
    try {
      const cases::CaseManifest m = cases::read_case(folder);
      if (m.case_token != token) return "case.json: case: is of " + printable(m.case_token);
      if (load) cases::load_case(folder, cases::whole_case);
      const std::lock_guard<std::mutex> lock(mutex);
      sum.files += m.files.size() + 1;
      for (const cases::CaseFile& f : m.files) sum.bytes += f.bytes;
      std::error_code ignored;
      sum.bytes += fs::file_size(folder / "case.json", ignored);
      return "";
    } catch (const Error& e) {
      // A run that publishes at the same time removes the older case's files.
      if (e.code() != ExitCode::no_input || attempt == verify_tries) return line_of(e, library);
    }
  }
}

class Collector {
 public:
  Collector(const fs::path& library, const GcParams& params, const Progress& progress, const fs::path& library_file)
      : state_(library), params_(params), progress_(progress), library_file_(library_file) {}

  GcResult collect() {
    std::error_code error;
    if (!fs::is_directory(state_.library(), error))
      throw Error(ExitCode::no_input, state_.library().string(), "", "is no library's folder");
    std::vector<fs::path> folders;
    for (const auto& entry : fs::directory_iterator(state_.library())) {
      const std::string name = entry.path().filename().string();
      if (entry.is_directory() && !entry.is_symlink() &&
          (name[0] != '.' || is_refused(name) || cases::is_new_case_folder(name)))
        folders.push_back(entry.path());
    }
    std::sort(folders.begin(), folders.end());
    temporaries(state_.library());
    for (std::size_t i = 0; i < folders.size(); ++i) {
      progress_.report(static_cast<double>(i) / static_cast<double>(folders.size()));
      if (is_refused(folders[i].filename().string()))
        whole_folder(folders[i]);
      else if (cases::is_new_case_folder(folders[i].filename().string()))
        under_way(folders[i]);
      else
        case_folder(folders[i]);
    }
    kept_by_desk();
    records();
    batches();
    dropped_on_desk();
    cache();
    out_.table = (params_.dry_run ? "would remove " : "removed ") + std::to_string(out_.case_files) +
                 " files of cases, " + std::to_string(out_.folders) + " folders without a case, " +
                 std::to_string(out_.cache_entries) + " entries of the cache, " + std::to_string(out_.records) +
                 " records, " + std::to_string(out_.batches) + " ended batches of Slurm, " +
                 std::to_string(out_.drops) + " unused scans of the desk, " + std::to_string(out_.drafts) +
                 " drafts of cases that are gone, " + std::to_string(out_.temporaries) + " temporary files; " +
                 fixed_text(static_cast<double>(out_.bytes) / 1e6, 1) + " MB\n";
    if (out_.busy > 0) out_.table += std::to_string(out_.busy) + " cases are being built: left alone\n";
    return std::move(out_);
  }

 private:
  bool remove(const fs::path& file) {
    std::error_code error;
    const auto size = fs::file_size(file, error);
    if (!params_.dry_run && !fs::remove(file, error)) return false;
    if (size != static_cast<std::uintmax_t>(-1)) out_.bytes += size;
    return true;
  }
  void temporaries(const fs::path& folder) {
    if (!params_.dry_run) out_.temporaries += remove_stale_temporaries(folder);
  }

  void case_folder(const fs::path& folder) {
    std::error_code error;
    const bool published = fs::symlink_status(folder / "case.json", error).type() != fs::file_type::not_found;
    if (!published && !is_left_over(folder)) return;
    try {
      const publish::CaseLock lock(folder);
      for (const char* below : {"", "meshes", "report"}) temporaries(folder / below);
      if (published)
        unnamed_files(folder);
      else if (fs::symlink_status(folder / "case.json", error).type() == fs::file_type::not_found)
        whole_folder(folder);
    } catch (const Error& e) {
      if (e.code() == ExitCode::busy) ++out_.busy;
      // A damaged case.json does not tell which files the case needs, so none of its files is removed; `verify` reports
      // it.
    }
  }

  // What a first run of a case writes, until its case appears; a run that was killed leaves it.
  void under_way(const fs::path& folder) {
    try {
      const publish::CaseLock lock(folder);
      whole_folder(folder);
    } catch (const Error& e) {
      if (e.code() == ExitCode::busy) ++out_.busy;
    }
  }

  void unnamed_files(const fs::path& folder) {
    const std::vector<char> bytes = read_file(folder / "case.json", std::uint64_t{16} << 20);
    const cases::CaseManifest m = cases::parse_case_json({bytes.data(), bytes.size()});
    for (const char* below : {"", "meshes"}) {
      std::error_code error;
      std::vector<fs::path> files;
      for (fs::directory_iterator it(folder / below, error), end; !error && it != end; it.increment(error))
        if (it->is_regular_file() && !it->is_symlink()) files.push_back(it->path());
      for (const fs::path& file : files) {
        const std::string name = file.lexically_relative(folder).generic_string();
        if (has_content_name(file) && !m.find_file(name)) out_.case_files += remove(file);
      }
    }
  }
  // Only files named NAME-<16 digits>.EXTENSION, as a run writes them, may be removed.
  static bool has_content_name(const fs::path& file) {
    const std::string stem = file.stem().string();
    const auto dash = stem.rfind('-');
    return dash != std::string::npos && dash > 0 && stem.size() - dash - 1 == 16 &&
           stem.find_first_not_of("0123456789abcdef", dash + 1) == std::string::npos && !file.extension().empty();
  }

  // A run that was killed before it published leaves these and nothing else.
  static bool is_left_over(const fs::path& folder) {
    std::error_code error;
    bool any = false;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
      const std::string name = it->path().filename().string();
      if (!publish::is_lock(name) && name != "meshes" && name != "report" && name.rfind(temporary_prefix, 0) != 0 &&
          !has_content_name(it->path()))
        return false;
      any = any || publish::is_lock(name) || name == "meshes";
    }
    return !error && any;
  }
  // What a refused run left for looking, and what a killed one had written of it.
  static bool is_refused(const std::string& name) {
    const std::string ending = publish::refused_folder("", "").string();
    return name.size() > ending.size() && name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
  }
  void whole_folder(const fs::path& folder) {
    ++out_.folders;
    remove_folder(folder);
  }
  void remove_folder(const fs::path& folder) {
    std::error_code error;
    for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
      if (it->is_regular_file(error)) out_.bytes += it->file_size(error);
    if (!params_.dry_run) fs::remove_all(folder, error);  // with its lock file, as a run that fails does
  }

  // Removes records of cases that are gone, and settings that no record names.
  void records() {
    std::error_code error;
    std::set<std::string> settings;
    std::vector<fs::path> files;
    for (fs::directory_iterator it(state_.folder() / "cases", error), end; !error && it != end; it.increment(error))
      files.push_back(it->path());
    for (const fs::path& file : files) {
      const std::string name = file.filename().string(), token = name.substr(0, name.find('.'));
      if (token.empty()) continue;
      const auto inputs = read_inputs(state_, token);
      const auto built = read_built(state_, token);
      if (inputs) settings.insert(inputs->settings_sha256);
      if (built) settings.insert(built->inputs.settings_sha256);
      std::error_code ignored;
      const bool gone = !fs::exists(state_.library() / token, ignored);
      // A case that was never built is still wanted; a case that was built and is gone was removed by somebody.
      if (gone && built && age_of(file) > torn_s) out_.records += remove(file);
    }
    if (error) return;
    for (fs::directory_iterator it(state_.folder() / "settings", error), end; !error && it != end; it.increment(error))
      if (!settings.count(it->path().stem().string()) && age_of(it->path()) > torn_s)
        out_.records += remove(it->path());
    for (const char* below : {"", "cases", "settings", "phantoms", "logs"}) temporaries(state_.folder() / below);
  }

  // Whoever waits for a batch looks at it every few seconds, and reads there how it ended; so it stays for a while. One
  // whose submission was broken off holds the words of jobs and no batch.json.
  void batches() {
    std::error_code error;
    std::vector<fs::path> folders;
    for (fs::directory_iterator it(batches_folder(state_), error), end; !error && it != end; it.increment(error))
      if (it->is_directory() && !it->is_symlink()) folders.push_back(it->path());
    for (const fs::path& folder : folders) {
      const auto batch = read_batch(folder);
      if ((batch && batch->is_open()) || age_of(batch ? changed_last(*batch) : folder) <= torn_s) continue;
      ++out_.batches;
      remove_folder(folder);
    }
  }

  // A case that was never built may be painted on; one that was built and is gone was removed by somebody, and so was
  // one that LIBRARY.yaml does not list, where it lists all by their names.
  bool is_gone(const std::string& token) const {
    std::error_code ignored;
    if (fs::exists(state_.library() / token, ignored)) return false;
    if (read_built(state_, token)) return true;
    if (library_file_.empty()) return false;
    const std::vector<LibraryCase> listed = read_library_config(library_file_).cases;
    return std::none_of(listed.begin(), listed.end(),
                        [&](const LibraryCase& c) { return c.token.empty() || c.token == token; });
  }
  // What a page had not saved, and what a case was before it was built again, stand under the case's name.
  void kept_by_desk() {
    std::error_code error;
    std::vector<fs::path> all;
    for (fs::directory_iterator it(state_.folder() / "desk", error), end; !error && it != end; it.increment(error))
      all.push_back(it->path());
    for (const fs::path& kept : all) {
      const std::string name = kept.filename().string(), token = name.substr(0, name.find('.'));
      if (token.empty() || age_of(kept) <= torn_s || !is_gone(token)) continue;
      ++out_.drafts;
      remove_any(kept);
    }
    temporaries(state_.folder() / "desk");
  }
  void dropped_on_desk() {
    if (library_file_.empty()) return;
    for (const fs::path& drop : unused_drops(library_file_, {}, torn_s)) {
      ++out_.drops;
      remove_any(drop);
    }
    temporaries(fs::absolute(library_file_).parent_path());
  }
  void remove_any(const fs::path& path) {
    std::error_code ignored;
    if (fs::is_directory(fs::symlink_status(path, ignored)))
      remove_folder(path);
    else
      remove(path);
  }

  void cache() {
    const fs::path folder = state_.library() / cache_name;
    std::error_code error;
    if (!fs::is_directory(folder, error)) return;
    temporaries(folder);
    std::map<std::string, std::vector<fs::path>> entries;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
      if (it->path().stem().string().size() == 64) entries[it->path().stem().string()].push_back(it->path());
    for (auto& [key, files] : entries) {
      progress_.check();
      const auto index =
          std::find_if(files.begin(), files.end(), [](const fs::path& f) { return f.extension() == ".index"; });
      const double age_s = age_of(index == files.end() ? files.front() : *index);
      const bool torn = index == files.end() && age_s > torn_s;
      if (!torn && age_s <= params_.cache_days * 86400) continue;
      ++out_.cache_entries;
      if (index != files.end())
        std::iter_swap(files.begin(), index);  // the index is removed first: data without an index is no entry
      for (const fs::path& f : files) remove(f);
    }
    if (!params_.dry_run)
      pipeline::StageCache(folder).shrink_to(static_cast<std::uint64_t>(params_.cache_limit_mb) * 1'000'000);
  }

  const LibraryState state_;
  const GcParams& params_;
  const Progress& progress_;
  const fs::path library_file_;
  GcResult out_;
};

}  // namespace

VerifyResult verify_library(const fs::path& library, const std::vector<std::string>& only, bool load,
                            const Progress& progress) {
  std::vector<std::string> tokens;
  for (const std::string& token : library_tokens(library)) {
    std::error_code ignored;
    // A case that was never published has no bytes that could be wrong.
    if (fs::exists(library / token / "case.json", ignored) &&
        (only.empty() || std::find(only.begin(), only.end(), token) != only.end()))
      tokens.push_back(token);
  }
  for (const std::string& token : only)
    if (std::find(tokens.begin(), tokens.end(), token) == tokens.end())
      throw Error(ExitCode::no_input, library.string(), token, "the library has no such case");
  VerifyResult out;
  std::mutex mutex;
  std::vector<std::string> faults(tokens.size());
  std::size_t done = 0;
  parallel_for(0, static_cast<std::int64_t>(tokens.size()), 1, [&](std::int64_t from, std::int64_t to) {
    for (auto i = static_cast<std::size_t>(from); i < static_cast<std::size_t>(to); ++i) {
      faults[i] = verify_case(library, tokens[i], load, out, mutex);
      double share;
      {
        const std::lock_guard<std::mutex> lock(mutex);
        share = static_cast<double>(++done) / static_cast<double>(tokens.size());
      }
      progress.report(share);
    }
  });
  out.cases = static_cast<int>(tokens.size());
  for (std::size_t i = 0; i < tokens.size(); ++i)
    if (!faults[i].empty()) out.faults.emplace_back(tokens[i], faults[i]);
  out.table = std::to_string(out.cases) + (out.cases == 1 ? " case, " : " cases, ") + std::to_string(out.files) +
              " files, " + fixed_text(static_cast<double>(out.bytes) / 1e6, 1) + " MB: " +
              (out.faults.empty() ? "all as case.json says" : std::to_string(out.faults.size()) + " damaged") + "\n";
  for (const auto& [token, fault] : out.faults) out.table += token + "  " + fault + "\n";
  return out;
}

GcResult collect_garbage(const fs::path& library, const GcParams& params, const Progress& progress,
                         const fs::path& library_file) {
  return Collector(library, params, progress, library_file).collect();
}

}  // namespace trephine::library

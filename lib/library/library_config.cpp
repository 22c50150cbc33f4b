// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/library_config.h"

#include <fnmatch.h>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "cases/case.h"
#include "config/config_root.h"
#include "config/declared.h"
#include "library/library_file.h"
#include "stages/stage.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

// Whether the value of "anatomy.stage.parameter" names a file.
bool names_file(const std::string& path) {
  const auto last = path.rfind('.');
  if (last == std::string::npos || last == 0) return false;
  const auto before = path.rfind('.', last - 1);
  const stages::StageType* type =
      stages::find_stage(path.substr(before == std::string::npos ? 0 : before + 1, last - before - 1));
  if (!type) return false;
  const std::vector<std::string> files = type->file_params();
  return std::find(files.begin(), files.end(), path.substr(last + 1)) != files.end();
}

class Reader {
 public:
  Reader(const fs::path& file, const LibraryOverrides& overrides)
      : overrides_(overrides), tree_(config::read_yaml(file)) {
    out_.file = file;
    out_.roots = overrides.roots;
    roots_.push_back(config::root_of(file));
    for (const fs::path& r : overrides.roots) roots_.push_back(config::absolute_path(r));
  }

  LibraryConfig read() {
    config::DeclaredReading reading{out_.file, faults_, {}, {}};
    reading.fault_of_name = [this](const std::string& kind, const std::string& name) {
      std::string fault;
      // The folders of `series` are searched later, and paths in `set` are checked where they are read.
      if (kind == "file" && name.find_first_of("*?[") == std::string::npos) in_root(name, fault);
      return fault;
    };
    at_ = config::read_declared(reading, tree_, parameters_of<LibraryFileParams>(), &said_);
    read_configs();
    shared_set_ = set_of(said_.set, "set");
    read_engine();
    for (std::size_t i = 0; i < said_.cases.size(); ++i) read_case(i);
    for (std::size_t i = 0; i < said_.series.size(); ++i) find_series(i);
    if (said_.phantoms) read_phantoms();
    if (!at_.has("cases") && !at_.has("series") && !at_.has("phantoms"))
      faults_.add(out_.file, tree_, "cases", "is missing, and so are series and phantoms: the library has no case");
    faults_.raise();
    return std::move(out_);
  }

 private:
  fs::path in_root(const std::string& text, std::string& fault) const {
    return config::path_in_roots(fs::absolute(out_.file).parent_path(), text, roots_, fault);
  }
  fs::path path_at(const config::YamlNode& at, const std::string& where, const std::string& text) {
    std::string fault;
    const fs::path path = in_root(text, fault);
    if (!fault.empty()) faults_.add(out_.file, at, where, fault);
    return path;
  }
  // Faults of the path have been reported already.
  fs::path file_of(const std::string& text) const {
    std::string ignored;
    return text.empty() ? fs::path() : in_root(text, ignored);
  }
  std::string place_of(const config::YamlNode& at) const {
    return out_.file.string() + ":" + std::to_string(at.line) + ":" + std::to_string(at.column);
  }
  struct OneConfig {
    std::string suffix;
    fs::path file;
    std::string at;
  };
  OneConfig config_of(const std::string& suffix, const std::string& text, const std::string& where) const {
    return {suffix, file_of(text), text.empty() ? "" : place_of(at_.at(where))};
  }
  void read_configs() {
    if (!said_.config.empty()) configs_.push_back(config_of("", said_.config, "config"));
    for (const auto& [name, path] : said_.configs)
      configs_.push_back(config_of("-" + name, path.path, "configs." + name));
    if (!said_.config.empty() && !said_.configs.empty())
      faults_.add(out_.file, at_.at("configs"), "configs", "stands beside config: give one of them");
  }

  // What is wrong with a further option of sbatch; "": nothing. Short options may be several in one word, and long ones
  // may be cut short (getopt_long), so that "--arr=0-2" is an array as well.
  static std::string fault_of_option(const std::string& word) {
    if (word.rfind("--", 0) != 0 || word.size() < 3) return ", must be a long option: --qos=low, not -q low";
    const std::string name = word.substr(2, word.find('=') - 2);
    for (const std::string ours : {"account",    "array",         "chdir",       "cluster-constraint",
                                   "clusters",   "cpus-per-task", "dependency",  "help",
                                   "job-name",   "mem",           "mem-per-cpu", "mem-per-gpu",
                                   "no-requeue", "ntasks",        "open-mode",   "output",
                                   "parsable",   "partition",     "requeue",     "test-only",
                                   "time",       "usage",         "version",     "wait",
                                   "wrap"})
      if (ours.rfind(name, 0) == 0)
        return ", is what the build itself says to sbatch, by `classes`, `partition` and `account`";
    return "";
  }

  void read_engine() {
    out_.engine = said_.engine;
    auto& classes = out_.engine.classes;
    std::sort(classes.begin(), classes.end(), [](const auto& a, const auto& b) { return a.memory_mb < b.memory_mb; });
    // They would take what the build itself says to Slurm, or end up as a file's name.
    for (std::size_t i = 0; i < said_.engine.sbatch.size(); ++i) {
      const std::string& word = said_.engine.sbatch[i].text;
      const std::string where = "engine.sbatch[" + std::to_string(i) + "]";
      if (const std::string fault = fault_of_option(word); !fault.empty())
        faults_.add(out_.file, at_.at(where), where, word + fault);
    }
  }

  // path=value of each, as --set takes it, and where the file has it. A path in a value is relative to this file.
  struct Settings {
    std::vector<std::string> set;
    std::map<std::string, std::string> in_file;
  };
  Settings set_of(const Named<config::SaidValue>& values, const std::string& where) {
    Settings all;
    for (const auto& [path, value] : values) {
      const std::string one = where + "." + path;
      const bool is_file = names_file(path) && !value.text.empty();
      all.in_file[path] = place_of(at_.key(one));
      all.set.push_back(path + "=" + (is_file ? path_at(at_.at(one), one, value.text).string() : value.text));
    }
    return all;
  }

  // Adds the cases of one patient: a case of its own configuration, or of each configuration of the library.
  void add_cases(LibraryCase one, const OneConfig& own_config, const config::YamlNode& at, const std::string& where,
                 const Settings& own) {
    one.set = shared_set_.set;
    one.set.insert(one.set.end(), own.set.begin(), own.set.end());
    one.set.insert(one.set.end(), overrides_.set.begin(), overrides_.set.end());
    one.set_in_file = own.in_file;
    one.set_in_file.insert(shared_set_.in_file.begin(), shared_set_.in_file.end());
    for (const std::string& text : overrides_.set) one.set_in_file.erase(text.substr(0, text.find('=')));
    const std::vector<OneConfig> configs = own_config.file.empty() ? configs_ : std::vector<OneConfig>{own_config};
    if (configs.empty()) faults_.add(out_.file, at, where, "has no configuration: give config here or for the library");
    for (const OneConfig& config : configs) {
      one.suffix = config.suffix;
      one.config = config.file;
      one.config_at = config.at;
      if (!one.token.empty() && !tokens_.insert(one.token + one.suffix).second)
        faults_.add(out_.file, at, where, one.token + one.suffix + ", the case is there already");
      out_.cases.push_back(one);
      if (!one.token.empty()) out_.cases.back().token += one.suffix;
    }
  }

  void check_token(const std::string& where, const std::string& token) {
    if (token.empty()) return;
    try {
      cases::validate_case_token(token, ExitCode::bad_config);
    } catch (const Error& e) {
      faults_.add(out_.file, at_.at(where), where, e.what());
    }
  }

  void read_case(std::size_t i) {
    const std::string where = "cases[" + std::to_string(i) + "]";
    const config::YamlNode& node = at_.at(where);
    const LibraryCaseParams& said = said_.cases[i];
    LibraryCase one;
    one.token = one.origin = said.case_token;
    check_token(where + ".case", said.case_token);
    one.series = file_of(said.series);
    if (!said.series.empty()) one.series_at = place_of(at_.at(where + ".series"));
    one.landmarks = file_of(said.landmarks_file);
    add_cases(std::move(one), config_of("", said.config, where + ".config"), node, where,
              set_of(said.set, where + ".set"));
  }

  void find_series(std::size_t i) {
    const std::string where = "series[" + std::to_string(i) + "]", text = said_.series[i].text;
    const config::YamlNode& node = at_.at(where);
    const fs::path pattern(text);
    const std::string last = pattern.filename().string();
    if (text.empty() || pattern.parent_path().string().find_first_of("*?[") != std::string::npos || last.empty())
      return faults_.add(out_.file, node, "series",
                         text + ", each item is a folder's name, and only its last part may hold *");
    const fs::path folder = path_at(node, "series", pattern.parent_path().string() + "/.");
    if (folder.empty()) return;
    std::vector<fs::path> found;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
      std::error_code ignored;
      const bool fits = fnmatch(last.c_str(), it->path().filename().c_str(), FNM_PERIOD) == 0;
      if (fits && (it->is_directory(ignored) || it->path().extension() == ".zip")) found.push_back(it->path());
    }
    if (error)
      return faults_.add(Error(ExitCode::no_input, out_.file.string(), "series", text + ", " + error.message()));
    std::sort(found.begin(), found.end());
    for (std::size_t k = 0; k < found.size(); ++k) {
      LibraryCase one;
      one.origin = where + " folder " + std::to_string(k + 1);
      one.series = path_at(node, "series", found[k].string());
      add_cases(std::move(one), {}, node, "series", {});
    }
  }

  void read_phantoms() {
    for (std::size_t i = 0; i < said_.phantoms->list.size(); ++i) {
      const std::string where = "phantoms.list[" + std::to_string(i) + "]";
      const LibraryPhantomParams& said = said_.phantoms->list[i];
      check_token(where + ".name", said.name);
      AnyParams values = AnyParams::make<PhantomValues>(said);
      for (const std::string& text : overrides_.phantom) override_phantom(values, text);
      LibraryCase patient;
      patient.token = patient.origin = said.name;
      patient.phantom = static_cast<int>(out_.phantoms.size());
      out_.phantoms.push_back({said.name, values.as<PhantomValues>().params()});
      add_cases(std::move(patient), config_of("", said.config, where + ".config"), at_.at(where), where,
                set_of(said.set, where + ".set"));
    }
  }

  void override_phantom(AnyParams& values, const std::string& text) {
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    const Parameter* p = values.set->find(name);
    if (p && equals != std::string::npos) {
      config::YamlNode value;
      value.kind = config::YamlNode::Kind::scalar;
      value.text = text.substr(equals + 1);
      if (const std::string fault = config::set_parameter(values.object.get(), *p, value); !fault.empty())
        fault_once("--phantom " + name, fault);
      return;
    }
    fault_once("--phantom " + text, equals == std::string::npos ? "must be parameter=value"
                                                                : "no such parameter of a phantom" +
                                                                      config::did_you_mean(name, values.set->names()));
  }
  void fault_once(const std::string& field, const std::string& what) {
    if (said_once_.insert(field).second) faults_.add(Error(ExitCode::usage, "", field, what));
  }

  const LibraryOverrides& overrides_;
  const config::YamlNode tree_;
  config::Places at_;
  LibraryFileParams said_;
  std::vector<fs::path> roots_;
  config::ConfigFaults faults_;
  LibraryConfig out_;
  std::vector<OneConfig> configs_;
  Settings shared_set_;
  std::set<std::string> tokens_, said_once_;
};

}  // namespace

LibraryConfig read_library_config(const fs::path& file, const LibraryOverrides& overrides) {
  return Reader(file, overrides).read();
}

AnyParams library_file_params() { return AnyParams::make<LibraryFileParams>(); }

}  // namespace trephine::library

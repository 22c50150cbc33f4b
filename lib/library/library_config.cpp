// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/library_config.h"

#include <fnmatch.h>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "cases/case.h"
#include "pipeline/config_root.h"
#include "pipeline/yaml_document.h"
#include "stages/stage.h"

namespace trephine {
namespace fs = std::filesystem;
namespace {

// "anatomy.stage.parameter" whose value names a file.
bool names_file(const std::string& path) {
  const auto last = path.rfind('.');
  if (last == std::string::npos || last == 0) return false;
  const auto before = path.rfind('.', last - 1);
  const StageType* type = find_stage(path.substr(before == std::string::npos ? 0 : before + 1, last - before - 1));
  return type && std::find(type->file_params.begin(), type->file_params.end(), path.substr(last + 1)) !=
                     type->file_params.end();
}

struct PhantomSets {
  AnyParams head = AnyParams::make<phantom::HeadParams>(), scan = AnyParams::make<phantom::ScanParams>(),
            series = AnyParams::make<phantom::SeriesParams>(), truth = AnyParams::make<phantom::TruthParams>();
  PhantomSets() = default;
  explicit PhantomSets(const phantom::PhantomParams& p)
      : head(AnyParams::make(p.head)),
        scan(AnyParams::make(p.scan)),
        series(AnyParams::make(p.series)),
        truth(AnyParams::make(p.truth)) {}
  std::vector<AnyParams*> all() { return {&head, &scan, &series, &truth}; }
  phantom::PhantomParams params() const {
    return {head.as<phantom::HeadParams>(), scan.as<phantom::ScanParams>(), series.as<phantom::SeriesParams>(),
            truth.as<phantom::TruthParams>()};
  }
};

class Reader {
 public:
  Reader(const fs::path& file, const LibraryOverrides& overrides) : overrides_(overrides) {
    out_.file = file;
    out_.roots = overrides.roots;
    roots_.push_back(root_of(file));
    for (const fs::path& r : overrides.roots) roots_.push_back(absolute_path(r));
  }

  LibraryConfig read() {
    const YamlNode tree = read_yaml(out_.file);
    MapReader map(out_.file, tree, "", faults_);
    const YamlNode* version = map.any("trephine");
    if (!version || version->text != "1")
      map.fault(version ? *version : tree, "trephine", "must be 1, the version of the configuration's format");
    read_configs(map, tree);
    if (const YamlNode* set = map.map("set")) shared_set_ = set_of(*set, "set");
    if (const YamlNode* cases = map.list("cases"))
      for (std::size_t i = 0; i < cases->items.size(); ++i)
        read_case(cases->items[i], "cases[" + std::to_string(i) + "]");
    if (const YamlNode* series = map.list("series"))
      for (std::size_t i = 0; i < series->items.size(); ++i)
        find_series(series->items[i], "series[" + std::to_string(i) + "]");
    if (const YamlNode* phantoms = map.map("phantoms")) read_phantoms(*phantoms);
    map.finish();
    if (!tree.find("cases") && !tree.find("series") && !tree.find("phantoms"))
      map.fault(tree, "cases", "is missing, and so are series and phantoms: the library has no case");
    faults_.raise();
    return std::move(out_);
  }

 private:
  fs::path path_in_root(const YamlNode& at, const std::string& key, const std::string& text) {
    const fs::path path = absolute_path(fs::absolute(out_.file).parent_path() / text);
    if (std::any_of(roots_.begin(), roots_.end(), [&](const fs::path& root) { return lies_in(path, root); }))
      return path;
    faults_.add(out_.file, at, key, text + ", leads out of the root " + roots_[0].string() + "; --root adds one");
    return {};
  }
  fs::path path_value(MapReader& map, const YamlNode& node, const std::string& key) {
    const auto text = map.text(key);
    return text ? path_in_root(*node.find(key), map.path_of(key), *text) : fs::path();
  }

  void read_configs(MapReader& map, const YamlNode& tree) {
    if (const fs::path config = path_value(map, tree, "config"); !config.empty()) configs_.push_back({"", config});
    if (const YamlNode* several = map.map("configs"))
      for (const auto& [key, value] : several->entries) {
        const std::string where = "configs." + key.text;
        if (!is_plain_name(key.text)) faults_.add(out_.file, key, where, "a name has letters a-z, digits and _ only");
        if (value.kind != YamlNode::Kind::scalar)
          faults_.add(out_.file, value, where, "must be a file");
        else
          configs_.push_back({"-" + key.text, path_in_root(value, where, value.text)});
      }
    if (tree.find("config") && tree.find("configs"))
      faults_.add(out_.file, *tree.find("configs"), "configs", "stands beside config: give one of them");
  }

  // A word, or [words, in a list], as --set takes it.
  std::vector<std::string> set_of(const YamlNode& node, const std::string& where) {
    std::vector<std::string> all;
    for (const auto& [key, value] : node.entries) {
      std::string text = value.text;
      if (value.kind == YamlNode::Kind::list) {
        text = "[";
        for (const YamlNode& item : value.items) text += (text.size() > 1 ? ", " : "") + item.text;
        text += "]";
      } else if (value.kind != YamlNode::Kind::scalar) {
        faults_.add(out_.file, value, where + "." + key.text, "must be a value or a list of values");
      } else if (names_file(key.text) && !text.empty()) {
        text = path_in_root(value, where + "." + key.text, text).string();
      }
      all.push_back(key.text + "=" + text);
    }
    return all;
  }

  // The cases of one patient: of its own configuration, or of each of the library's.
  void add_cases(LibraryCase one, const fs::path& own_config, const YamlNode& at, const std::string& where,
                 const std::vector<std::string>& own_set) {
    one.set = shared_set_;
    one.set.insert(one.set.end(), own_set.begin(), own_set.end());
    one.set.insert(one.set.end(), overrides_.set.begin(), overrides_.set.end());
    std::vector<std::pair<std::string, fs::path>> configs = configs_;
    if (!own_config.empty()) configs = {{"", own_config}};
    if (configs.empty()) faults_.add(out_.file, at, where, "has no configuration: give config here or for the library");
    for (const auto& [suffix, config] : configs) {
      one.suffix = suffix;
      one.config = config;
      if (!one.token.empty() && !tokens_.insert(one.token + suffix).second)
        faults_.add(out_.file, at, where, one.token + suffix + ", the case is there already");
      out_.cases.push_back(one);
      if (!one.token.empty()) out_.cases.back().token += suffix;
    }
  }

  std::string token_value(MapReader& map, const YamlNode& node, const std::string& key) {
    const std::string token = map.required(map.text(key), key);
    if (node.find(key)) try {
        validate_case_token(token, ExitCode::bad_config);
      } catch (const Error& e) {
        map.fault(*node.find(key), key, e.what());
      }
    return token;
  }

  void read_case(const YamlNode& node, const std::string& where) {
    if (node.kind != YamlNode::Kind::map) return faults_.add(out_.file, node, where, "must hold keys and values");
    MapReader map(out_.file, node, where, faults_);
    LibraryCase one;
    one.token = token_value(map, node, "case");
    one.origin = one.token;
    one.series = path_value(map, node, "series");
    one.landmarks = path_value(map, node, "landmarks_file");
    const fs::path config = path_value(map, node, "config");
    std::vector<std::string> set;
    if (const YamlNode* own = map.map("set")) set = set_of(*own, map.path_of("set"));
    map.finish();
    add_cases(std::move(one), config, node, where, set);
  }

  void find_series(const YamlNode& node, const std::string& where) {
    if (node.kind != YamlNode::Kind::scalar || node.text.empty())
      return faults_.add(out_.file, node, "series", "each item is a folder's name, in which * stands for any letters");
    const fs::path pattern(node.text);
    const std::string last = pattern.filename().string();
    if (pattern.parent_path().string().find_first_of("*?[") != std::string::npos || last.empty())
      return faults_.add(out_.file, node, "series", node.text + ", only the last part may hold *");
    const fs::path folder = path_in_root(node, "series", pattern.parent_path().string() + "/.");
    if (folder.empty()) return;
    std::vector<fs::path> found;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
      std::error_code ignored;
      const bool fits = fnmatch(last.c_str(), it->path().filename().c_str(), FNM_PERIOD) == 0;
      if (fits && (it->is_directory(ignored) || it->path().extension() == ".zip")) found.push_back(it->path());
    }
    if (error)
      return faults_.add(Error(ExitCode::no_input, out_.file.string(), "series", node.text + ", " + error.message()));
    std::sort(found.begin(), found.end());
    for (std::size_t i = 0; i < found.size(); ++i) {
      LibraryCase one;
      one.origin = where + " folder " + std::to_string(i + 1);
      one.series = path_in_root(node, "series", found[i].string());
      add_cases(std::move(one), {}, node, "series", {});
    }
  }

  void read_phantoms(const YamlNode& node) {
    MapReader map(out_.file, node, "phantoms", faults_);
    PhantomSets shared;
    if (const YamlNode* body = map.map("shared")) {
      MapReader params(out_.file, *body, "phantoms.shared", faults_);
      for (AnyParams* set : shared.all()) params.parameters(*set);
      params.finish();
    }
    if (const YamlNode* list = map.list("list"))
      for (std::size_t i = 0; i < list->items.size(); ++i)
        read_phantom(list->items[i], "phantoms.list[" + std::to_string(i) + "]", shared.params());
    if (!node.find("list")) map.fault(node, "list", "is missing");
    map.finish();
  }

  void read_phantom(const YamlNode& node, const std::string& where, const phantom::PhantomParams& shared) {
    if (node.kind != YamlNode::Kind::map) return faults_.add(out_.file, node, where, "must hold keys and values");
    MapReader map(out_.file, node, where, faults_);
    LibraryPhantom one;
    one.name = token_value(map, node, "name");
    PhantomSets sets(shared);
    for (AnyParams* set : sets.all()) map.parameters(*set);
    const fs::path config = path_value(map, node, "config");
    std::vector<std::string> set;
    if (const YamlNode* own = map.map("set")) set = set_of(*own, map.path_of("set"));
    map.finish();
    for (const std::string& text : overrides_.phantom) override_phantom(sets, text);
    one.params = sets.params();
    LibraryCase patient;
    patient.token = patient.origin = one.name;
    patient.phantom = static_cast<int>(out_.phantoms.size());
    out_.phantoms.push_back(std::move(one));
    add_cases(std::move(patient), config, node, where, set);
  }

  void override_phantom(PhantomSets& sets, const std::string& text) {
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    std::vector<std::string> known;
    for (AnyParams* set : sets.all()) {
      for (const std::string& n : set->set->names()) known.push_back(n);
      const Parameter* p = set->set->find(name);
      if (!p || equals == std::string::npos) continue;
      YamlNode value;
      value.kind = YamlNode::Kind::scalar;
      value.text = text.substr(equals + 1);
      const std::string fault = set_parameter(*set, *p, value);
      if (!fault.empty()) fault_once("--phantom " + name, fault);
      return;
    }
    const std::string near = nearest_name(name, known);
    fault_once("--phantom " + text, equals == std::string::npos ? "must be parameter=value"
                                    : near.empty()              ? "no such parameter of a phantom"
                                                                : "no such parameter, did you mean " + near + "?");
  }
  void fault_once(const std::string& field, const std::string& what) {
    if (said_.insert(field).second) faults_.add(Error(ExitCode::usage, "", field, what));
  }

  const LibraryOverrides& overrides_;
  std::vector<fs::path> roots_;
  ConfigFaults faults_;
  LibraryConfig out_;
  std::vector<std::pair<std::string, fs::path>> configs_;  // suffix, file
  std::vector<std::string> shared_set_;
  std::set<std::string> tokens_, said_;
};

}  // namespace

LibraryConfig read_library_config(const fs::path& file, const LibraryOverrides& overrides) {
  return Reader(file, overrides).read();
}

}  // namespace trephine

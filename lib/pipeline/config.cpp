// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/config.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/text.h"
#include "pipeline/config_haptic.h"
#include "pipeline/config_head.h"
#include "pipeline/config_paths.h"
#include "pipeline/config_root.h"
#include "pipeline/yaml_document.h"

namespace trephine {
namespace fs = std::filesystem;
namespace {

// Reads the three files of a case; every method adds its faults and goes on.
class Reader {
 public:
  Reader(const fs::path& config, const ConfigOverrides& overrides) : config_(config), overrides_(overrides) {
    roots_.push_back(root_of(config));
    for (const fs::path& r : overrides.roots) roots_.push_back(absolute_path(r));
  }

  CaseConfig read() {
    const YamlNode tree = read_yaml(config_);
    MapReader map(config_, tree, "", faults_);
    check_version(map, tree);
    out_.case_token = map.text("case").value_or("");
    if (!overrides_.case_token.empty()) out_.case_token = overrides_.case_token;
    if (!out_.case_token.empty()) try {
        validate_case_token(out_.case_token, ExitCode::bad_config);
      } catch (const Error& e) {
        const YamlNode* at = tree.find("case");
        faults_.add(config_, at ? *at : tree, "case", e.what());
      }
    out_.series = path_value(map, config_, "series", tree);
    if (!overrides_.series.empty()) out_.series = overrides_.series;
    const fs::path pipeline = required_file(map, "pipeline", tree), scene = required_file(map, "scene", tree);
    if (const YamlNode* node = map.map("import")) read_params(config_, *node, "import", import_, {}, nullptr);
    if (const YamlNode* node = map.map("landmarks")) read_given_landmarks(config_, *node, out_, faults_);
    if (const fs::path points = path_value(map, config_, "landmarks_file", tree); !points.empty())
      read_points(points, false);
    if (!overrides_.landmarks.empty()) read_points(overrides_.landmarks, true);
    const YamlNode* burr_holes = map.list("burr_holes");
    const YamlNode* set = map.map("set");
    const TradeRule rule = read_rule(map);
    const std::vector<fs::path> fronts = path_values(map, config_, "trade");
    map.finish();
    if (!pipeline.empty()) read_recipe(pipeline);
    if (!scene.empty()) read_scene(scene);
    if (burr_holes) read_burr_holes(config_, *burr_holes, out_, faults_);
    choose_point(map, tree, rule, fronts);
    if (set)
      for (const auto& [key, value] : set->entries)
        if (const std::string fault = paths_.set(key.text, value, absolute_path(config_).parent_path()); !fault.empty())
          faults_.add(config_, paths_.has(key.text) ? value : key, "set." + key.text, fault);
    for (const std::string& text : overrides_.set) paths_.set_from_text(text, faults_);
    for (RecipeAnatomy& anatomy : out_.anatomies)
      for (RecipeStep& step : anatomy.steps) resolve_files(anatomy.name, step);
    limit_triangles();
    // Last, for what smoothing takes of it may just have been set.
    for (const Budget& budget : budgets_) give(budget);
    keep_rule();
    check_burr_holes(config_, tree, out_, faults_);
    drop_unused_landmarks(points_, out_);
    for (const SceneDrill& drilled : out_.drilled) leave_room(drilled);
    out_.import = import_.as<ImportParams>();
    faults_.raise();
    return std::move(out_);
  }

 private:
  // The deviation that the scene allows an anatomy, and where it says so.
  struct Budget {
    fs::path file;
    YamlNode at;
    std::string anatomy;
    double allowed_mm;
  };

  void check_version(MapReader& map, const YamlNode& tree) {
    const YamlNode* node = map.any("trephine");
    if (!node || node->text != "1")
      map.fault(node ? *node : tree, "trephine", "must be 1, the version of the configuration's format");
  }

  fs::path path_value(MapReader& map, const fs::path& file, const std::string& key, const YamlNode& tree) {
    const auto text = map.text(key);
    return text ? path_of(map, file, key, *tree.find(key), *text) : fs::path();
  }

  // A path, or a list of them.
  std::vector<fs::path> path_values(MapReader& map, const fs::path& file, const std::string& key) {
    const YamlNode* node = map.any(key);
    if (!node) return {};
    if (node->kind == YamlNode::Kind::scalar) return {path_of(map, file, key, *node, node->text)};
    std::vector<fs::path> paths;
    for (const YamlNode& item : node->items)
      if (item.kind == YamlNode::Kind::scalar)
        paths.push_back(path_of(map, file, key, item, item.text));
      else
        map.fault(item, key, "must be a path, or a list of paths");
    if (paths.empty()) map.fault(*node, key, "must be a path, or a list of paths");
    return paths;
  }

  fs::path path_of(MapReader& map, const fs::path& file, const std::string& key, const YamlNode& at,
                   const std::string& text) {
    const fs::path path = absolute_path(fs::absolute(file).parent_path() / text);
    const bool allowed =
        std::any_of(roots_.begin(), roots_.end(), [&](const fs::path& root) { return lies_in(path, root); });
    if (allowed) return path;
    map.fault(at, key, text + ", leads out of the root " + roots_[0].string() + "; --root adds one");
    return {};
  }

  fs::path required_file(MapReader& map, const std::string& key, const YamlNode& tree) {
    const fs::path path = path_value(map, config_, key, tree);
    if (!tree.find(key)) map.fault(tree, key, "is missing");
    return path;
  }

  // What the case asks of the front; --profile stands for all of it.
  TradeRule read_rule(MapReader& map) {
    TradeRule rule;
    const auto read = [&](const char* group, const std::vector<std::pair<const char*, double*>>& members) {
      const YamlNode* node = map.map(group);
      if (!node) return;
      MapReader body(config_, *node, group, faults_);
      for (const auto& [name, value] : members) *value = body.number(name, {1e-3, 1e12}).value_or(0);
      if (node->entries.empty()) body.fault(*node, group, "asks for nothing");
      body.finish();
    };
    double triangles = 0, bytes = 0;
    read("accuracy", {{"max_deviation_mm", &rule.max_deviation_mm},
                      {"p99_deviation_mm", &rule.p99_deviation_mm},
                      {"rms_deviation_mm", &rule.rms_deviation_mm}});
    read("budget", {{"seconds", &rule.seconds}, {"triangles", &triangles}, {"bytes", &bytes}});
    rule.triangles_count = static_cast<std::int64_t>(triangles);
    rule.bytes = static_cast<std::int64_t>(bytes);
    const bool asked = !rule.empty();
    rule.profile = map.text("profile").value_or("");
    if (asked && !rule.profile.empty())
      map.fault(*map.any("profile"), "profile", "is a rule of its own, and there are accuracy or budget already");
    if (overrides_.profile.empty()) return rule;
    rule = {};
    rule.profile = overrides_.profile;
    return rule;
  }

  void choose_point(MapReader& map, const YamlNode& tree, const TradeRule& rule, const std::vector<fs::path>& files) {
    if (rule.empty() || overrides_.without_rule) return;
    if (!tree.find("trade"))
      map.fault(tree, "trade", "is missing: which trade.json shall " + rule.text() + " be chosen from?");
    if (files.empty() || std::any_of(files.begin(), files.end(), [](const fs::path& f) { return f.empty(); })) return;
    std::vector<std::vector<TradePoint>> fronts;
    for (const fs::path& file : files) try {
        fronts.push_back(read_trade_points(file));
      } catch (const Error& e) {
        faults_.add(Error(e.code(), file.string(), e.field(), e.what()));
        return;
      }
    out_.trade.rule = rule;
    out_.trade.fronts = files;
    try {
      out_.trade.choice = choose(points_of_all(fronts), rule);
    } catch (const Error& e) {
      faults_.add(Error(e.code(), files.size() == 1 ? files[0].string() : config_.string(), e.field(), e.what()));
      return;
    }
    for (const std::string& text : out_.trade.choice.point.settings) paths_.set_from_text(text, faults_);
  }

  void read_points(const fs::path& file, bool wins) {
    try {
      for (std::string& name : read_landmarks_file(file, wins, out_)) points_.push_back(std::move(name));
    } catch (const Error& e) {
      faults_.add(e);
    }
  }

  // A file is meant relative to the one that names it; from the command line, to where the command is given.
  void resolve_files(const std::string& anatomy, RecipeStep& step) {
    for (const std::string& name : step.type->file_params) {
      const Parameter& p = *step.params.set->find(name);
      const std::string text = std::get<std::string>(step.params.get(p));
      if (text.empty()) continue;
      const std::string path = anatomy + "." + step.type->name + "." + name;
      const fs::path folder = paths_.set_in(path).value_or(recipe_.parent_path());
      const fs::path file = absolute_path(fs::absolute(folder) / text);
      if (!folder.empty() &&
          std::none_of(roots_.begin(), roots_.end(), [&](const fs::path& root) { return lies_in(file, root); }))
        faults_.add(Error(ExitCode::bad_config, "", path,
                          text + ", leads out of the root " + roots_[0].string() + "; --root adds one"));
      p.set(step.params.object.get(), file.string());
    }
  }

  // Parameters of one stage, and its ports where it has any.
  void read_params(const fs::path& file, const YamlNode& node, const std::string& where, AnyParams& params,
                   const std::vector<Port>& ports, std::map<std::string, std::string>* sources) {
    MapReader map(file, node, where, faults_);
    map.parameters(params);
    for (const Port& port : ports)
      if (const auto source = map.text(port.name)) (*sources)[port.name] = *source;
    map.finish();
  }

  void read_recipe(const fs::path& file) {
    const auto read = read_yaml_or_fault(file, faults_);
    if (!read) return;
    const YamlNode& tree = *read;
    MapReader map(file, tree, "", faults_);
    check_version(map, tree);
    const YamlNode* anatomies = map.map("anatomies");
    if (!tree.find("anatomies")) map.fault(tree, "anatomies", "is missing");
    std::map<std::string, const YamlNode*> head;
    for (const char* stage : {resample_step, landmarks_step, deface_step, anatomy_step})
      if (const YamlNode* node = map.map(stage)) head[stage] = node;
    map.finish();
    if (!anatomies) return;
    recipe_ = file;
    for (const auto& [key, node] : anatomies->entries) {
      const std::string where = "anatomies." + key.text;
      RecipeAnatomy anatomy;
      anatomy.name = key.text;
      if (!is_plain_name(key.text)) faults_.add(file, key, where, "a name has letters a-z, digits and _ only");
      if (node.kind != YamlNode::Kind::map) {
        faults_.add(file, node, where, "must hold keys and values");
        continue;
      }
      MapReader body(file, node, where, faults_);
      if (const auto rgb = body.numbers("colour_rgb", 3, {0, 1}))
        anatomy.colour_rgb = {(*rgb)[0], (*rgb)[1], (*rgb)[2]};
      anatomy.opacity_ratio = body.number("opacity_ratio", {0.05, 1}).value_or(anatomy.opacity_ratio);
      // Without a default: a recipe that forgets it must not publish a face.
      const auto face = body.required(body.text("shows_face"), "shows_face");
      if (!face.empty() && face != "true" && face != "false")
        body.fault(*node.find("shows_face"), "shows_face", face + ", must be true or false");
      anatomy.shows_face = face != "false";
      if (const YamlNode* steps = body.list("stages")) read_steps(file, *steps, where, anatomy);
      if (!node.find("stages")) body.fault(node, "stages", "is missing");
      body.finish();
      out_.anatomies.push_back(std::move(anatomy));
    }
    check_ports(file, *anatomies);
    for (const char* stage : {resample_step, landmarks_step, deface_step, anatomy_step})
      if (head.count(stage)) read_head_step(file, stage, *head[stage], out_, faults_);
    // Any scan can be resampled: the path is there whether the recipe names it or not.
    YamlNode nothing;
    nothing.kind = YamlNode::Kind::map;
    if (!head.count(resample_step)) read_head_step(file, resample_step, nothing, out_, faults_);
  }

  // A step is `- name` or `- name: {parameters and ports}`.
  void read_steps(const fs::path& file, const YamlNode& list, const std::string& where, RecipeAnatomy& anatomy) {
    for (const YamlNode& item : list.items) {
      const bool bare = item.kind == YamlNode::Kind::scalar;
      if (!bare && !(item.kind == YamlNode::Kind::map && item.entries.size() == 1)) {
        faults_.add(file, item, where + ".stages", "each item is a stage: `- name` or `- name: {...}`");
        continue;
      }
      const YamlNode& name = bare ? item : item.entries[0].first;
      RecipeStep step;
      step.type = find_stage(name.text);
      if (!step.type || step.type->output == DataKind::nothing) {
        std::vector<std::string> known;
        for (const StageType& t : stage_types())
          if (t.output != DataKind::nothing) known.push_back(t.name);
        const std::string near = nearest_name(name.text, known);
        faults_.add(file, name, where + ".stages",
                    name.text + ", no such stage" + (near.empty() ? "" : ", did you mean " + near + "?"));
        continue;
      }
      if (anatomy.find_step(name.text))
        faults_.add(file, name, where + ".stages", name.text + ", the stage is repeated");
      step.params = step.type->make_params();
      const std::string step_where = where + "." + name.text;
      std::vector<Port> ports(step.type->ports.begin() + 1, step.type->ports.end());
      if (!bare && item.entries[0].second.kind == YamlNode::Kind::map)
        read_params(file, item.entries[0].second, step_where, step.params, ports, &step.ports);
      else if (!bare && item.entries[0].second.kind != YamlNode::Kind::null)
        faults_.add(file, item.entries[0].second, step_where, "must hold keys and values");
      const DataKind fed = anatomy.steps.empty() ? DataKind::volume : anatomy.steps.back().type->output;
      if (step.type->ports[0].kind != fed && !(step.type->ports[0].kind == DataKind::field && fed == DataKind::volume))
        faults_.add(file, name, step_where,
                    std::string("works on a ") + to_text(step.type->ports[0].kind) + " but gets a " + to_text(fed));
      anatomy.steps.push_back(std::move(step));
    }
    if (anatomy.steps.empty() || anatomy.steps.back().type->output != DataKind::mesh)
      faults_.add(file, list, where + ".stages", "must end in a surface");
  }

  // A port may only be fed from an anatomy that stands before it: so there are no cycles.
  void check_ports(const fs::path& file, const YamlNode& anatomies) {
    for (std::size_t i = 0; i < out_.anatomies.size(); ++i)
      for (const RecipeStep& step : out_.anatomies[i].steps)
        for (const Port& port : step.type->ports) {
          const auto source = step.ports.find(port.name);
          const YamlNode* at = anatomies.find(out_.anatomies[i].name);
          const std::string where = "anatomies." + out_.anatomies[i].name + "." + step.type->name + "." + port.name;
          if (source == step.ports.end()) {
            if (port.required && &port != &step.type->ports[0])
              faults_.add(file, *at, where, "is missing: " + port.help);
            continue;
          }
          bool found = false;
          for (std::size_t j = 0; j < i; ++j)
            for (const RecipeStep& other : out_.anatomies[j].steps)
              if (out_.anatomies[j].name + "." + other.type->name == source->second && other.type->output == port.kind)
                found = true;
          if (!found)
            faults_.add(
                file, *at, where,
                source->second + ", must be the " + to_text(port.kind) +
                    " of an anatomy before this one, as anatomy.stage" +
                    hint_of_source(source->second, port.kind, {out_.anatomies.begin(), out_.anatomies.begin() + i}));
        }
  }

  void read_scene(const fs::path& file) {
    const auto read = read_yaml_or_fault(file, faults_);
    // Without a recipe nobody knows which anatomies there are: what the scene says of them is not judged.
    if (!read || out_.anatomies.empty()) return;
    const YamlNode& tree = *read;
    MapReader map(file, tree, "", faults_);
    check_version(map, tree);
    if (const YamlNode* face = map.any("face"); face && face->kind == YamlNode::Kind::scalar)
      map.fault(*face, "face",
                face->text +
                    ", must hold keys and values: {policy: crop}, {policy: deface} or {policy: "
                    "keep, reason: ...}");
    else if (map.map("face"))
      read_face_policy(file, *face, out_, faults_);
    if (const YamlNode* landmarks = map.map("landmarks")) read_scene_landmarks(file, *landmarks, out_, faults_);
    std::vector<std::string> known;
    for (const RecipeAnatomy& a : out_.anatomies) known.push_back(a.name);
    const YamlNode* anatomies = map.map("anatomies");
    if (!tree.find("anatomies")) map.fault(tree, "anatomies", "is missing");
    std::map<std::string, SceneAnatomy> wanted;
    if (anatomies)
      for (const auto& [key, node] : anatomies->entries) {
        SceneAnatomy a;
        a.name = key.text;
        if (std::find(known.begin(), known.end(), key.text) == known.end()) {
          const std::string near = nearest_name(key.text, known);
          map.fault(key, "anatomies." + key.text,
                    "the pipeline has no such anatomy" + (near.empty() ? "" : ", did you mean " + near + "?"));
          continue;
        }
        if (node.kind == YamlNode::Kind::map) {
          MapReader body(file, node, "anatomies." + key.text, faults_);
          a.max_deviation_mm = body.number("max_deviation_mm", {0.01, 100}).value_or(0);
          a.max_triangles = body.integer("max_triangles", {4, 1e8}).value_or(0);
          body.finish();
        } else if (node.kind != YamlNode::Kind::null) {
          map.fault(node, "anatomies." + key.text, "must hold keys and values");
        }
        wanted[a.name] = a;
      }
    read_scene_haptic(file, map, tree);
    map.finish();
    // In the recipe's order, so that the scene's order changes no byte of the case.
    for (RecipeAnatomy& anatomy : out_.anatomies) {
      const auto found = wanted.find(anatomy.name);
      if (found == wanted.end()) continue;
      out_.scene.push_back(found->second);
      if (found->second.max_deviation_mm > 0)
        budgets_.push_back({file, *anatomies->find(anatomy.name), anatomy.name, found->second.max_deviation_mm});
    }
    if (out_.scene.empty() && faults_.empty()) map.fault(tree, "anatomies", "the scene wants nothing");
    for (const SceneDrill& d : out_.drilled)
      if (!wanted.count(d.anatomy) && std::none_of(out_.haptic.shapes.begin(), out_.haptic.shapes.end(),
                                                   [&](const SceneShape& s) { return s.name == d.anatomy; }))
        map.fault(*tree.find("burr_holes"), "burr_holes." + d.anatomy, "the scene neither shows nor feels it");
  }

  void read_scene_haptic(const fs::path& file, MapReader& map, const YamlNode& tree) {
    if (const YamlNode* drilled = map.map("burr_holes")) read_drilled(file, *drilled, out_, faults_);
    const fs::path materials = path_value(map, file, "materials", tree);
    const YamlNode* haptic = map.map("haptic");
    if (!haptic) return;
    if (!tree.find("materials")) map.fault(*haptic, "haptic", "needs materials: FILE beside it");
    const auto known = materials.empty() ? std::vector<CaseMaterial>{} : read_materials(materials, faults_);
    read_haptic_scene(file, *haptic, known, out_, faults_);
  }

  // What the scene allows, for this case's machine.
  void limit_triangles() {
    const double ratio = out_.scene_params.as<SceneParams>().triangles_ratio;
    for (SceneAnatomy& wanted : out_.scene) {
      if (wanted.max_triangles == 0) continue;
      wanted.max_triangles = std::max<std::int64_t>(4, std::llround(double(wanted.max_triangles) * ratio));
      head_for(wanted.name, wanted.max_triangles);
    }
  }

  // Decimation's count, unless it was given its own by path.
  void head_for(const std::string& name, std::int64_t triangles) {
    if (!paths_.was_set(name + ".decimate.target_triangles_count"))
      set_if_there(anatomy(name), "decimate", "target_triangles_count", ParameterValue(triangles));
  }

  RecipeAnatomy& anatomy(const std::string& name) {
    return *std::find_if(out_.anatomies.begin(), out_.anatomies.end(),
                         [&](const RecipeAnatomy& a) { return a.name == name; });
  }

  // The deviation that the scene allows is shared out: smoothing keeps its bound, decimation gets the rest, unless it
  // was given its own by path.
  void give(const Budget& budget) {
    if (paths_.was_set(budget.anatomy + ".decimate.max_deviation_mm")) return;
    RecipeAnatomy& own = anatomy(budget.anatomy);
    const double rest_mm = budget.allowed_mm - smoothing_mm(own);
    if (rest_mm > 0) return set_if_there(own, "decimate", "max_deviation_mm", ParameterValue(rest_mm));
    faults_.add(budget.file, budget.at, "anatomies." + own.name + ".max_deviation_mm",
                to_text(budget.allowed_mm) + ", must exceed what smooth may move the surface by, " +
                    to_text(budget.allowed_mm - rest_mm));
  }

  // Whatever the chosen point's settings did to the head that it was measured on: here the rule holds by construction
  // as far as decimation and smoothing go, and what is measured is held against it.
  void keep_rule() {
    const double limit_mm = out_.trade.rule.max_deviation_mm;
    if (limit_mm <= 0) return;
    for (SceneAnatomy& wanted : out_.scene) {
      if (wanted.max_deviation_mm <= 0 || wanted.max_deviation_mm > limit_mm) wanted.max_deviation_mm = limit_mm;
      RecipeAnatomy& own = anatomy(wanted.name);
      const double rest_mm = limit_mm - smoothing_mm(own);
      if (rest_mm <= 0)
        faults_.add(Error(ExitCode::bad_config, config_.string(), "accuracy.max_deviation_mm",
                          to_text(ParameterValue(limit_mm)) + ", must exceed what smooth may move " + own.name +
                              " by, " + to_text(ParameterValue(limit_mm - rest_mm))));
      else if (const RecipeStep* decimate = own.find_step("decimate"))
        if (const double now = std::get<double>(decimate->params.get(*decimate->params.set->find("max_deviation_mm")));
            now == 0 || now > rest_mm)
          set_if_there(own, "decimate", "max_deviation_mm", ParameterValue(rest_mm));
    }
  }

  static double smoothing_mm(const RecipeAnatomy& anatomy) {
    const RecipeStep* smooth = anatomy.find_step("smooth");
    const Parameter* p = smooth ? smooth->params.set->find("max_displacement_mm") : nullptr;
    return p ? std::get<double>(smooth->params.get(*p)) : 0;
  }

  // The wall of a burr hole is triangles too, and they count against the scene's limit.
  void leave_room(const SceneDrill& drilled) {
    constexpr std::int64_t triangles_a_hole = 4000;
    const auto holes = static_cast<std::int64_t>(out_.burr_holes.size());
    for (const SceneAnatomy& limit : out_.scene)
      if (limit.name == drilled.anatomy && limit.max_triangles > 0)
        head_for(limit.name, std::max(limit.max_triangles - triangles_a_hole * holes, limit.max_triangles / 2));
  }

  static void set_if_there(RecipeAnatomy& anatomy, const std::string& stage, const std::string& name,
                           const ParameterValue& value) {
    for (RecipeStep& step : anatomy.steps)
      if (step.type->name == stage)
        if (const Parameter* p = step.params.set->find(name)) p->set(step.params.object.get(), value);
  }

  const fs::path config_;
  const ConfigOverrides& overrides_;
  std::vector<fs::path> roots_;
  ConfigFaults faults_;
  CaseConfig out_;
  AnyParams import_ = AnyParams::make<ImportParams>();
  std::vector<Budget> budgets_;
  ConfigPaths paths_{out_, import_};
  fs::path recipe_;
  std::vector<std::string> points_;  // names that a file of landmarks holds
};

}  // namespace

std::string CaseTrade::front_names() const {
  std::string names;
  for (const fs::path& file : fronts) names += (names.empty() ? "" : ", ") + file.filename().string();
  return names;
}

const RecipeStep* RecipeAnatomy::find_step(const std::string& stage) const {
  for (const RecipeStep& s : steps)
    if (s.type->name == stage) return &s;
  return nullptr;
}

const RecipeAnatomy* CaseConfig::find_anatomy(const std::string& name) const {
  for (const RecipeAnatomy& a : anatomies)
    if (a.name == name) return &a;
  return nullptr;
}

const RecipeStep* CaseConfig::find_head_step(const std::string& stage) const {
  for (const RecipeStep& s : head)
    if (s.type->name == stage) return &s;
  return nullptr;
}

bool CaseConfig::is_shown(const std::string& anatomy) const {
  return std::any_of(scene.begin(), scene.end(), [&](const SceneAnatomy& a) { return a.name == anatomy; }) ||
         std::any_of(haptic.shapes.begin(), haptic.shapes.end(),
                     [&](const SceneShape& s) { return s.name == anatomy; });
}

std::map<std::string, Vec3> CaseConfig::landmark_positions_mm() const {
  std::map<std::string, Vec3> all;
  for (const CaseLandmark& l : landmarks) all[l.name] = l.position_mm;
  return all;
}

CaseConfig read_case_config(const fs::path& file, const ConfigOverrides& overrides) {
  return Reader(file, overrides).read();
}

}  // namespace trephine

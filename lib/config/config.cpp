// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/config.h"

#include <algorithm>
#include <set>

#include "base/joined.h"
#include "base/log.h"
#include "base/text.h"
#include "config/config_root.h"
#include "config/reading.h"
#include "stages/data_files.h"

namespace trephine::config {
namespace fs = std::filesystem;
namespace {

// Reads the files of a case. Every method adds the faults that it finds and goes on.
class Reader {
 public:
  Reader(const fs::path& config, const ConfigOverrides& overrides) : r_(config, overrides), tree_(read_yaml(config)) {}

  CaseConfig read() {
    at_ = read_declared(reading(), tree_, parameters_of<CaseFileParams>(), said_.object.get());
    const CaseFileParams& said = said_.as<CaseFileParams>();
    CaseConfig& out = r_.out;
    out.case_token = r_.overrides.case_token.empty() ? said.case_token : r_.overrides.case_token;
    check_token();
    out.series = r_.overrides.series.empty() ? file_of(said.series) : r_.overrides.series;
    for (const auto& [name, p] : said.landmarks) {
      out.landmarks.push_back({name, {p.position_mm[0], p.position_mm[1], p.position_mm[2]}, 1, "given"});
      r_.landmark_origins[name] = r_.origin(ValueSource::set, r_.file, at_.at("landmarks." + name));
    }
    if (!said.landmarks_file.empty()) read_points(file_of(said.landmarks_file), false);
    if (!r_.overrides.landmarks.empty()) read_points(r_.overrides.landmarks, true);
    if (const fs::path file = file_of(said.pipeline); !file.empty()) read_recipe(r_, file);
    std::vector<std::string> set;
    for (const auto& [path, value] : said.set) set.push_back(path);
    for (const std::string& text : r_.overrides.set) set.push_back(text.substr(0, text.find('=')));
    add_corrections(r_, said.corrections, set, [this](const std::string& where, const std::string& what) {
      r_.faults.add(r_.file, at_.key(where), where, what);
    });
    add_scans(r_, said.scans, [this](const std::string& where, const std::string& what) {
      r_.faults.add(r_.file, at_.key(where), where, what);
    });
    if (const fs::path file = file_of(said.scene); !file.empty()) read_scene(r_, file);
    import_ = AnyParams::make(said.import);
    name_burr_holes();
    collect_values();
    choose_point();
    set_values();
    check_set_values();
    resolve_files();
    derive_scene(r_);
    check_burr_holes();
    // This comes last: the part of the scene's deviation that smoothing takes may just have been set.
    share_out_limits(r_);
    drop_unused_landmarks();
    add_given_landmarks(r_);
    out.import = import_.as<dicom::ImportParams>();
    r_.faults.raise();
    out.values = r_.values.rows();
    return std::move(out);
  }

 private:
  DeclaredReading reading() {
    DeclaredReading all{r_.file, r_.faults, {}, {}};
    all.fault_of_name = [this](const std::string& kind, const std::string& name) {
      std::string fault;
      if (kind == "file") r_.in_root(r_.file, name, fault);
      return fault;
    };
    all.said = [this](const std::string& path, const YamlNode& at) {
      if (path.rfind("set.", 0) == 0) set_.insert(path);
      if (path.rfind("corrections.", 0) == 0)
        r_.said.emplace_back(path.substr(12) + ".correct.file", r_.origin(ValueSource::set, r_.file, at));
      if (path.rfind("scans.", 0) == 0) r_.said.emplace_back(path.substr(6), r_.origin(ValueSource::set, r_.file, at));
      if (path.rfind("import.", 0) == 0 || path.rfind("burr_holes[", 0) == 0)
        r_.said.emplace_back(path, r_.origin(ValueSource::set, r_.file, at));
    };
    return all;
  }
  // Faults of the path have been reported already.
  fs::path file_of(const std::string& text) const {
    std::string ignored;
    return text.empty() ? fs::path() : r_.in_root(r_.file, text, ignored);
  }
  void fault(const char* key, const std::string& where, const std::string& what) {
    r_.faults.add(r_.file, at_.at(key), where, what);
  }

  void check_token() {
    if (r_.out.case_token.empty()) return;
    try {
      cases::validate_case_token(r_.out.case_token, ExitCode::bad_config);
    } catch (const Error& e) {
      fault("case", "case", e.what());
    }
  }

  // Reads points of 3D Slicer or landmarks of ours. Where `wins` is set, they replace points of the same name that are
  // known already.
  void read_points(const fs::path& file, bool wins) {
    if (file.empty()) return;
    try {
      const auto read =
          std::get<std::shared_ptr<const head::HeadLandmarks>>(stages::load_data(file, stages::DataKind::landmarks));
      std::vector<cases::CaseLandmark>& all = r_.out.landmarks;
      for (const cases::CaseLandmark& point : read->landmarks) {
        points_.push_back(point.name);
        const auto known =
            std::find_if(all.begin(), all.end(), [&](const cases::CaseLandmark& l) { return l.name == point.name; });
        if (known == all.end())
          all.push_back(point);
        else if (wins)
          *known = point;
        else
          throw Error(ExitCode::bad_config, file.string(), "landmarks." + point.name,
                      "is given here and in the configuration, which is meant?");
        r_.landmark_origins[point.name] = {wins ? ValueSource::command_line : ValueSource::set, file.string(), {}};
      }
    } catch (const Error& e) {
      r_.faults.add(e);
    }
  }

  void name_burr_holes() {
    std::vector<boolean::BurrHoleParams> holes = said_.as<CaseFileParams>().burr_holes;
    for (std::size_t i = 0; i < holes.size(); ++i) {
      boolean::BurrHoleParams& hole = holes[i];
      if (hole.name.empty()) hole.name = "burr_hole_" + std::to_string(i + 1);
      const auto same = [&](const CaseDrill& d) { return d.name == hole.name; };
      if (!is_plain_name(hole.name) || std::any_of(r_.out.burr_holes.begin(), r_.out.burr_holes.end(), same))
        fault("burr_holes", "burr_holes[" + std::to_string(i) + "].name",
              printable(hole.name) + ", must be a name of its own, of letters a-z, digits and _");
      else if (stages::find_stage(hole.name) || r_.out.find_anatomy(hole.name) || r_.out.find_scan(hole.name) ||
               hole.name == "haptic" || hole.name == "scene")
        fault("burr_holes", "burr_holes[" + std::to_string(i) + "].name",
              hole.name + ", is the name of a stage, an anatomy or a part of the case already");
      r_.out.burr_holes.push_back({hole.name, AnyParams::make(hole)});
    }
  }

  void collect_values() {
    CaseConfig& out = r_.out;
    r_.values.add("import", import_);
    add_scan_values(r_);
    for (RecipeAnatomy& anatomy : out.anatomies)
      for (RecipeStep& step : anatomy.steps) r_.values.add(anatomy.name + "." + step.type->name, step.params);
    for (RecipeStep& step : out.scan_steps) r_.values.add(step.type->name, step.params);
    for (CaseDrill& hole : out.burr_holes) r_.values.add(hole.name, hole.params);
    for (const ParameterLeaf& leaf : leaves_of(out.scene_file))
      r_.values.add_one(leaf.path.rfind("haptic.", 0) == 0 ? leaf.path : "scene." + leaf.path, out.scene_file, leaf);
    for (std::size_t i = 0; i < out.burr_holes.size(); ++i) {
      const std::string listed = "burr_holes[" + std::to_string(i) + "]", &name = out.burr_holes[i].name;
      for (auto& [path, origin] : r_.said)
        if (path.rfind(listed, 0) == 0) path = name + path.substr(listed.size());
      r_.values.fix(name + ".name", "is set where the burr hole is given");
    }
    add_shown_values(r_);
    for (const auto& [path, origin] : r_.said)
      if (r_.values.has(path)) r_.values.note(path, origin);
    for (const char* name : {"policy", "believe", "believe_reason"})
      r_.values.fix(std::string("deface.") + name, std::string("follows scene.face.") + name + ", set that");
    const char* const with_scene = "is read with the scene: name it there";
    r_.values.fix("scene.materials", with_scene);
    if (const auto& haptic = out.scene_file.as<SceneFileParams>().haptic)
      for (const auto& shape : haptic->shapes)
        r_.values.fix("haptic.shapes." + shape.first + ".transfer_file", with_scene);
  }

  // Values that were set after the files were read pass the same checks as those in the files.
  void check_set_values() {
    CaseConfig& out = r_.out;
    if (out.anatomies.empty()) return;
    const auto& scene = out.scene_file.as<SceneFileParams>();
    const bool of_hu = scene.haptic && scene.haptic->encoding == voxel::HapticEncoding::hu;
    const auto fault_of_name = [&](const std::string& kind, const std::string& name) {
      if (kind == "anatomy" || (kind == "shape" && !of_hu)) return r_.fault_of_anatomy(name);
      if (kind == "landmark") return r_.fault_of_landmark(name);
      return std::string();  // materials and files have checks of their own
    };
    r_.values.check("import", import_, fault_of_name, r_.faults);
    for (const CaseScan& scan : out.scans) {
      r_.values.check(scan.name + ".import", scan.import, fault_of_name, r_.faults);
      r_.values.check(scan.name + ".register", scan.registration, fault_of_name, r_.faults);
    }
    for (const RecipeAnatomy& anatomy : out.anatomies)
      for (const RecipeStep& step : anatomy.steps)
        r_.values.check(anatomy.name + "." + step.type->name, step.params, fault_of_name, r_.faults);
    for (const RecipeStep& step : out.scan_steps)
      r_.values.check(step.type->name, step.params, fault_of_name, r_.faults);
    const auto any_name = [](const std::string&, const std::string&) {
      return std::string();
    };  // check_burr_holes does
    for (const CaseDrill& hole : out.burr_holes) r_.values.check(hole.name, hole.params, any_name, r_.faults);
    r_.values.check("scene", out.scene_file, fault_of_name, r_.faults);
    if (!scene.haptic) return;
    for (const auto& [name, shape] : scene.haptic->shapes)
      if (shape.clear_of == name) {
        const std::string path = "haptic.shapes." + name + ".clear_of";
        if (r_.values.is_set(path))
          r_.faults.add(Error(ExitCode::bad_config, r_.values.origin(path).where, path, "is the shape itself"));
      }
  }

  TradeRule rule() const {
    const CaseFileParams& said = said_.as<CaseFileParams>();
    TradeRule rule;
    if (!r_.overrides.profile.empty()) {
      rule.profile = r_.overrides.profile;
      return rule;
    }
    if (said.accuracy) {
      rule.max_deviation_mm = said.accuracy->max_deviation_mm;
      rule.p99_deviation_mm = said.accuracy->p99_deviation_mm;
      rule.rms_deviation_mm = said.accuracy->rms_deviation_mm;
    }
    if (said.budget) {
      rule.seconds = said.budget->seconds;
      rule.triangles_count = said.budget->triangles;
      rule.bytes = said.budget->bytes;
    }
    rule.profile = said.profile;
    return rule;
  }

  // A sweep uses no front, and says which of those that the case names it should replace.
  void tell_stale_fronts() {
    for (const SaidPath& path : said_.as<CaseFileParams>().trade) try {
        const fs::path file = file_of(path.path);
        if (file.empty() || r_.out.anatomies.empty()) continue;
        const std::string why = why_stale(read_trade_front(file), file, r_.out.recipe_sha256);
        if (!why.empty()) r_.out.trade.stale.push_back(why);
      } catch (const Error&) {  // a run that wants it will say so
      }
  }

  // Chooses the point of the measured front that the case's rule asks for.
  void choose_point() {
    const CaseFileParams& said = said_.as<CaseFileParams>();
    CaseTrade& trade = r_.out.trade;
    const TradeRule asked = rule();
    if (!said.profile.empty() && (said.accuracy || said.budget))
      fault("profile", "profile", "is a rule of its own, and there are accuracy or budget already");
    if (r_.overrides.without_rule) tell_stale_fronts();
    if (asked.empty() || r_.overrides.without_rule) return;
    if (said.trade.empty())
      return fault("trade", "trade", "is missing: which trade.json shall " + asked.text() + " be chosen from?");
    std::vector<fs::path> files;
    std::vector<TradeFront> fronts;
    for (const SaidPath& path : said.trade) try {
        files.push_back(file_of(path.path));
        if (files.back().empty()) return;
        TradeFront front = read_trade_front(files.back());
        if (std::string why = why_stale(front, files.back(), r_.out.recipe_sha256); !why.empty()) {
          trade.stale.push_back(std::move(why));
          files.pop_back();
        } else {
          fronts.push_back(std::move(front));
        }
      } catch (const Error& e) {
        return r_.faults.add(Error(e.code(), files.back().string(), e.field(), e.what()));
      }
    if (r_.out.anatomies.empty()) return;  // nothing is known of the recipe, which has been reported
    if (fronts.empty() && !trade.stale.empty()) {
      return fault("trade", "trade", "holds no front of this recipe: " + joined(trade.stale, "; "));
    }
    trade.rule = asked;
    trade.fronts = files;
    try {
      trade.choice = choose(points_of_all(on_one_machine(fronts)), asked);
      trade.calibration_s = fronts[0].calibration_s;
      for (const TradeFront& front : fronts)
        if (!(front.calibration_s > 0)) trade.calibration_s = 0;
    } catch (const Error& e) {
      return r_.faults.add(
          Error(e.code(), files.size() == 1 ? files[0].string() : r_.file.string(), e.field(), e.what()));
    }
    const ValueOrigin origin{ValueSource::trade, "point " + trade.choice.point.name + " of " + trade.front_names(), {}};
    for (const std::string& text : trade.choice.point.settings) r_.values.set_from_text(text, origin, r_.faults);
  }

  ValueOrigin origin_of_override(const std::string& path) const {
    const auto in_library = r_.overrides.set_in_library.find(path);
    if (in_library == r_.overrides.set_in_library.end()) return {ValueSource::command_line, "--set", {}};
    return {ValueSource::library, in_library->second, {}};
  }

  void set_values() {
    // Without a recipe nothing is known of its paths.
    const bool known = !r_.out.anatomies.empty();
    for (const auto& [path, value] : said_.as<CaseFileParams>().set) {
      const std::string where = "set." + path;
      if (!known || !set_.count(where)) continue;  // a value that could not be read has been reported
      const YamlNode& at = at_.at(where);
      if (const std::string what =
              r_.values.set(path, value.text, r_.origin(ValueSource::set, r_.file, at), !r_.faults.full());
          !what.empty())
        r_.faults.add(r_.file, r_.values.has(path) ? at : at_.key(where), where, what);
    }
    for (const std::string& text : r_.overrides.set)
      if (known || text.rfind("import.", 0) == 0 || text.find('=') == std::string::npos)
        r_.values.set_from_text(text, origin_of_override(text.substr(0, text.find('='))), r_.faults);
  }

  // Makes file names absolute: a name in a file is relative to that file, a name on the command line to the working
  // folder.
  void resolve_files() {
    for (RecipeAnatomy& anatomy : r_.out.anatomies)
      for (RecipeStep& step : anatomy.steps)
        for (const std::string& name : step.type->file_params())
          resolve_file(anatomy.name + "." + step.type->name + "." + name, *step.params.set->find(name), step.params);
    for (CaseScan& scan : r_.out.scans)
      for (const char* name : {"initial", "given"})
        resolve_file(scan.name + ".register." + name, *scan.registration.set->find(name), scan.registration);
  }
  void resolve_file(const std::string& path, const Parameter& p, AnyParams& params) {
    const std::string text = std::get<std::string>(params.get(p));
    if (text.empty()) return;
    const ValueOrigin& origin = r_.values.origin(path);
    // A library has looked at its paths itself.
    const bool from_command_line = origin.source == ValueSource::command_line || origin.source == ValueSource::library;
    std::string what;
    fs::path file;
    if (from_command_line) {
      file = absolute_path(text);
    } else {
      const fs::path folder = origin.folder.empty() ? r_.recipe.parent_path() : origin.folder;
      file = r_.in_root(folder / "from", text, what);
    }
    if (!what.empty())
      r_.faults.add(Error(ExitCode::bad_config, origin.where.empty() ? r_.recipe.string() : origin.where, path, what));
    else
      p.set(params.object.get(), file.string());
  }

  // Checks that can only be made when everything is set.
  void check_burr_holes() {
    CaseConfig& out = r_.out;
    if (!out.drilled.empty() && out.burr_holes.empty() && !tree_.find("burr_holes"))
      fault("burr_holes", "burr_holes",
            "is missing: the scene cuts them, e.g. [{at: kocher, side: right, diameter_mm: 14}], or [] for none");
    for (const CaseDrill& hole : out.burr_holes) try {
        const auto& params = hole.params.as<boolean::BurrHoleParams>();
        for (const auto& [zone, clear] : params.avoid)
          if (const std::string what = r_.fault_of_anatomy(zone); !what.empty())
            throw Error(ExitCode::bad_config, "", "avoid." + zone, what);
        if (const std::string what = params.toward.empty() ? "" : r_.fault_of_landmark(params.toward); !what.empty())
          throw Error(ExitCode::bad_config, "", "toward", what);
        if (out.landmarks_step())
          boolean::check_request(params, ExitCode::bad_config);  // a landmark that is not given is searched for
        else
          boolean::request_of(params, out.landmark_positions_mm(), ExitCode::bad_config);
      } catch (const Error& e) {
        fault("burr_holes", hole.name + "." + e.field(), e.what());
      }
    // Burr holes that the scene does not cut are dropped, so that the same case may be built for a scene that drills
    // and for one that does not.
    if (out.drilled.empty()) out.burr_holes.clear();
  }

  // Landmarks of a file that the case does not use are dropped: a point's label may be anything, even a patient's name.
  void drop_unused_landmarks() {
    CaseConfig& out = r_.out;
    const auto is_in = [](const std::vector<std::string>& all, const std::string& name) {
      return std::find(all.begin(), all.end(), name) != all.end();
    };
    std::vector<std::string> used = head::findable_landmarks();
    for (const CaseDrill& hole : out.burr_holes) used.push_back(hole.params.as<boolean::BurrHoleParams>().toward);
    for (const SceneLandmark& l : out.scene_landmarks) used.push_back(l.name);
    const RecipeStep* looked_for = out.landmarks_step();
    const auto is_used = [&](const std::string& name) {
      return is_in(used, name) || (looked_for && looked_for->type->finds(name));
    };
    const auto unused = [&](const cases::CaseLandmark& l) { return is_in(points_, l.name) && !is_used(l.name); };
    for (const cases::CaseLandmark& l : out.landmarks)
      if (const std::string near = nearest_name(l.name, used); !is_used(l.name) && !near.empty())
        log_warning(printable(l.name) + ", no landmark of that name is used, did you mean " + near + "?");
    out.landmarks.erase(std::remove_if(out.landmarks.begin(), out.landmarks.end(), unused), out.landmarks.end());
  }

  ConfigReading r_;
  const YamlNode tree_;
  Places at_;
  std::set<std::string> set_;  // paths below set: that could be read
  AnyParams said_ = AnyParams::make<CaseFileParams>();
  AnyParams import_ = AnyParams::make<dicom::ImportParams>();
  std::vector<std::string> points_;  // names that a file of landmarks holds
};

}  // namespace

CaseConfig read_case_config(const fs::path& file, const ConfigOverrides& overrides) {
  return Reader(file, overrides).read();
}

}  // namespace trephine::config

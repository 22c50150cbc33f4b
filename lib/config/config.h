// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/vec3.h"
#include "cases/case.h"
#include "config/case_file.h"
#include "config/recipe_file.h"
#include "config/scene_file.h"
#include "config/trade_front.h"
#include "config/values.h"
#include "stages/stage.h"

namespace trephine {

/// One step of an anatomy: a stage, its effective parameters, and where its ports other than the first come from.
struct RecipeStep {
  const StageType* type = nullptr;
  AnyParams params;
  std::map<std::string, std::string> ports;  ///< port name -> "anatomy.stage"
};

/// Stages of the whole scan (StagePlace::scan) that the program itself has to do with.
constexpr const char* resample_step = "resample";    ///< in every recipe, in force where a spacing is set
constexpr const char* landmarks_step = "landmarks";  ///< finds them where the scene or a burr hole needs one
constexpr const char* deface_step = "deface";        ///< where the scene's face policy is crop or deface
constexpr const char* anatomy_step = "anatomy";      ///< the gate, over those of its anatomies that the scene computes

struct RecipeAnatomy : RecipeAnatomyParams {
  std::string name;
  std::vector<RecipeStep> steps;
  const RecipeStep* find_step(const std::string& stage) const;
};

/// What a scene requires of one anatomy; 0 means that it sets no limit.
struct SceneAnatomy : SceneAnatomyParams {
  std::string name;
};

/// A shape of the scene's haptic volume, besides what the voxelize stage's parameters say of it.
struct SceneShape {
  std::string name;
  CaseMaterial material;
  bool cuttable = false;
};

struct SceneHaptic {
  bool wanted = false;
  AnyParams params = AnyParams::make<VoxelizeStageParams>();
  std::vector<SceneShape> shapes;  ///< in the scene's order
  HapticEncoding encoding() const { return params.as<VoxelizeStageParams>().encoding; }
};

/// A landmark that the scene cannot do without.
struct SceneLandmark {
  std::string name;
  double min_confidence = 0;
};

/// An anatomy from which the scene cuts the case's burr holes.
struct SceneDrill : DrillParams {
  std::string anatomy;
};

/// A burr hole of the case; the parameters are BurrHoleParams.
struct CaseDrill {
  std::string name;
  AnyParams params;
};

/// What the case asks of a measured front, and the point of it that it got.
struct CaseTrade {
  TradeRule rule;                             ///< empty: nothing is asked
  std::vector<std::filesystem::path> fronts;  ///< each trade.json that it was chosen from
  std::string front_names() const;            ///< "head.json", or "a.json, b.json"
  TradeChoice choice;
};

/// A case as its files and --set say it: every parameter has its effective value.
struct CaseConfig {
  std::string case_token;        ///< empty: none given
  std::filesystem::path series;  ///< empty: none given
  ImportParams import;
  std::vector<RecipeAnatomy> anatomies;  ///< the whole recipe, in its order
  std::vector<RecipeStep> scan_steps;    ///< its stages of the whole scan
  RecipeRoles roles;
  std::vector<SceneAnatomy> scene;  ///< what is wanted, in the recipe's order; triangles as triangles_ratio scales them
  std::string face, face_reason;    ///< "", keep, crop or deface
  std::vector<CaseLandmark> landmarks;  ///< given, by the configuration or a file that it names
  std::vector<SceneLandmark> scene_landmarks;
  std::vector<CaseDrill> burr_holes;  ///< none where the scene cuts none
  std::vector<SceneDrill> drilled;    ///< in the scene's order
  SceneHaptic haptic;
  CaseTrade trade;
  AnyParams scene_file = AnyParams::make<SceneFileParams>();  ///< all that the scene says
  std::vector<ValueRow> values;  ///< every parameter that a stage of the case may have, and where its value is from

  std::map<std::string, Vec3> landmark_positions_mm() const;
  const RecipeAnatomy* find_anatomy(const std::string& name) const;
  const RecipeStep* find_scan_step(const std::string& stage) const;
  /// Whether the surface or the haptic volume of the scene shows it.
  bool is_shown(const std::string& anatomy) const;
  /// The anatomy in which the landmark lies as a target of the recipe; empty where it is none.
  std::string target_in(const std::string& landmark) const;
};

struct ConfigOverrides {
  std::filesystem::path series;     ///< from the command line, not bound to the root
  std::filesystem::path landmarks;  ///< a file of 3D Slicer's; its points win over the configuration's
  std::string case_token;
  std::string profile;                       ///< instead of the rule that the configuration holds
  bool without_rule = false;                 ///< the rule that the configuration holds chooses nothing
  std::vector<std::string> set;              ///< "skull.decimate.max_deviation_mm=0.2", "import.series=s1"
  std::vector<std::filesystem::path> roots;  ///< folders beside the root that paths in the files may lead to
};

/// Reads the case's YAML, the recipe and the scene that it names, and the scene's materials. What wins where several
/// say a value is the order of ValueSource (values.h); decimation's share of the scene's deviation is what the
/// smoothing that is in force at last leaves of it, and a point of a trade keeps its own value where the scene allows
/// it. Throws ErrorList with every fault of all files and the overrides at once: 78 with file:line:column, 66 for a
/// file that is missing, 64 for an override; the first one's code counts.
CaseConfig read_case_config(const std::filesystem::path& file, const ConfigOverrides& overrides = {});

}  // namespace trephine

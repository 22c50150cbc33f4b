// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/vec3.h"
#include "cases/case.h"
#include "config/case_file.h"
#include "config/case_scans.h"
#include "config/recipe_file.h"
#include "config/scene_file.h"
#include "config/trade_front.h"
#include "config/values.h"
#include "stages/stage.h"

namespace trephine::config {

/// One step of an anatomy: a stage, its effective parameters, and the sources of all its ports but the first.
struct RecipeStep {
  const stages::StageType* type = nullptr;
  AnyParams params;
  std::map<std::string, std::string> ports;  ///< port name -> "anatomy.stage"
  std::string scan;                          ///< the scan that it reads; empty: the CT
};

struct RecipeAnatomy : RecipeAnatomyParams {
  std::string name;
  std::vector<RecipeStep> steps;
  const RecipeStep* find_step(const std::string& stage) const;
  /// What the recipe sets for the stage with those parameters; null: the anatomy has no such step.
  template <class P>
  const P* params_of() const {
    for (const RecipeStep& step : steps)
      if (step.params.set == &parameters_of<P>()) return &step.params.as<P>();
    return nullptr;
  }
};

/// The limits that a scene sets for one anatomy; 0 means no limit.
struct SceneAnatomy : SceneAnatomyParams {
  std::string name;
  cases::CaseMaterial material;  ///< of `touched_as`
};

/// A shape of the scene's haptic volume, with what the voxelize stage's parameters do not say of it.
struct SceneShape : cases::ShapeParams {
  std::string name;
  cases::CaseMaterial material;
};

struct SceneHaptic {
  bool wanted = false;
  AnyParams params = AnyParams::make<stages::VoxelizeStageParams>();
  std::vector<SceneShape> shapes;  ///< in the scene's order
  voxel::HapticEncoding encoding() const { return params.as<stages::VoxelizeStageParams>().encoding; }
};

/// A landmark that the scene requires.
struct SceneLandmark {
  std::string name;
  double min_confidence = 0;
};

/// An anatomy from which the scene cuts the case's burr holes.
struct SceneDrill : stages::DrillParams {
  std::string anatomy;
};

/// A burr hole of the case; the parameters are BurrHoleParams.
struct CaseDrill {
  std::string name;
  AnyParams params;
};

/// The rule by which the case chooses a point of a measured front, and the chosen point.
struct CaseTrade {
  TradeRule rule;                             ///< empty: no rule
  std::vector<std::filesystem::path> fronts;  ///< each trade.json from which it was chosen
  std::string front_names() const;            ///< "head.json", or "a.json, b.json"
  std::vector<std::string> stale;             ///< a line for each front that belongs to another recipe and was not used
  TradeChoice choice;
  double calibration_s = 0;  ///< of the machine whose seconds the chosen point tells; 0: not known of every front
};

/// A case as its files and --set describe it. Every parameter has its effective value.
struct CaseConfig {
  std::string case_token;        ///< empty: none given
  std::filesystem::path series;  ///< empty: none given
  dicom::ImportParams import;
  std::vector<CaseScan> scans;           ///< further ones, in the configuration's order
  std::vector<RecipeAnatomy> anatomies;  ///< the whole recipe, in its order
  std::vector<RecipeStep> scan_steps;    ///< the whole recipe, in its order
  std::string recipe_sha256;             ///< of what the recipe says (digest_of)
  RecipeRoles roles;
  std::vector<SceneAnatomy> scene;             ///< in the recipe's order; triangles scaled by triangles_ratio
  std::string face, face_reason;               ///< "", keep, crop or deface
  face::FaceBeliefParams face_belief;          ///< which landmarks say where the face is
  std::vector<cases::CaseLandmark> landmarks;  ///< given by the configuration or by a file that it names
  std::vector<SceneLandmark> scene_landmarks;
  std::vector<CaseDrill> burr_holes;  ///< empty where the scene cuts none
  std::vector<SceneDrill> drilled;    ///< in the scene's order
  SceneHaptic haptic;
  std::optional<SceneCtParams> ct;  ///< nothing: the case holds no CT
  CaseTrade trade;
  AnyParams scene_file = AnyParams::make<SceneFileParams>();  ///< the whole scene file
  std::vector<ValueRow> values;  ///< every parameter that a stage of the case may have, and the source of its value

  std::map<std::string, Vec3> landmark_positions_mm() const;
  const RecipeAnatomy* find_anatomy(const std::string& name) const;
  const CaseScan* find_scan(const std::string& name) const;
  /// The scene's anatomy whose surface it shows, or null.
  const SceneAnatomy* find_shown(const std::string& anatomy) const;
  /// Whether it is one of those, and the scene lets it be missing or names what stands for it.
  bool can_do_without(const std::string& anatomy) const;
  /// The anatomy to which the recipe gives a role ("burr_holes.bone"); empty: none. Throws Error 70 for an unknown
  /// role.
  std::string in_role(const std::string& role) const;
  /// Whether the scene or a burr hole needs a landmark that is not given, and the recipe finds landmarks.
  bool needs_landmarks() const;
  /// The recipe's step that finds landmarks, or null.
  const RecipeStep* landmarks_step() const;
  /// The recipe's step that takes the face off the scan, or null.
  const RecipeStep* face_step() const;
  /// Whether the scene's policy is that the face is taken away: crop or deface.
  bool takes_face_away() const { return face == "crop" || face == "deface"; }
  /// Whether the scene has the anatomy in its haptic volume.
  bool is_felt(const std::string& anatomy) const;
  /// Whether the scene shows the anatomy by its surface or by the haptic volume.
  bool is_shown(const std::string& anatomy) const;
  /// Takes an anatomy that may be missing out of the scene: what is shown, felt and drilled of it.
  void leave_out(const std::string& anatomy);
  /// Lets what stands for an anatomy of the scene (SceneAnatomy::stand_in) take its name. The anatomy itself goes on as
  /// refused_NAME, for others that read its fields; checks, which are of what is shown, read the first field of what
  /// stands for it. Returns that anatomy's own name.
  std::string let_stand_in(const std::string& anatomy);
  /// The anatomy in which the landmark lies as a target of the recipe; empty where it is no target.
  std::string target_in(const std::string& landmark) const;
};

struct ConfigOverrides {
  std::filesystem::path series;                                      ///< from the command line, not bound to the root
  std::vector<std::pair<std::string, std::filesystem::path>> scans;  ///< the same, of further scans by name
  std::filesystem::path landmarks;  ///< a file of 3D Slicer; its points replace those of the configuration
  std::string case_token;
  std::string profile;           ///< replaces the rule of the configuration
  bool without_rule = false;     ///< the rule of the configuration is ignored
  std::vector<std::string> set;  ///< "skull.decimate.max_deviation_mm=0.2", "import.series=s1"
  /// By path, where a library's file has that setting: "library.yaml:5:64". Those of the command line are not in it.
  std::map<std::string, std::string> set_in_library;
  std::vector<std::filesystem::path> roots;  ///< folders beside the root that paths in the files may lead to
};

/// Reads the case's YAML, the recipe and the scene that it names, and the scene's materials. Where several sources set
/// a value, ValueSource (values.h) says which one wins. Decimation gets the part of the scene's deviation that the
/// effective smoothing leaves, and a point of a trade keeps its own value where the scene allows it. Throws ErrorList
/// with every fault of all files and overrides at once: 78 with file:line:column, 66 for a missing file, 64 for an
/// override. The exit code is that of the first fault.
CaseConfig read_case_config(const std::filesystem::path& file, const ConfigOverrides& overrides = {});

}  // namespace trephine::config

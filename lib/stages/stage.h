// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "boolean/cutter.h"
#include "cases/landmarks.h"
#include "grid/grid.h"
#include "surface/trimesh.h"
#include "voxel/haptic_volume.h"

namespace trephine {

/// A stage is a library function with its parameters declared and its inputs named, so that `run` (data in memory) and
/// the single tools (data in files) call one and the same thing. One stage a file in this folder.

enum class DataKind { volume, field, mesh, haptic, cutters, landmarks, nothing };
const char* to_text(DataKind kind);

/// What stages hand each other; shared, never modified once made.
using StageData = std::variant<std::monostate, std::shared_ptr<const HuVolume>, std::shared_ptr<const Field>,
                               std::shared_ptr<const TriMesh>, std::shared_ptr<const HapticVolume>,
                               std::shared_ptr<const std::vector<Cutter>>, std::shared_ptr<const HeadLandmarks>>;

/// An input of a stage. A name that ends in ".*" stands for any number of them ("cutters.*": cutters.1, ...). The first
/// port of a stage takes the output of the stage before it in a recipe.
struct Port {
  std::string name;
  DataKind kind = DataKind::volume;
  bool required = true;
  std::string help;
  bool or_volume = false;  ///< a field, or a CT volume
};

struct StageInputs {
  std::map<std::string, StageData> by_port;

  /// Null where the port was left open. The kind is the port's (checked before the stage runs).
  template <class T>
  const T* get(const std::string& port) const {
    const auto found = by_port.find(port);
    if (found == by_port.end()) return nullptr;
    const auto* data = std::get_if<std::shared_ptr<const T>>(&found->second);
    return data ? data->get() : nullptr;
  }
  /// Those of the ports "<group>.<rest>", by rest.
  template <class T>
  std::map<std::string, const T*> all(const std::string& group) const {
    std::map<std::string, const T*> found;
    for (const auto& [port, data] : by_port)
      if (port.rfind(group + ".", 0) == 0) found[port.substr(group.size() + 1)] = get<T>(port);
    return found;
  }
};

struct StageType {
  std::string name;
  int version = 1;  ///< raised whenever the same inputs and parameters give other bytes: part of the cache's key
  std::string summary, description;
  std::vector<Port> ports;
  DataKind output = DataKind::mesh;
  std::function<AnyParams()> make_params;
  /// Parameters that name files to be read: relative to the file that says so; in keys and cases it is their content's
  /// hash that stands for them.
  std::vector<std::string> file_params;
  /// Fills the report, also with what it could not do. Throws Error (field: what went wrong in the stage) and
  /// Cancelled.
  std::function<StageData(const AnyParams&, const StageInputs&, Report&, const Progress&)> run;

  const Port* find_port(const std::string& port) const;
};

/// The stages of which a recipe is made, in its order. Others serve the whole case (stages/burr_hole.h, cut.h,
/// haptic.h).
const std::vector<StageType>& stage_types();
const StageType* find_stage(const std::string& name);

StageType segment_stage();
StageType labels_stage();
StageType presegment_stage();
StageType snake_stage();
/// `given`: landmarks that a person placed; they win over what is found.
StageType landmarks_stage(std::vector<CaseLandmark> given = {});
StageType canal_stage();
StageType clavicle_stage();
StageType vein_stage();
StageType contour_stage();
StageType decimate_stage();
StageType smooth_stage();
StageType normals_stage();
StageType repair_stage();
StageType simplify_stage();
StageType anatomy_stage();
StageType remesh_stage();
StageType measure_stage();
/// Serves the whole case: between the import and all anatomies, where a scene says `face: {policy: deface}` or crop.
StageType deface_stage();
/// Serves the whole case too: right after the import, where a spacing is set.
StageType resample_stage();

}  // namespace trephine

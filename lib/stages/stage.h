// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "boolean/cutter.h"
#include "grid/grid.h"
#include "grid/labels.h"
#include "head/head_landmarks.h"
#include "picture/slice.h"
#include "surface/trimesh.h"
#include "voxel/haptic_volume.h"

namespace trephine {

/// A stage is a library function with declared parameters and named inputs, so that `run` (data in memory) and the
/// single tools (data in files) call the same function. Each stage is declared in a file NAME_stage.cpp of this folder,
/// as `StageType NAME_stage()`; the build finds these files and makes the registry (stage_types). Command, help,
/// reference page, schema and completion come from the registry.

enum class DataKind { volume, field, mesh, haptic, cutters, landmarks, labels, nothing };
const char* to_text(DataKind kind);

/// The data that stages hand to each other. It is shared and never modified once made.
using StageData = std::variant<std::monostate, std::shared_ptr<const HuVolume>, std::shared_ptr<const Field>,
                               std::shared_ptr<const TriMesh>, std::shared_ptr<const HapticVolume>,
                               std::shared_ptr<const std::vector<Cutter>>, std::shared_ptr<const HeadLandmarks>,
                               std::shared_ptr<const LabelFile>>;

/// Where a stage is used.
enum class StagePlace {
  anatomy,  ///< a step of an anatomy in a recipe
  scan,     ///< once for the whole scan, where a recipe has its name as a key and the scene needs it
  scene,    ///< what a scene or a case asks for: burr holes, the haptic volume, gates; no recipe names it
};

/// What the graph of a case uses a stage for where it is no step that a recipe puts in order. At most one stage has
/// each role, so the graph need not know names.
enum class StageRole {
  step,             ///< a step of an anatomy, or a tool that no case uses
  import,           ///< reads the series
  suitability,      ///< says what the scan is suited for, right after the import
  second_scan,      ///< lays a further scan of the patient on the first
  resample,         ///< puts the scan on other voxels
  prepare,          ///< makes the scan ready before anything is found on it; there may be several
  given_landmarks,  ///< holds the landmarks that a person placed
  landmarks,        ///< finds landmarks; there are several, of which a recipe names one
  deface,           ///< takes the face off the scan
  face_check,       ///< checks that nothing to be published shows the face
  check,            ///< checks anatomies against each other
  burr_hole,        ///< places a burr hole
  cut,              ///< cuts burr holes from a surface
  haptic,           ///< makes the haptic volume
  mismatch,         ///< compares what is felt with what is seen
  measure,          ///< measures what decimation and smoothing did
};

/// A landmark that a stage finds, and the slice in which it is best seen; or a family of them, of which there are as
/// many as the scan shows: their names begin with this one and "_".
struct StagePoint {
  std::string name;
  SlicePlane plane = SlicePlane::coronal;
  bool family = false;
  bool names(const std::string& landmark) const {
    return landmark == name || (family && landmark.rfind(name + "_", 0) == 0);
  }
};

/// An input of a stage. A name that ends in ".*" stands for any number of them ("cutters.*": cutters.1, ...). The first
/// port of a stage takes the output of the stage before it in a recipe.
struct Port {
  std::string name;
  DataKind kind = DataKind::volume;
  bool required = true;
  std::string help;
  bool or_volume = false;  ///< takes a field or a CT volume
  bool or_field = false;   ///< as a file takes a surface, or a field, which is contoured
};

/// Declares a port by the names of what it says: port("cutters.*", DataKind::cutters).optional().help("...").
class PortDeclaration {
 public:
  PortDeclaration(std::string name, DataKind kind) {
    port_.name = std::move(name);
    port_.kind = kind;
  }
  PortDeclaration& optional() { return port_.required = false, *this; }
  PortDeclaration& or_volume() { return port_.or_volume = true, *this; }
  PortDeclaration& or_field() { return port_.or_field = true, *this; }
  PortDeclaration& help(std::string text) { return port_.help = std::move(text), *this; }
  operator Port() const { return port_; }

 private:
  Port port_;
};
inline PortDeclaration port(std::string name, DataKind kind) { return {std::move(name), kind}; }

struct StageInputs {
  std::map<std::string, StageData> by_port;
  /// The hash that the content of a file parameter must have; no entry where it is not known beforehand.
  std::map<std::string, std::string> file_sha256;

  /// The data of a port, or null where the port was left open. The kind is that of the port, checked before the stage
  /// runs.
  template <class T>
  const T* get(const std::string& port) const {
    const auto found = by_port.find(port);
    if (found == by_port.end()) return nullptr;
    const auto* data = std::get_if<std::shared_ptr<const T>>(&found->second);
    return data ? data->get() : nullptr;
  }
  /// The data of all ports "<group>.<rest>", by rest.
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
  int version = 1;  ///< raised whenever the same inputs and parameters give other bytes; part of the cache's key
  StagePlace place = StagePlace::anatomy;
  StageRole role = StageRole::step;
  bool draws_removal = false;   ///< takes something off the scan, on the same voxels: a picture shows what
  bool changes_raster = false;  ///< its field is not on the scan's voxels, so that no correction can be laid on it
  /// Seconds on a head of 30 million voxels: a weight of the overall progress until a run of the library has told.
  double typical_s = 0.5;
  std::string summary, description;
  std::vector<std::string> examples;  ///< whole command lines
  std::vector<Port> ports;
  std::vector<StagePoint> points;  ///< the landmarks that it finds
  DataKind output = DataKind::mesh;
  bool runs_program = false;  ///< somebody else's, so the user must allow it
  /// Figures of the report that a case records beside the stage's parameters, as what it is made of.
  std::vector<std::string> provenance;
  std::function<AnyParams()> make_params;
  /// Runs the stage and fills the report, also with what it could not do. Throws Error (the field says what went wrong
  /// in the stage) and Cancelled.
  std::function<StageData(const AnyParams&, const StageInputs&, Report&, const Progress&)> run;

  const Port* find_port(const std::string& port) const;
  /// Whether it finds landmarks of that name.
  bool finds(const std::string& landmark) const;
  /// The parameters that name files to be read (declared with names("file")). Their paths are relative to the file that
  /// holds them; in keys and cases the hash of the content stands for them.
  std::vector<std::string> file_params() const;
};

/// All declared stages, by name.
const std::vector<StageType>& stage_types();
/// The stage with that name, or null.
const StageType* find_stage(const std::string& name);
/// The stage with a name that the program's own code uses. Throws Error 70 where there is none.
const StageType& stage_named(const std::string& name);
/// The stage with that role. Throws Error 70 where there is none.
const StageType& stage_of(StageRole role);
/// The slice in which a landmark is best seen; coronal where no stage finds it.
SlicePlane plane_of_landmark(const std::string& name);
/// The stages of a place, by name.
std::vector<const StageType*> stages_of(StagePlace place);

}  // namespace trephine

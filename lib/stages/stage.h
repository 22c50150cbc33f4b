// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <typeinfo>
#include <utility>
#include <variant>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "boolean/cutter.h"
#include "grid/grid.h"
#include "grid/labels.h"
#include "head/head_landmarks.h"
#include "picture/slice.h"
#include "stages/case_parts.h"
#include "stages/shared_work.h"
#include "surface/trimesh.h"
#include "voxel/haptic_volume.h"

namespace trephine::stages {

/// A stage is a library function with declared parameters and named inputs, so that `run` (data in memory) and the
/// single tools (data in files) call the same function. Each stage is declared in a file NAME_stage.cpp of this folder,
/// as `StageType NAME_stage()`; the build finds these files and makes the registry (stage_types). Command, help,
/// reference page, schema and completion come from the registry.

enum class DataKind { volume, field, mesh, haptic, cutters, landmarks, labels, nothing };
const char* to_text(DataKind kind);

/// The data that stages hand to each other. It is shared and never modified once made.
using StageData =
    std::variant<std::monostate, std::shared_ptr<const grid::HuVolume>, std::shared_ptr<const grid::Field>,
                 std::shared_ptr<const surface::TriMesh>, std::shared_ptr<const voxel::HapticVolume>,
                 std::shared_ptr<const std::vector<boolean::Cutter>>, std::shared_ptr<const head::HeadLandmarks>,
                 std::shared_ptr<const grid::LabelFile>>;

/// Where a stage is used. What a case uses it for follows from its output: of the whole scan, a volume takes the scan's
/// place, landmarks are looked for where something needs them, and a stage that hands on nothing is a check, made where
/// the case has its inputs. A check of the scene is made of every anatomy where it reads one anatomy's surface.
enum class StagePlace {
  anatomy,  ///< a step of an anatomy in a recipe
  scan,     ///< once for the whole scan, where a recipe has its name as a key and the scene needs it
  scene,    ///< what a scene or a case asks for: burr holes, the haptic volume, gates; no recipe names it
};

/// Where the graph of a case takes an input from; a single tool takes every input from a file. What its source makes
/// first stands before it in the graph, in this order. An input whose source the case has not is left open.
enum class From {
  scan,                ///< the scan that the step names, or as the stages of the whole scan left it (volumes)
  ct,                  ///< the CT, whichever scan the step names
  import,              ///< the scan as it was read
  original_scan,       ///< the scan before its face is taken away
  further_scan,        ///< a further scan of the case, as it was read
  published_ct,        ///< the CT that the case holds
  given_landmarks,     ///< landmarks that a person placed
  known_landmarks,     ///< those of the case where they are looked for anyway, else the given ones
  recipe,              ///< what the recipe names as anatomy.stage; by its first port an anatomy's step takes the one
                       ///< before it (fields, labels, surfaces)
  landmarks,           ///< those of the case, which are looked for
  original_landmarks,  ///< those of the scan before its face is taken away
  found_landmarks,     ///< the same without those that a person placed; open where nobody placed any
  role,                ///< the surface before decimation of the anatomy that has the role Port::role in the recipe
  anatomies,           ///< the same of the anatomies that the parameters name: Port::anatomies
  first_surface,       ///< of one anatomy the surface before decimation
  finished_surface,    ///< of one anatomy the surface before burr holes
  surfaces,            ///< every published surface
  felt_surfaces,       ///< those of shapes that are felt as well
  cutters,             ///< every burr hole of the case (cutters)
  haptic,              ///< the haptic volume of the case (haptic volumes)
};

/// The seconds that a stage takes, for the time left until an earlier run of the case tells: sums of these, fitted to
/// seven heads, a chest and a lumbar spine on two quiet cores (docs/validation/strangers.md, "The time left").
struct TypicalTime {
  double base_s = 0.5;
  double per_million_voxels_s = 0;     ///< of its largest field or volume
  double per_million_triangles_s = 0;  ///< of its largest surface; of a field, of the surface that it has
  double per_input_s = 0;
  /// Triangles of the surface of the field that it makes, in slices of 512 x 512; 0: those of the field that it reads.
  double surface_million = 0;
};

/// A landmark that a stage finds, and the slice in which it is best seen; or a family of them, of which there are as
/// many as the scan shows: their names begin with this one and "_".
struct StagePoint {
  std::string name;
  picture::SlicePlane plane = picture::SlicePlane::coronal;
  bool family = false;
  bool names(const std::string& landmark) const {
    return landmark == name || (family && landmark.rfind(name + "_", 0) == 0);
  }
};

/// An input of a stage. A name that ends in ".*" stands for any number of them ("cutters.*": cutters.1, ...).
struct Port {
  std::string name;
  DataKind kind = DataKind::volume;
  bool required = true;
  std::string help;
  bool or_volume = false;  ///< takes a field or a CT volume
  bool or_field = false;   ///< takes a surface, or the field whose contour it is
  /// Of From::anatomies: whether a field does for the anatomy, with these parameters.
  std::function<bool(const AnyParams&, const std::string& anatomy)> field_does;
  From from = From::recipe;
  std::string role;  ///< of From::role: "burr_holes.bone"; of others: open unless the anatomy of that role is shown
  std::function<std::vector<std::string>(const AnyParams&)> anatomies;  ///< of From::anatomies
  std::function<bool(const AnyParams&)> asked;  ///< whether the parameters ask for the input; empty: always
  /// Whether, with these parameters, the stage cannot do without an input that is optional otherwise; empty: never.
  std::function<bool(const AnyParams&)> needed;
  /// Of a volume: whether, with these parameters, its lattice alone is read, so that a run leaves its voxels on disk;
  /// empty: never.
  std::function<bool(const AnyParams&)> lattice_does;

  bool is_many() const { return group() != name; }
  /// The name without ".*".
  std::string group() const { return name.substr(0, name.find(".*")); }
};

/// Declares a port by the names of what it says: port("cutters.*", DataKind::cutters).optional().help("..."). Its
/// source follows from its kind where `from` does not say another one.
class PortDeclaration {
 public:
  PortDeclaration(std::string name, DataKind kind);
  PortDeclaration& optional() { return port_.required = false, *this; }
  PortDeclaration& or_volume() { return port_.or_volume = true, *this; }
  PortDeclaration& or_field(std::function<bool(const AnyParams&, const std::string&)> does) {
    return port_.field_does = std::move(does), port_.or_field = true, *this;
  }
  PortDeclaration& help(std::string text) { return port_.help = std::move(text), *this; }
  PortDeclaration& from(From from) { return port_.from = from, *this; }
  PortDeclaration& of_role(std::string role) { return port_.role = std::move(role), from(From::role); }
  PortDeclaration& where_shown(std::string role) { return port_.role = std::move(role), *this; }
  PortDeclaration& of(std::function<std::vector<std::string>(const AnyParams&)> anatomies) {
    return port_.anatomies = std::move(anatomies), from(From::anatomies);
  }
  PortDeclaration& where(std::function<bool(const AnyParams&)> asked) { return port_.asked = std::move(asked), *this; }
  PortDeclaration& needed_where(std::function<bool(const AnyParams&)> needed) {
    return port_.needed = std::move(needed), *this;
  }
  PortDeclaration& lattice_does_where(std::function<bool(const AnyParams&)> does) {
    return port_.lattice_does = std::move(does), *this;
  }
  operator Port() const { return port_; }

 private:
  Port port_;
};
inline PortDeclaration port(std::string name, DataKind kind) { return {std::move(name), kind}; }

/// What a stage gives: what it hands on, its result as the declared struct that StageType::make_result makes, and what
/// a person should know of it.
struct StageOutcome {
  StageData data;
  AnyParams result;
  Warnings warnings;
  /// Result and warnings as they are printed; nothing where there is no result.
  Report report() const { return result.set ? printed(result, warnings) : Report(); }
};

/// Of a function that made nothing to hand on, or whose value is handed on as it is.
template <class T, class R>
StageOutcome stage_outcome(Outcome<T, R> made) {
  return {std::make_shared<const T>(std::move(made.value)), AnyParams::make<R>(std::move(made.result)),
          std::move(made.warnings)};
}
template <class T, class R>
StageOutcome stage_outcome(Outcome<std::shared_ptr<const T>, R> made) {
  return {std::move(made.value), AnyParams::make<R>(std::move(made.result)), std::move(made.warnings)};
}
template <class R>
StageOutcome stage_outcome(Outcome<std::monostate, R> made) {
  return {{}, AnyParams::make<R>(std::move(made.result)), std::move(made.warnings)};
}

struct StageInputs {
  std::map<std::string, StageData> by_port;
  /// The hash that the content of a file parameter must have; no entry where it is not known beforehand.
  std::map<std::string, std::string> file_sha256;
  /// In a run: what its stages share, and by port what says which data lie there (the key of the node that made them).
  SharedWork* shared = nullptr;
  std::map<std::string, std::string> key_by_port;

  /// What `make` gives, a std::shared_ptr<const T>, where it depends on nothing but the data of these ports: in a run
  /// it is made once for all stages that ask for `what` of the same data, else here. `make` may not use the stage's
  /// parameters.
  template <class T, class Make>
  std::shared_ptr<const T> once(const std::string& what, const std::vector<std::string>& ports,
                                const Progress& progress, const Make& make) const {
    if (!shared) return make();
    std::string key = what + ' ' + typeid(T).name();
    for (const std::string& port : ports) {
      const auto of = key_by_port.find(port);
      key += ' ' + (of == key_by_port.end() ? "open" : of->second);
    }
    return std::static_pointer_cast<const T>(
        shared->once(key, progress, [&]() -> std::shared_ptr<const void> { return make(); }));
  }

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

/// Of a stage that checks what a case is made of.
struct StageCheck {
  /// What a case has of it ("what the scan is suited for"; of an anatomy, its name follows).
  std::string serves;
  int min_inputs = 0;  ///< with fewer anatomies shown it is left out
  /// The inputs by which alone it may refuse. A case is held against these first, before what its other inputs are made
  /// of is made.
  std::vector<std::string> refuses_early_by;
  /// Of any stage: it refuses a scan of another part of the body. What it needs is made first, as what a check needs
  /// is.
  bool recognises = false;
};

/// What else a stage does with a scan or with its raster.
enum class StageEffect {
  none,
  removes_face,    ///< takes the face off the scan, where the scene's policy says so
  draws_removal,   ///< takes something off the scan, on the same voxels: a picture shows what
  changes_raster,  ///< its field is not on the scan's voxels, so that no correction can be laid on it
};

struct StageType {
  std::string name;
  int version = 1;  ///< raised whenever the same inputs and parameters give other bytes; part of the cache's key
  StagePlace place = StagePlace::anatomy;
  /// What a case calls it where that is not the stage's name: "haptic.mismatch".
  std::string case_name;
  StageCheck check;
  StageEffect effect = StageEffect::none;
  bool in_every_recipe = false;  ///< a recipe need not name it; with its default parameters it does nothing
  TypicalTime typical;
  std::string summary, description;
  std::vector<std::string> examples;  ///< whole command lines
  std::vector<Port> ports;
  std::vector<StagePoint> points;  ///< the landmarks that it finds
  DataKind output = DataKind::mesh;
  bool runs_program = false;  ///< somebody else's, so the user must allow it
  std::function<AnyParams()> make_params;
  std::function<AnyParams()> make_result;
  /// Adds what the result says to a case; empty: nothing.
  std::function<void(const AnyParams& result, CaseParts& parts)> contribute;
  /// Runs the stage. Throws Error (the field says what went wrong in the stage) and Cancelled.
  std::function<StageOutcome(const AnyParams&, const StageInputs&, const Progress&)> run;

  /// The structs of its parameters and its result.
  template <class Params, class Result>
  void declares() {
    make_params = [] { return AnyParams::make<Params>(); };
    make_result = [] { return AnyParams::make<Result>(); };
  }

  const Port* find_port(const std::string& port) const;
  /// Labels of a whole scan show what a person should look at: no stage reads them.
  bool is_check() const {
    return place != StagePlace::anatomy &&
           (output == DataKind::nothing || (place == StagePlace::scan && output == DataKind::labels));
  }
  /// A check of nothing but the scan as it was read: its warnings are given when it has run, for a later refusal may be
  /// because of what it says.
  bool warns_at_once() const;
  bool reads(From from) const;
  /// Whether it gives a field on the scan's voxels, on which a correction by hand can be laid.
  bool can_be_corrected() const { return output == DataKind::field && effect != StageEffect::changes_raster; }
  /// Whether it reads the scan before its face is taken away, or what was made of it.
  bool sees_face() const { return reads(From::original_scan) || reads(From::original_landmarks); }
  const std::string& name_in_case() const { return case_name.empty() ? name : case_name; }
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
/// The stage that has these parameters: a part of a case's configuration is the parameters of one stage. Throws Error
/// 70 where there is none.
const StageType& stage_with(const ParameterSet& params);
/// The slice in which a landmark is best seen; coronal where no stage finds it.
picture::SlicePlane plane_of_landmark(const std::string& name);
/// The stages of a place, by name.
std::vector<const StageType*> stages_of(StagePlace place);

}  // namespace trephine::stages

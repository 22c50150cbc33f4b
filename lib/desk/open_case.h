// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "config/config.h"
#include "desk/desk_library.h"
#include "grid/grid.h"
#include "pipeline/executor.h"
#include "pipeline/graph.h"

namespace trephine::desk {

/// A case's configuration, and what would be computed for it.
struct CaseGraph {
  std::shared_ptr<const config::CaseConfig> config;
  pipeline::Graph graph;
};
/// Reads the series' content for the keys of the cache. Throws what run throws before its first stage: 64 where there
/// is no series, 65 for scans of two patients, what make_graph throws.
CaseGraph graph_of_case(config::CaseConfig config, const Progress& progress);

/// A field for outlines: 16 bits a voxel, scaled so that the surface at 0 stays where it is.
struct DrawnField {
  grid::Box place;  ///< in the scan's voxels
  grid::Grid<std::int16_t> samples;
};

/// `scan`: on whose voxels it is drawn. Throws Error 65 where the field does not lie on them.
DrawnField drawn_field(const grid::Field& field, const grid::Lattice& scan);
/// Of the voxels whose centre lies inside.
double volume_ml(const DrawnField& field);
/// The node whose field says what the anatomy is, after any correction; -1: it has none.
int field_node(const CaseGraph& graph, const std::string& anatomy);
/// Computes that node and what it needs, and nothing else of the case: so a stage that is refused hides no other one,
/// as where a landmark is missing that a person is about to place.
pipeline::NodeResult computed(const pipeline::Graph& graph, int node, const pipeline::ExecuteOptions& options,
                              pipeline::RunObserver& observer);
/// What the anatomy's field is made of, as text: the values of the configuration but those of surfaces, of what is felt
/// and of burr holes (which leave a surface fewer triangles), and the digest of its correction.
std::string shape_state(const config::CaseConfig& config, const std::string& anatomy);
/// What went wrong, in the words of an Error's line, a line for each; for use within a catch (...).
std::string fault_of_exception();

/// A case that a page looks at: the scan that its anatomies are made of (without the face, where the scene takes it
/// away) and the field of each anatomy, from the cache of stages or computed now, in a thread of its own.
class OpenCase {
 public:
  /// `before`: the same case as it was opened before; its scan and fields serve until those of this one are there.
  OpenCase(const DeskLibrary& library, DeskCase one, const OpenCase* before = nullptr);
  ~OpenCase();
  OpenCase(const OpenCase&) = delete;
  OpenCase& operator=(const OpenCase&) = delete;

  enum class State { opening, ready, failed };
  struct Now {
    State state = State::opening;
    std::string doing;  ///< the stage that is computed
    double fraction = 0;
    std::string fault;
    bool has_scan = false;
    std::vector<std::string> fields;             ///< anatomies whose field is there
    std::vector<cases::CaseLandmark> landmarks;  ///< as they are found, where the recipe seeks them
    std::vector<std::string> warnings;
  };
  Now now() const;

  /// Null until it is there; kept while the caller has it.
  std::shared_ptr<const grid::HuVolume> scan() const;
  std::shared_ptr<const DrawnField> field(const std::string& anatomy) const;
  /// The configuration as it was read; only where the state is not failed before it.
  std::shared_ptr<const config::CaseConfig> config() const;
  /// Whether the anatomy's field is the one that this configuration would give.
  bool is_current(const std::string& anatomy, const config::CaseConfig& now) const;

 private:
  class Watcher;
  void work();
  void set_doing(const std::string& what, double fraction);

  const DeskLibrary& library_;
  const DeskCase one_;
  mutable std::mutex mutex_;
  Now now_;
  std::shared_ptr<const grid::HuVolume> scan_;
  std::map<std::string, std::shared_ptr<const DrawnField>> fields_;
  std::map<std::string, std::string> states_;  ///< of each field, shape_state
  std::shared_ptr<const config::CaseConfig> config_;
  std::atomic<bool> cancel_{false};
  std::thread thread_;
};

/// Throws Error 66 while the case is being opened and the anatomy's shape is not there yet: what is drawn then is drawn
/// blindly, and what is so already is not known.
void require_open(const OpenCase& one, const std::string& anatomy);

/// The voxels of one plane of the scan's lattice: those whose index along `axis` is `index`, the lower of the two other
/// axes fastest, as int16 HU. Throws Error 64 where there is no such plane.
std::string slice_bytes(const grid::HuVolume& scan, int axis, int index);
/// Of a field: four int32 (the first voxel along both axes, and how many), then int16; four zeros where it has none.
std::string slice_bytes(const DrawnField& field, int axis, int index);

/// The scan on a plane through any direction: `side` x `side` int16 from `corner` in steps of `right` and `down` (mm,
/// LPS), trilinear; -32768 beyond the scan. Throws Error 64 for a side that is not 1 to 1024, or a step that is not
/// finite.
std::string plane_bytes(const grid::HuVolume& scan, Vec3 corner_mm, Vec3 right_mm, Vec3 down_mm, int side);

}  // namespace trephine::desk

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "drill/bricks.h"
#include "drill/cutter_body.h"
#include "drill/hu_windows.h"
#include "drill/removal.h"
#include "drill/undo_log.h"

namespace trephine::drill {

/// Skin and what else cannot be drilled, to be removed around a point, slice by slice and row by row.
struct Incision {
  Vec3 middle_mm;
  double radius_mm = 0;
  grid::Box box;
  int slice = 0, row = 0;  ///< the next
  bool goes_on() const { return slice < box.end[2]; }
};

/// The voxels of a haptic volume, of which parts are removed and put back: fractions of a unit are kept, shapes that
/// share voxels keep to the rules of Drill, and whoever reads the volume is told what changed. A call begins with
/// begin() and ends with what removed() says; in between collect() and cut() may follow each other several times. Only
/// the constructor, make_room and keep_steps allocate.
class VoxelRemoval {
 public:
  static constexpr int incision_voxels = 4000;
  VoxelRemoval(voxel::HapticVolume& volume, const DrillShapes& shapes, const DrillParams& params, DirtyBricks* marks);
  /// For so many voxels in a pass, beside an incision.
  void make_room(std::size_t voxels);

  void begin();
  /// Of the whole call.
  Removal& removed() { return removed_; }
  /// Takes up the voxels of every m-th slice of which more is there than may stay, with their doses in s.
  void collect(const CutterBody& body, double time_s, int slice, int slices);
  /// Removes from them at the rate that uses up the budget, or at the largest one.
  void cut(double budget_j);
  /// Removes the next 4,000 voxels of an incision at most.
  void go_on(Incision& incision);

  /// Keeps the last steps of what is changed from then on.
  void keep_steps(int max_steps);
  UndoLog& log() { return log_; }
  /// All that may ever have changed lies in it.
  const grid::Box& ever() const { return ever_; }
  /// How many voxels a call puts back at most: put_back() for each, then end_back(), which forgets ever() where nothing
  /// is left of what was cut.
  static constexpr std::size_t max_put_back = 4000;
  void put_back(std::uint32_t at, std::int16_t raw, std::uint8_t fraction);
  std::size_t put_back_count() const { return changes_.size(); }
  void end_back(bool nothing_left);

 private:
  struct Entry {
    std::uint32_t at;
    std::int16_t i, j, k, fall;  ///< fall: of 1/255, or HU; the fraction is kept
    float dose, energy, left;    ///< s; J of the full voxel; share of a full voxel
    std::int16_t full;           ///< 255, or the HU of a full voxel
    std::int16_t stays = 0;      ///< what is not removed: of 1/255, or the HU that are left
  };
  struct Change {
    std::uint32_t at;
    std::int16_t i, j, k, raw;
  };
  struct Shared {
    std::uint32_t at;
    std::int16_t i, j, k, other;
  };
  double rate_for(double budget_j);
  void apply(double rate_per_s, bool incision);
  void lower(const Entry& e, bool incision);
  void lower_hu(const Entry& e, bool incision);
  void keep_shared();
  void store(bool incision);
  void mark_changes();
  void note(const Change& change);
  bool keeps_own(int own, int share, int other, int rest, bool incision) const;
  double energy_of(int shape, std::uint32_t at) const;
  bool removes(int shape, bool incision) const {
    const DrillShape& s = shapes_[std::size_t(shape)];
    return shape != 0 && s.cuttable && (s.energy_j_per_mm3 > 0) != incision;
  }

  static constexpr int fine = 256;  ///< steps of a unit of occupancy
  static constexpr std::uint8_t drilled = 1, incised = 2, shared = 4;
  voxel::HapticVolume& volume_;
  const DrillShapes shapes_;
  const double soft_energy_ratio_, max_rate_per_s_, voxel_mm3_;
  DirtyBricks* marks_;
  std::optional<HuWindows> hu_;         ///< of encoding `hu`
  std::vector<std::uint8_t> fraction_;  ///< of 1/255, or of a HU, by voxel
  std::vector<std::uint8_t> kind_;  ///< by raw value: 1 its shape is drilled, 2 incised, 4 the rest may be of another
  bool any_shared_ = false;
  std::vector<Entry> entries_;
  std::vector<Change> changes_;
  std::vector<Shared> shared_;
  std::vector<std::uint8_t> brick_marked_;
  grid::Box changing_, ever_;
  Removal removed_;
  UndoLog log_{0, 0, 0};
};

}  // namespace trephine::drill

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/vec3.h"
#include "phantom/chest_line.h"
#include "phantom/scan.h"

namespace trephine::phantom {

struct ChestParams {
  double clavicle_half_width_mm = 6, vein_half_width_mm = 5, artery_half_width_mm = 4;
  double vein_contrast_hu = 150;
  double chest_turned_deg = 0;
  int chest_seed = 0;  ///< 0: both sides are alike; else a chest of its own
  double shoulders_raised_deg = 0;
  ChestLine line;

  template <class V>
  static void describe(V& v) {
    using P = ChestParams;
    v.number(&P::clavicle_half_width_mm, "clavicle_half_width_mm", Range{4, 9},
             "Of a chest: half of a clavicle's width.");
    v.number(&P::vein_half_width_mm, "vein_half_width_mm", Range{2, 7},
             "Of a chest: half of a subclavian vein's width.");
    v.number(&P::artery_half_width_mm, "artery_half_width_mm", Range{2, 6}, "And of a subclavian artery's.");
    v.number(&P::vein_contrast_hu, "vein_contrast_hu", Range{0, 400},
             "Of a chest: how much brighter than muscle contrast medium makes the veins; 0: there is none.");
    v.number(&P::chest_turned_deg, "chest_turned_deg", Range{-15, 15},
             "Of a chest: turned about its length, as a patient who lies askew.");
    v.integer(&P::chest_seed, "chest_seed", Range{0, 1000000},
              "Of a chest: clavicles, ribs and shoulders of its own on each side, drawn by this number; 0: none.")
        .is_later();
    v.number(&P::shoulders_raised_deg, "shoulders_raised_deg", Range{-15, 15},
             "Of a chest: clavicles with their vessels turned up about their medial ends, as on another day. The truth "
             "of lines is that of a chest without it.")
        .is_later();
    v.all_of(&P::line);
  }
};

/// A chest with shoulders, of plain shapes that are known exactly: clavicles bent like an S, which touch a sternum and
/// an acromion by thin joints, ribs, a spine, two lungs below, and behind and below each clavicle its subclavian vein,
/// with the artery behind and above that. LPS, mm; the patient's length is z. Everything is positive inside, in about
/// mm near the surface.
class Chest {
 public:
  explicit Chest(const ChestParams& params = {});
  const ChestParams& params() const { return params_; }

  double skin(Vec3 p) const;
  double clavicle(Vec3 p) const;
  double other_bone(Vec3 p) const;
  double vein(Vec3 p) const;
  double artery(Vec3 p) const;
  double lung(Vec3 p) const;
  double line(Vec3 p) const;
  /// HU there, edges ramped over the width.
  double hu(Vec3 p, double width_mm) const;

  /// In the middle between the medial ends of the clavicles' middle lines.
  Vec3 notch_mm() const;
  /// The middle lines, from the medial end.
  std::vector<Vec3> clavicle_line(bool left) const { return turned(clavicles_[left].points); }
  std::vector<Vec3> vein_line(bool left) const { return turned(veins_[left].points); }
  std::vector<Vec3> artery_line(bool left) const { return turned(arteries_[left].points); }

  /// A central line in place.
  struct PutIn {
    bool left = false;
    std::vector<Vec3> course_mm;    ///< its middle, from where it lies free before the skin to its rounded end
    Vec3 skin_mm, vein_mm, tip_mm;  ///< where it passes the skin and first meets the vein; its tip
    double in_lung_mm = 0;
  };
  std::vector<PutIn> put_in() const;
  std::vector<Vec3> electrodes_mm() const;

 private:
  struct Line {
    std::vector<Vec3> points;
    Vec3 low, high;
    explicit Line(std::vector<Vec3> all = {});
    double to(Vec3 p, double reach_mm) const;  ///< the distance, or reach_mm and more where it is not nearer
  };
  /// What a chest has of its own, each side.
  struct Own {
    double length = 105, slope = 45, bow = 7, rise = 22, rib = 4, wide = 1;
    Vec3 acromion{7, 12, 8};
    std::array<double, 6> rib_up{};
  };
  void take_own();
  std::vector<Vec3> clavicle_points(bool left) const;
  void put_in_lines();
  double rod(const std::array<Line, 2>& lines, Vec3 p, double radius_mm) const;
  Vec3 rotated(Vec3 p, double angle) const;
  Vec3 unturned(Vec3 p) const { return rotated(p, -turn_); }
  std::vector<Vec3> turned(std::vector<Vec3> all) const;
  double bone_unturned(Vec3 p) const;

  ChestParams params_;
  double turn_;
  std::array<Own, 2> own_;  ///< right, left
  double spine_x_ = 0;
  std::array<Line, 2> clavicles_, veins_, arteries_, joints_;  ///< right, left
  std::array<Line, 2> outer_joints_;
  std::vector<Line> lines_;
  std::vector<Vec3> electrodes_;
};

/// The chest as a scanner with those parameters sees it: the middle of the scanner's default block is 5 mm below the
/// height of the veins' ends. The same bytes whatever the thread count. Cancelled.
Scan scan(const ChestParams& chest, const ScanParams& params, std::uint64_t seed, const Progress& progress = {});

/// Writes truth.json into `folder` (made where missing): the parameters, the sternal notch, and of each side the middle
/// lines of clavicle, vein and artery; and, of slices that are a lattice, labels.nrrd: 1 soft tissue, 2 clavicle, 3
/// other bone, 4 vein, 5 artery, 6 lung. Of central lines `put_in` holds where each lies in the chest without pose and
/// raised shoulders; chest_to_scan leads from there to the scan, but for what the clavicles carry. Returns how many
/// middle lines there are. Throws 73 and 74 as FileWriter.
std::int64_t write_truth(const std::filesystem::path& folder, const ChestParams& chest, const Scan& scan,
                         const ScanParams& params, bool labels);

}  // namespace trephine::phantom

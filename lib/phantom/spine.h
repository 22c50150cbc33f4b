// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/vec3.h"
#include "phantom/chest.h"
#include "phantom/scan.h"
#include "phantom/spine_screws.h"

namespace trephine::phantom {

/// A lumbar spine of plain shapes whose pedicles are known exactly: bodies, pedicles that are narrowest in their
/// middle, articular masses, transverse processes, arches with spinous processes, a canal, and skin. LPS, mm; the canal
/// runs along z.
struct SpineParams {
  int vertebrae_count = 3;
  double pitch_mm = 34;        ///< from one vertebra to the next
  double half_width_mm = 4.5;  ///< of a pedicle, where it is narrowest
  double half_height_mm = 7.5;
  double converging_deg = 16;  ///< how far a pedicle's axis leans to the middle, going forwards
  double rising_deg = 4;       ///< and upwards
  double turned_deg = 0;       ///< of the whole spine about z: the patient lies askew
  int vertebrae_seed = 0;      ///< 0: all vertebrae are alike; else each has its own shape
  double bend_deg = 0;         ///< each vertebra is turned about x by that much against the one below
  SpineScrews screws;

  /// How many vertebrae there are is not declared: as many as the scan is high.
  template <class V>
  static void describe(V& v) {
    using P = SpineParams;
    v.number(&P::pitch_mm, "vertebra_pitch_mm", Range{30, 50}, "Of a spine: from one vertebra to the next.");
    v.number(&P::half_width_mm, "pedicle_half_width_mm", Range{2, 7},
             "Of a spine: half the width of a pedicle where it is narrowest.");
    v.number(&P::half_height_mm, "pedicle_half_height_mm", Range{4, 9}, "And half its height there.");
    v.number(&P::converging_deg, "pedicle_converging_deg", Range{0, 30},
             "Of a spine: how far a pedicle's axis leans to the middle, going forwards.");
    v.number(&P::rising_deg, "pedicle_rising_deg", Range{-10, 15}, "And upwards.");
    v.number(&P::turned_deg, "turned_deg", Range{-15, 15},
             "Of a spine: turned about its length, as a patient who lies askew.");
    v.integer(&P::vertebrae_seed, "vertebrae_seed", Range{0, 1000000},
              "Of a spine: each vertebra has its own shape, drawn by this number; 0: all are alike.")
        .is_later();
    v.number(&P::bend_deg, "vertebra_bend_deg", Range{-8, 8},
             "Of a spine: how far each vertebra leans back against the one below, as on another day. The middle one "
             "is not moved; the truth of screws is that of a spine that is not bent.")
        .is_later();
    v.all_of(&P::screws);
  }
};

/// Which body a phantom is.
struct BodyParams {
  enum class Body { head, spine, chest };
  Body body = Body::head;
  SpineParams spine;
  ChestParams chest;
  template <class V>
  static void describe(V& v) {
    using P = BodyParams;
    v.choice(
        &P::body, "body", {{"head", Body::head}, {"spine", Body::spine}, {"chest", Body::chest}},
        "A head, a lumbar spine of plain shapes whose pedicles are known, or a chest of plain shapes with clavicles, "
        "subclavian vessels and lungs; parameters of another one are refused.");
    v.all_of(&P::spine);
    v.all_of(&P::chest);
  }
};

/// Everything is positive inside, about in mm near the surface.
class Spine {
 public:
  explicit Spine(const SpineParams& params = {});
  const SpineParams& params() const { return params_; }

  /// The axis of a pedicle: its narrowest place, and the unit direction forwards. Vertebra 0 is the lowest.
  struct Pedicle {
    int vertebra = 0;
    bool left = false;
    Vec3 middle_mm, forwards;
    double half_width_mm = 0;
  };
  /// Of the spine as it is bent.
  std::vector<Pedicle> pedicles() const;
  double level(int n) const { return params_.pitch_mm * (n - 0.5 * (params_.vertebrae_count - 1)); }

  double bone(Vec3 world) const;
  double canal(Vec3 world) const;
  /// A back with a furrow, in which the spinous processes are seen and palpated.
  double skin(Vec3 world) const;
  double metal(Vec3 world) const;
  /// The same of one vertebra alone.
  double bone_of(int vertebra, Vec3 world) const;

  /// A screw in place, as the spine is bent.
  struct Screw {
    int vertebra = 0;
    bool left = false;
    Vec3 tip_mm, seat_mm;  ///< the end of the shaft, and where the head begins
    Vec3 axis() const { return normalized(tip_mm - seat_mm); }
  };
  const std::vector<Screw>& screws() const { return screws_; }
  /// From a place of the spine that is not bent to the same place of that vertebra.
  Vec3 bent(int vertebra, Vec3 world) const;

 private:
  static constexpr double canal_x = 11, canal_y = 8.5, canal_at = 26;
  /// What one vertebra has of its own.
  struct Shape {
    double half_width = 4.5, half_height = 7.5;
    double body_x = 24, body_y = 17, body_z = 12, spine_y = 66, spine_z = 9, spine_lean = 0;
    double mass[2] = {1, 1}, transverse[2] = {22, 22}, transverse_back[2] = {4, 4}, transverse_up[2] = {1, 1};
    struct Spur {
      Vec3 at;
      double radius;
    };
    std::vector<Spur> spurs;  ///< on the rim of the body
  };
  /// How it lies on the spine, and the shape it has.
  struct Vertebra {
    double lean = 0;  ///< about x
    Vec3 at;
    Shape is;
  };
  Vertebra made(int n) const;
  Vec3 forwards(double side) const;
  Vec3 pedicle_middle(const Shape& is, double side) const { return {side * (canal_x + 0.5 + is.half_width), 20, 5}; }
  Vec3 to_local(const Vertebra& v, Vec3 unturned) const;
  Vec3 from_local(const Vertebra& v, Vec3 local) const;
  void put_in_screws();

  static Vec3 rotated(Vec3 p, double a) {
    return {p.x * std::cos(a) - p.y * std::sin(a), p.x * std::sin(a) + p.y * std::cos(a), p.z};
  }
  Vec3 turned(Vec3 p) const { return rotated(p, turn_); }
  Vec3 unturned(Vec3 p) const { return rotated(p, -turn_); }
  static double ellipse(double x, double y, double rx, double ry) {
    const double k = std::hypot(x / rx, y / ry), g = std::hypot(x / (rx * rx), y / (ry * ry));
    return k < 1e-9 ? std::min(rx, ry) : k * (1 - k) / g;
  }
  double canal_of(Vec3 p) const { return ellipse(p.x, p.y - canal_at, canal_x, canal_y); }
  double vertebra(const Shape& is, Vec3 local) const;

  SpineParams params_;
  double turn_;
  std::vector<Vertebra> vertebrae_;
  std::vector<Screw> screws_;
  std::vector<std::pair<Vec3, Vec3>> rods_;
};

/// A lattice of whole vertebrae with that spacing, from 22 mm below the lowest one's middle to as far above the
/// highest.
inline grid::Lattice lattice_about(const Spine& spine, Vec3 spacing, double half_width_mm = 75) {
  const int last = spine.params().vertebrae_count - 1;
  const double low = spine.level(0) - 22, high = spine.level(last) + 22;
  grid::Lattice l;
  l.spacing_mm = spacing;
  l.origin_mm = {-half_width_mm, 10 - half_width_mm, low};
  l.size = {int(2 * half_width_mm / spacing.x) + 1, int(2 * half_width_mm / spacing.y) + 1,
            int((high - low) / spacing.z) + 1};
  return l;
}

/// A scan of it: cortical bone over marrow, soft tissue, air, a canal as water; partial volume over a voxel, and noise.
grid::Grid<std::int16_t> scan_of(const Spine& spine, const grid::Lattice& lattice, double noise_hu = 15,
                                 std::uint64_t seed = 1);

/// The spine as a scanner with those parameters sees it: its middle lies where that of the scanner's default block
/// does, and there are as many vertebrae as the block is high, those at its ends cut. Tissue as in scan_of, averaged
/// over the slice's thickness; then the kernel and its noise. The same bytes whatever the thread count. Cancelled.
Scan scan(const SpineParams& spine, const ScanParams& params, std::uint64_t seed, const Progress& progress = {});

/// Writes truth.json into `folder` (made where missing): the parameters, and of each pedicle that the scan shows whole
/// its name (pedicle_1_left from below, as `trephine pedicles` counts), entry, target, middle and half-width; and, of
/// slices that are a lattice, labels.nrrd: 1 soft tissue, 2 bone, 3 canal. Of screws `put_in` holds where each lies in
/// the spine as it is without bend and pose, and how far it stands out of the bone at the pedicle. Returns how many
/// such pedicles there are.
/// Throws 73 and 74 as FileWriter.
std::int64_t write_truth(const std::filesystem::path& folder, const SpineParams& spine, const Scan& scan,
                         const ScanParams& params, bool labels);

}  // namespace trephine::phantom

#include "phantom/spine_shapes.h"  // IWYU pragma: keep

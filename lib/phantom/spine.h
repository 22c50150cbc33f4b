// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/vec3.h"
#include "phantom/chest.h"
#include "phantom/scan.h"

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
  explicit Spine(const SpineParams& params = {}) : params_(params), turn_(params.turned_deg * M_PI / 180) {}
  const SpineParams& params() const { return params_; }

  /// The axis of a pedicle: its narrowest place, and the unit direction forwards. Vertebra 0 is the lowest.
  struct Pedicle {
    int vertebra = 0;
    bool left = false;
    Vec3 middle_mm, forwards;
    double half_width_mm = 0;
  };
  std::vector<Pedicle> pedicles() const {
    std::vector<Pedicle> all;
    for (int n = 0; n < params_.vertebrae_count; ++n)
      for (const bool left : {true, false}) {
        const double side = left ? 1 : -1;
        const double c = params_.converging_deg * M_PI / 180, r = params_.rising_deg * M_PI / 180;
        const Vec3 forwards{-side * std::sin(c) * std::cos(r), -std::cos(c) * std::cos(r), std::sin(r)};
        const Vec3 middle{side * (canal_x + 0.5 + params_.half_width_mm), 20, level(n) + 5};
        all.push_back({n, left, turned(middle), turned(forwards), params_.half_width_mm});
      }
    return all;
  }
  double level(int n) const { return params_.pitch_mm * (n - 0.5 * (params_.vertebrae_count - 1)); }

  double bone(Vec3 world) const {
    const Vec3 p = unturned(world);
    double best = -1e3;
    for (int n = 0; n < params_.vertebrae_count; ++n)
      if (std::abs(p.z - level(n)) < params_.pitch_mm) best = std::max(best, vertebra(n, p));
    return std::min(best, -canal_of(p));
  }
  double canal(Vec3 world) const { return canal_of(unturned(world)); }
  double skin(Vec3 world) const {
    const Vec3 p = unturned(world);
    return ellipse(p.x, p.y - 10, 110, 85);
  }

 private:
  static constexpr double canal_x = 11, canal_y = 8.5, canal_at = 26;
  Vec3 rotated(Vec3 p, double a) const {
    return {p.x * std::cos(a) - p.y * std::sin(a), p.x * std::sin(a) + p.y * std::cos(a), p.z};
  }
  Vec3 turned(Vec3 p) const { return rotated(p, turn_); }
  Vec3 unturned(Vec3 p) const { return rotated(p, -turn_); }

  static double ellipse(double x, double y, double rx, double ry) {
    const double k = std::hypot(x / rx, y / ry), g = std::hypot(x / (rx * rx), y / (ry * ry));
    return k < 1e-9 ? std::min(rx, ry) : k * (1 - k) / g;
  }
  double canal_of(Vec3 p) const { return ellipse(p.x, p.y - canal_at, canal_x, canal_y); }
  static double ball(Vec3 d, Vec3 r) {
    const Vec3 s{d.x / r.x, d.y / r.y, d.z / r.z};
    const double k = norm(s), g = norm({s.x / r.x, s.y / r.y, s.z / r.z});
    return k < 1e-9 ? std::min({r.x, r.y, r.z}) : k * (1 - k) / g;
  }
  static double rod(Vec3 p, Vec3 a, Vec3 b, double radius) {
    const Vec3 ab = b - a;
    return radius - norm(p - a - ab * std::clamp(dot(p - a, ab) / dot(ab, ab), 0.0, 1.0));
  }

  double vertebra(int n, Vec3 world) const {
    const Vec3 p{world.x, world.y, world.z - level(n)};
    if (std::abs(p.x) > 60 || p.y < -25 || p.y > 75) return -1e3;           // nothing of it is so far off
    double best = std::min(ellipse(p.x, p.y, 24, 17), 12 - std::abs(p.z));  // the body
    for (const double side : {1.0, -1.0}) {
      const double c = params_.converging_deg * M_PI / 180, r = params_.rising_deg * M_PI / 180;
      const Vec3 f{-side * std::sin(c) * std::cos(r), -std::cos(c) * std::cos(r), std::sin(r)};
      const Vec3 middle{side * (canal_x + 0.5 + params_.half_width_mm), 20, 5};
      const Vec3 across = normalized(cross(f, {0, 0, 1})), up = cross(across, f), d = p - middle;
      const double t = dot(d, f), wider = 0.012 * t * t;
      const double tube =
          ellipse(dot(d, across), dot(d, up), params_.half_width_mm + wider, params_.half_height_mm + wider);
      best = std::max(best, std::min({tube, t + 16, 16 - t}));
      const Vec3 mass = middle - f * 15;
      best = std::max(best, ball(p - mass, {8, 8, 13}));
      best = std::max(best, rod(p, mass, mass + Vec3{side * 22, 4, 1}, 4));  // transverse process
    }
    // The arch behind the canal, and the spinous process.
    const double ring = std::min(ellipse(p.x, p.y - canal_at, canal_x + 5, canal_y + 5), 9 - std::abs(p.z + 2));
    best = std::max(best, std::min(ring, p.y - canal_at));
    best = std::max(best, std::min({3.5 - std::abs(p.x), p.y - canal_at - canal_y, 66 - p.y, 9 - std::abs(p.z + 4)}));
    return best;
  }

  SpineParams params_;
  double turn_;
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
/// slices that are a lattice, labels.nrrd: 1 soft tissue, 2 bone, 3 canal. Returns how many such pedicles there are.
/// Throws 73 and 74 as FileWriter.
std::int64_t write_truth(const std::filesystem::path& folder, const SpineParams& spine, const Scan& scan,
                         const ScanParams& params, bool labels);

}  // namespace trephine::phantom

// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/surface_field.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "base/parallel.h"
#include "base/rank.h"
#include "grid/sample.h"
#include "mask/hu_view.h"

namespace trephine::mask {
namespace {

struct Tap {
  int i, j, k;
  float weight;
};

std::vector<Tap> cut_kernel(const grid::Lattice& l, double sigma_mm) {
  int reach[3];
  for (int a = 0; a < 3; ++a) reach[a] = std::clamp(int(std::lround(2 * sigma_mm / l.spacing_mm[a])), 1, 8);
  std::vector<Tap> taps;
  double sum = 0;
  for (int k = -reach[2]; k <= reach[2]; ++k)
    for (int j = -reach[1]; j <= reach[1]; ++j)
      for (int i = -reach[0]; i <= reach[0]; ++i) {
        const Vec3 d{i * l.spacing_mm.x, j * l.spacing_mm.y, k * l.spacing_mm.z};
        const double w = std::exp(-dot(d, d) / (2 * sigma_mm * sigma_mm));
        taps.push_back({i, j, k, float(w)});
        sum += w;
      }
  for (Tap& t : taps) t.weight = float(t.weight / sum);
  return taps;
}

/// The mask smoothed at one voxel, as a signed share from -1 to 1. It is never nearer to 0 than 0.02 and never on the
/// wrong side.
float smoothed(const BitMask& shape, const std::vector<Tap>& kernel, int i, int j, int k, bool inside) {
  const grid::Lattice& l = shape.lattice();
  float sum = 0;
  for (const Tap& t : kernel) {
    const int x = std::clamp(i + t.i, 0, l.size[0] - 1), y = std::clamp(j + t.j, 0, l.size[1] - 1),
              z = std::clamp(k + t.k, 0, l.size[2] - 1);
    sum += t.weight * shape.get(x, y, z);
  }
  const float share = 2 * sum - 1;
  return inside ? std::max(share, 0.02f) : std::min(share, -0.02f);
}

}  // namespace

std::size_t place_surface(grid::Field& edge, const BitMask& shape, double cut_sigma_mm, double scale_hu,
                          const Progress& progress) {
  const grid::Lattice& l = edge;
  const auto kernel = cut_kernel(l, cut_sigma_mm);
  const float scale = float(scale_hu), least = 0.002f * scale;
  const BitMask material = make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = edge.at(i, j, k) > 0;
  });
  // The voxels beside a voxel of the other kind.
  BitMask outside = shape, rim = dilated_6(shape);
  outside.invert();
  BitMask inner = dilated_6(outside);
  rim &= outside;
  inner &= shape;
  rim |= inner;
  std::atomic<std::size_t> cut{0};
  parallel_for(0, l.size[2], 2, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    std::size_t cut_here = 0;
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          float& f = edge.at(i, j, k);
          const bool inside = shape.get(i, j, k);
          if (!rim.get(i, j, k)) {
            f = inside ? std::max(f, scale) : std::min(f, -scale);
            if (!std::isfinite(f)) f = inside ? least : -least;
            continue;
          }
          // What the six neighbours are, for the crossing on each lattice edge lies between this voxel and one of them.
          bool other_material = false, shape_material = false;
          const bool is_material = material.get(i, j, k);
          for (int axis = 0; axis < 3; ++axis)
            for (int side : {-1, 1}) {
              const int x = i + (axis == 0) * side, y = j + (axis == 1) * side, z = k + (axis == 2) * side;
              if (!l.contains(x, y, z) || shape.get(x, y, z) == inside) continue;
              if (material.get(x, y, z)) (inside ? other_material : shape_material) = true;
            }
          if (inside) {
            const bool at_cut = !is_material || other_material;
            cut_here += at_cut;
            if (!is_material)
              f = scale * smoothed(shape, kernel, i, j, k, true);
            else if (other_material)
              f = std::min(f, scale * smoothed(shape, kernel, i, j, k, true));
            f = std::max(f, least);
          } else {
            if (is_material || !shape_material) f = scale * smoothed(shape, kernel, i, j, k, false);
            f = std::min(f, -least);
          }
          if (!std::isfinite(f)) f = inside ? least : -least;
        }
    cut += cut_here;
  });
  return cut;
}

namespace {

/// Values of the field along a ray.
float sample(const grid::Field& f, double x, double y, double z) {
  return grid::sampled<float>(f, {x, y, z}, grid::nearest_beyond);
}

Vec3 gradient(const grid::Field& f, int i, int j, int k) {
  // Central differences, smoothed over the 3 x 3 neighbours across: 12 HU of noise turn a bone edge by at most one
  // degree.
  Vec3 g;
  const auto at = [&](int x, int y, int z) {
    return f.at(std::clamp(x, 0, f.size[0] - 1), std::clamp(y, 0, f.size[1] - 1), std::clamp(z, 0, f.size[2] - 1));
  };
  for (int a = -1; a <= 1; ++a)
    for (int b = -1; b <= 1; ++b) {
      const double w = (2 - std::abs(a)) * (2 - std::abs(b)) / 16.0;
      g.x += w * (at(i + 1, j + a, k + b) - at(i - 1, j + a, k + b));
      g.y += w * (at(i + a, j + 1, k + b) - at(i + a, j - 1, k + b));
      g.z += w * (at(i + a, j + b, k + 1) - at(i + a, j + b, k - 1));
    }
  return {g.x / f.spacing_mm.x, g.y / f.spacing_mm.y, g.z / f.spacing_mm.z};
}

constexpr float sharp_mm = 0.9f;  ///< slices this thin hardly blur a table of bone
// A table of the skull in the model: its thickness, the HU of the spongy bone under it as a share of its own, and the
// blur of a usual kernel.
constexpr double table_mm = 1.8, spongy_ratio = 0.4, kernel_sigma_mm = 0.4;
struct Profile {
  float high, low;
  bool leaves;        ///< the path downhill leaves the mask
  float blur_mm = 0;  ///< blur by the slices' thickness along the path
};

Profile profile(const grid::Field& hu, const BitMask& shape, int i, int j, int k, float ceiling, double reach_mm,
                double step_mm) {
  const Vec3 uphill = normalized(gradient(hu, i, j, k));
  const Vec3 step{uphill.x * step_mm / hu.spacing_mm.x, uphill.y * step_mm / hu.spacing_mm.y,
                  uphill.z * step_mm / hu.spacing_mm.z};
  const float here = std::min(hu.at(i, j, k), ceiling);
  Profile p{here, here, !shape.get(i, j, k), 0};
  // A reversal by more than a tenth of the contrast so far, and by more than noise, ends the profile: there another
  // structure begins.
  const auto turned = [&](float back) { return back > 40 && back > 0.1f * (p.high - p.low); };
  // Slices also blur by their thickness, so a profile across them takes longer to end.
  p.blur_mm = float(std::abs(uphill.z) * hu.spacing_mm.z);
  const int steps = int(std::sqrt(reach_mm * reach_mm + double(p.blur_mm) * p.blur_mm) / step_mm);
  for (int s = 1; s <= steps; ++s) {
    const float v = std::min(sample(hu, i + s * step.x, j + s * step.y, k + s * step.z), ceiling);
    p.high = std::max(p.high, v);
    if (turned(p.high - v)) break;
  }
  for (int s = 1; s <= steps; ++s) {
    const double x = i - s * step.x, y = j - s * step.y, z = k - s * step.z;
    const float v = std::min(sample(hu, x, y, z), ceiling);
    p.low = std::min(p.low, v);
    if (turned(v - p.low)) break;
    const int a = int(std::lround(x)), b = int(std::lround(y)), c = int(std::lround(z));
    if (shape.lattice().contains(a, b, c)) p.leaves = p.leaves || !shape.get(a, b, c);
  }
  return p;
}

/// The HU that tables of bone reach where the slices' thickness does not blur them.
float compact_bone(const std::vector<Profile>& profiles) {
  std::vector<float> high;
  for (std::size_t n = 0; n < profiles.size(); n += 7)
    if (profiles[n].leaves && profiles[n].blur_mm < sharp_mm) high.push_back(profiles[n].high);
  return high.size() < 100 ? 0 : value_at_rank(high, high.size() * 3 / 4);
}

/// The share of an edge that lies before x, blurred by slices of `thick_mm` along the path, by linear interpolation
/// between them (a quadratic B-spline on average), and by the kernel.
double passed(double x, double thick_mm) {
  constexpr int half = 12;
  double sum = 0, weights = 0;
  for (int n = -half; n <= half; ++n) {
    const double z = 3.0 * n / half, weight = std::exp(-0.5 * z * z);
    const double u = (x - z * kernel_sigma_mm) / thick_mm, a = std::abs(u);
    const double beyond = a >= 1.5 ? 0 : a > 0.5 ? std::pow(1.5 - a, 3) / 6 : 0.5 - a * (0.75 - a * a / 3);
    sum += weight * (u > 0 ? 1 - beyond : beyond);
    weights += weight;
  }
  return sum / weights;
}

constexpr int gain_steps = 32;
constexpr double gain_step_mm = 0.2;

/// A table thinner than the blur never reaches its own HU, and the level at half of what it reaches lies outside of it.
/// The gain is the value at the table's edge divided by that half, for each blur along the path (in steps of
/// gain_step_mm). It is computed for a table and is about the same for plates and thicker tables.
std::array<float, gain_steps> edge_gains() {
  std::array<float, gain_steps> gains;
  for (int n = 0; n < gain_steps; ++n) {
    const double thick = std::max(0.01, n * gain_step_mm);
    const auto value = [&](double x) {
      const double bone = passed(x, thick), spongy = passed(x - table_mm, thick);
      return bone - (1 - spongy_ratio) * spongy;
    };
    double high = 0;
    for (double x = 0; x < 4; x += 0.05) high = std::max(high, value(x));
    gains[n] = float(std::max(1.0, 2 * value(0) / high));
  }
  return gains;
}

/// The HU of which half is taken at the bone's edge. Thick bone does reach its HU, so the result is at most `compact`.
float unblurred(const Profile& p, float compact, const std::array<float, gain_steps>& gains, float water) {
  const float at = std::min(p.blur_mm / float(gain_step_mm), float(gain_steps - 1));
  const int n = std::min(int(at), gain_steps - 2);
  const float gain = gains[n] + (at - float(n)) * (gains[n + 1] - gains[n]);
  return std::max(p.high, std::min(compact, water + gain * (p.high - water)));
}

}  // namespace

void apply_half_maximum(grid::Field& hu, BitMask& shape, double lower_hu, double reach_mm, double brightest_hu,
                        const Progress& progress) {
  const grid::Lattice& l = hu;
  BitMask outside = shape;
  outside.invert();
  // Every voxel that may lose its bone, also those of the next slice however thick it is.
  BitMask shell = dilated(outside, std::hypot(reach_mm, hu.spacing_mm.z), progress);
  shell &= shape;
  BitMask rim = dilated_6(shape);
  rim.remove(shape);
  shell |= rim;
  // The new values go into a copy that covers the shell alone, because rays must read the old ones.
  std::vector<std::size_t> first(std::size_t(l.size[2]) + 1);
  parallel_for(0, l.size[2], 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) first[k + 1] += shell.get(i, j, k);
  });
  for (int k = 0; k < l.size[2]; ++k) first[k + 1] += first[k];
  std::vector<Profile> profiles(first.back());
  const Vec3 sp = l.spacing_mm;
  const double step_mm = 0.5 * std::min({sp.x, sp.y, sp.z});
  const float ceiling = float(brightest_hu - lower_hu);
  parallel_for(0, l.size[2], 2, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (int k = int(from); k < to; ++k) {
      std::size_t n = first[k];
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          if (!shell.get(i, j, k)) continue;
          profiles[n++] = profile(hu, shape, i, j, k, ceiling, reach_mm, step_mm);
        }
    }
  });
  const float compact = compact_bone(profiles), water = float(-lower_hu);
  const auto gains = edge_gains();
  parallel_for(0, l.size[2], 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k) {
      std::size_t n = first[k];
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          if (!shell.get(i, j, k)) continue;
          float& v = hu.at(i, j, k);
          const bool was_material = v > 0;
          const Profile& p = profiles[n++];
          if (p.leaves) v -= std::max(0.f, 0.5f * (unblurred(p, compact, gains, water) + p.low));
          if (was_material && v <= 0) shape.clear(i, j, k);
        }
    }
  });
}

std::vector<bool> turned_by_contour(const grid::Field& field, double min_component_mm3, const Progress& progress) {
  const BitMask inside = positive(field, field);
  BitMask shape = inside;
  shape |= holes(inside, {0, 1e9, false}, progress);
  const Components pieces = components(shape, true);
  std::vector<char> keep;
  std::size_t most = 0;
  for (const Component& c : pieces.list) most = std::max(most, c.voxels);
  for (const Component& c : pieces.list)
    keep.push_back(c.voxels == most || double(c.voxels) * field.voxel_volume_mm3() >= min_component_mm3);
  shape = select(pieces, keep);
  BitMask other = without(shape, inside);
  other |= without(inside, shape);
  if (!other.any()) return {};
  std::vector<bool> turned(field.count(), false);
  for (int k = 0; k < field.size[2]; ++k)
    for (int j = 0; j < field.size[1]; ++j)
      for (int w = 0; w < other.words(); ++w)
        for (std::uint64_t bits = other.row(j, k)[w]; bits; bits &= bits - 1)
          turned[field.index(64 * w + __builtin_ctzll(bits), j, k)] = true;
  return turned;
}

}  // namespace trephine::mask

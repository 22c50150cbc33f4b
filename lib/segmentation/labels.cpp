// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/labels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "base/text.h"
#include "mask/filters.h"
#include "mask/hu_view.h"
#include "mask/surface_field.h"
#include "segmentation/label_raster.h"
#include "surface/bounds.h"

namespace trephine::segmentation {
namespace {

using mask::BitMask;
using mask::HuView;

constexpr double air_hu = -900;
constexpr double noted_ratio = 0.01, noted_air_ratio = 0.2, noted_change_ratio = 0.02;
constexpr int margin = 3;

std::string percent(double ratio) { return to_text(std::round(ratio * 1000) / 10) + " %"; }
std::string at_text(Vec3 p) {
  const auto mm = [](double v) { return to_text(std::round(v * 10) / 10 + 0.0); };
  return "(" + mm(p.x) + ", " + mm(p.y) + ", " + mm(p.z) + ") mm";
}

BitMask bits_of(const grid::Mask& mask) {
  return mask::make_mask(mask, [&](int j, int k, std::uint8_t* row) {
    std::copy_n(&mask.voxels[mask.index(0, j, k)], mask.size[0], row);
  });
}

struct Fit {
  double outside = 0, air = 0;  ///< shares of the label's voxels
};

/// Of at most about 200,000 of the label's voxels, evenly taken; `flip` negates x and y.
Fit fit_of(const HuView& hu, const grid::Mask& mask, std::size_t voxels, bool flip) {
  const grid::Lattice& l = hu.lattice();
  const std::size_t step = voxels / 200000 + 1;
  std::size_t n = 0, taken = 0, outside = 0, air = 0;
  for (int k = 0; k < mask.size[2]; ++k)
    for (int j = 0; j < mask.size[1]; ++j)
      for (int i = 0; i < mask.size[0]; ++i) {
        if (!mask.at(i, j, k) || n++ % step) continue;
        ++taken;
        Vec3 p = mask.to_world_mm({double(i), double(j), double(k)});
        if (flip) p = {-p.x, -p.y, p.z};
        const Vec3 q = l.to_index(p);
        bool in = true;
        int at[3];
        for (int a = 0; a < 3; ++a) {
          in = in && q[a] >= -0.5 && q[a] < l.size[a] - 0.5;
          at[a] = in ? std::max(0, int(std::floor(q[a] + 0.5))) : 0;
        }
        if (!in)
          ++outside;
        else
          air += hu(std::min(at[0], l.size[0] - 1), std::min(at[1], l.size[1] - 1), std::min(at[2], l.size[2] - 1)) <
                 air_hu;
      }
  return {double(outside) / double(taken), double(air) / double(taken)};
}

/// A hint where the label would lie in the body with x and y negated.
std::string hint(const HuView& hu, const grid::Mask& mask, std::size_t voxels, const Fit& is) {
  const Fit flipped = fit_of(hu, mask, voxels, true);
  return flipped.outside + flipped.air < 0.5 * (is.outside + is.air) && flipped.outside + flipped.air < 0.3
             ? "; with x and y negated it would fit: RAS was taken for LPS, or the reverse"
             : "";
}

using Made = Outcome<grid::Field, LabelResult>;

/// Returns the share of the label outside of the volume.
double check_fit(const HuView& hu, const grid::PickedLabel& label, const LabelParams& params, Made& made) {
  const Fit fit = fit_of(hu, label.mask, label.voxels, false);
  made.result.outside_ratio = fit.outside;
  made.result.air_ratio = fit.air;
  if (fit.outside >= 1 || fit.outside > params.max_outside_ratio) {
    const grid::Lattice& l = hu.lattice();
    const grid::Box box = bits_of(label.mask).bounds();
    const Vec3 middle =
        label.mask.to_world_mm({(box.begin[0] + box.end[0] - 1) / 2.0, (box.begin[1] + box.end[1] - 1) / 2.0,
                                (box.begin[2] + box.end[2] - 1) / 2.0});
    throw refusal(
        "label",
        percent(fit.outside) + " of it lie outside of the volume, its middle at " + at_text(middle) +
            ", the volume's at " +
            at_text(l.to_world_mm({(l.size[0] - 1) / 2.0, (l.size[1] - 1) / 2.0, (l.size[2] - 1) / 2.0})) +
            hint(hu, label.mask, label.voxels, fit),
        {"paint it on this very series; where only a part of it was scanned, raise `max_outside_ratio` (to less than "
         "1)"});
  }
  if (fit.air > params.max_air_ratio)
    throw refusal(
        "label", percent(fit.air) + " of it lie in air, outside of the body?" + hint(hu, label.mask, label.voxels, fit),
        {"where that is right, raise `max_air_ratio`"});
  if (fit.outside > noted_ratio)
    made.warnings.push_back({"label_outside",
                             "{outside} of the label lie outside of the volume and are left out",
                             {{"outside", percent(fit.outside)}}});
  if (fit.air > noted_air_ratio)
    made.warnings.push_back({"label_in_air",
                             "{in_air} of the label lie in air{hint}",
                             {{"in_air", percent(fit.air)}, {"hint", hint(hu, label.mask, label.voxels, fit)}}});
  return fit.outside;
}

/// A mask as a field of about -1 to 1 with the mask's signs, smooth across its surface.
grid::Field smooth_field(const BitMask& mask, double sigma_mm, const Progress& progress) {
  const grid::Lattice& l = mask.lattice();
  const double mean = std::cbrt(l.voxel_volume_mm3());
  grid::Field field(l, -1.f);
  mask::place_surface(field, mask, sigma_mm > 0 ? sigma_mm : mean, 1, progress);
  return field;
}

/// The box around the set voxels, with a margin that may reach beyond the lattice.
grid::Lattice padded(const grid::Lattice& l, const grid::Box& box) {
  grid::Lattice out = l;
  out.origin_mm =
      l.to_world_mm({double(box.begin[0] - margin), double(box.begin[1] - margin), double(box.begin[2] - margin)});
  for (int a = 0; a < 3; ++a) out.size[a] = box.end[a] - box.begin[a] + 2 * margin;
  return out;
}

float linear(const grid::Field& f, Vec3 q, float otherwise) {
  int low[3];
  float t[3];
  for (int a = 0; a < 3; ++a) {
    if (!(q[a] >= 0 && q[a] <= f.size[a] - 1)) return otherwise;
    low[a] = std::min(int(q[a]), f.size[a] - 2);
    t[a] = float(q[a] - low[a]);
  }
  const auto line = [&](int j, int k) {
    const float* p = &f.voxels[f.index(low[0], low[1] + j, low[2] + k)];
    return p[0] + t[0] * (p[1] - p[0]);
  };
  const float a = line(0, 0) + t[1] * (line(1, 0) - line(0, 0)), b = line(0, 1) + t[1] * (line(1, 1) - line(0, 1));
  return a + t[2] * (b - a);
}

/// The signed distance to the label's own surface, at the volume's voxels around it.
grid::Field resampled(const grid::Mask& label, const grid::Lattice& volume, double sigma_mm, const Progress& progress) {
  const BitMask all = bits_of(label);
  const grid::Lattice own = padded(label, all.bounds());
  grid::Field distance = mask::signed_distance_mm(smooth_field(mask::placed(all, own), sigma_mm, progress), progress);
  grid::Box box{volume.size, {0, 0, 0}};
  for (const Vec3 corner : surface::corners_of(own)) {
    const Vec3 p = volume.to_index(corner);
    for (int a = 0; a < 3; ++a) {
      box.begin[a] = std::min(box.begin[a], int(std::clamp(std::floor(p[a]), 0.0, double(volume.size[a]))));
      box.end[a] = std::max(box.end[a], int(std::clamp(std::ceil(p[a]) + 1, 0.0, double(volume.size[a]))));
    }
  }
  grid::Field out(grid::cropped(volume, box));
  const float far = -float(norm(label.spacing_mm));
  parallel_for(0, out.size[2], 1, [&](std::int64_t k, std::int64_t) {
    progress.check();
    for (int j = 0; j < out.size[1]; ++j)
      for (int i = 0; i < out.size[0]; ++i) {
        const float v = linear(distance, own.to_index(out.to_world_mm({double(i), double(j), double(k)})), far);
        out.at(i, j, int(k)) = std::abs(v) < 1e-4f ? (v < 0 ? -1e-4f : 1e-4f) : v;
      }
  });
  return out;
}

/// ml inside of the level's surface of a distance in mm, interpolated linearly between voxels, to their outer faces.
double volume_ml(const grid::Field& distance, double level) {
  constexpr int parts = 3;  // of a voxel along each axis
  const auto& n = distance.size;
  if (std::min({n[0], n[1], n[2]}) < 2)
    return double(std::count_if(distance.voxels.begin(), distance.voxels.end(), [&](float v) { return v > level; })) *
           distance.voxel_volume_mm3() / 1000;
  const double reach = 0.55 * norm(distance.spacing_mm), soft = std::cbrt(distance.voxel_volume_mm3()) / parts;
  std::vector<double> slices(std::size_t(n[2]), 0);
  parallel_for(0, n[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < int(to); ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) {
          const double here = distance.at(i, j, k) - level;
          if (std::abs(here) > reach) {
            slices[k] += here > 0;
            continue;
          }
          double share = 0;
          for (int part = 0; part < parts * parts * parts; ++part) {
            const int of[3] = {part % parts, part / parts % parts, part / (parts * parts)}, at[3] = {i, j, k};
            Vec3 q;
            for (int a = 0; a < 3; ++a) q[a] = std::clamp(at[a] + (of[a] + 0.5) / parts - 0.5, 0.0, double(n[a] - 1));
            share += std::clamp(0.5 + (linear(distance, q, 0) - level) / soft, 0.0, 1.0);
          }
          slices[k] += share / (parts * parts * parts);
        }
  });
  double voxels = 0;
  for (const double s : slices) voxels += s;
  return voxels * distance.voxel_volume_mm3() / 1000;
}

/// Moves the surface of a distance in mm by up to half a voxel of the label's, so that it holds as much as the label:
/// between voxels what is thin or bent loses more than it gains. Returns by how much, outwards; `ml` is what it holds.
double keep_volume(grid::Field& distance, double wanted_ml, const grid::Lattice& label, double& ml) {
  const double most = 0.5 * std::max({label.spacing_mm.x, label.spacing_mm.y, label.spacing_mm.z});
  double low = -most, high = most, level = 0, step = 0.02 * most;
  ml = volume_ml(distance, level);
  for (int i = 0; i < 8 && std::abs(ml / wanted_ml - 1) > 0.001; ++i) {
    (ml > wanted_ml ? low : high) = level;
    // By the slope of the last step, kept between what is known to be too much and too little.
    double next = level + (ml > wanted_ml ? step : -step);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const double before = ml;
    ml = volume_ml(distance, next);
    const double slope = (ml - before) / (next - level);
    level = next;
    step = slope < 0 ? std::abs((wanted_ml - ml) / slope) : most;
  }
  for (float& v : distance.voxels) {
    v -= float(level);
    if (std::abs(v) < 1e-4f) v = v > 0 ? 1e-4f : -1e-4f;
  }
  return -level;
}

/// Smoothing takes more from what is thin than it gives. The values inside, times a factor, move the surface between
/// voxels and no voxel to the other side; returns the factor that comes nearest to the wanted volume, and what it
/// holds.
double balance(const grid::Field& field, double wanted_ml, double& ml) {
  const auto times = [&](double factor) {
    grid::Field out = field;
    for (float& v : out.voxels)
      if (v > 0) v *= float(factor);
    return volume_ml(out, 0);
  };
  double low = -8, high = 8, at = 0;
  for (int i = 0; i < 14 && std::abs(ml / wanted_ml - 1) > 0.002; ++i) {
    (ml > wanted_ml ? high : low) = at;
    at = 0.5 * (low + high);
    ml = times(std::exp(at));
  }
  return std::exp(at);
}

/// Warns where the label reaches its own grid's edge inside of the volume.
void check_cut(const grid::PickedLabel& label, const grid::Lattice& volume, Warnings& warnings) {
  const grid::Box box = bits_of(label.mask).bounds();
  const grid::Mask& m = label.mask;
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side) {
      if (side ? box.end[a] < m.size[a] : box.begin[a] > 0) continue;
      Vec3 at{(box.begin[0] + box.end[0] - 1) / 2.0, (box.begin[1] + box.end[1] - 1) / 2.0,
              (box.begin[2] + box.end[2] - 1) / 2.0};
      at[a] = side ? m.size[a] + 0.5 : -1.5;
      const Vec3 q = volume.to_index(m.to_world_mm(at));
      bool in = true;
      for (int b = 0; b < 3; ++b) in = in && q[b] >= 0 && q[b] <= volume.size[b] - 1;
      if (in) {
        warnings.push_back(
            {"label_cut",
             "the label ends at the edge of its own grid within the volume: the file may hold only a part of it",
             {}});
        return;
      }
    }
}

}  // namespace

Outcome<grid::Field, LabelResult> label_field(const grid::HuVolume& volume, const grid::LabelFile& map,
                                              const LabelParams& params, const Progress& progress) {
  const HuView hu(volume);
  const grid::Lattice& l = hu.lattice();
  const grid::PickedLabel label = grid::pick_label(map, params.label);
  Made made;
  made.result.label = label.name;
  made.result.format = map.format;
  made.result.label_voxels_count = label.voxels;
  const double label_ml = double(label.voxels) * map.lattice.voxel_volume_mm3() / 1000;
  made.result.label_ml = label_ml;
  for (const std::string& w : map.warnings) made.warnings.push_back({"label_file", w, {}});
  for (const grid::LabelSegment& s : map.segments)
    if (s.cropped && (params.label.empty() || s.name == label.name))
      made.warnings.push_back(
          {"segment_cropped",
           "the file says that segment {segment} reaches beyond its voxels: it was cropped when written",
           {{"segment", s.name}}});
  if (!label.voxels)
    throw refusal("label", "'" + label.name + "' has not one voxel", {"paint it, or name another `label`"});
  const double inside_ml = label_ml * (1 - check_fit(hu, label, params, made));
  check_cut(label, l, made.warnings);
  progress.report(0.1);

  const auto aligned = raster_alignment(map.lattice, l);
  made.result.resampled = !aligned;
  grid::Field& field = made.value;
  double ml = 0;
  if (aligned) {
    made.result.offset_max_ratio = aligned->off_voxels;
    const BitMask mask = on_raster(label.mask, l, *aligned);
    if (!mask.any())
      throw refusal("label", "none of its voxels lies in the volume",
                    {"paint it on this very series, or name another `label`"});
    field = smooth_field(mask::crop(mask, grid::grown(mask.bounds(), margin, l)), params.smooth_mm, progress);
  } else {
    field = resampled(label.mask, l, params.smooth_mm, progress);
    made.result.moved_mm = keep_volume(field, inside_ml, map.lattice, ml);
    const std::size_t count =
        std::size_t(std::count_if(field.voxels.begin(), field.voxels.end(), [](float v) { return v > 0; }));
    if (!count)
      throw refusal("label", "nothing of it is left on the volume's voxels: it is too thin for them",
                    {"paint it thicker, or set `smooth_mm` to 0"});
  }
  if (aligned) {
    // Values change by about 1 a voxel across the surface: in mm they are nearly a distance.
    grid::Field scaled = field;
    for (float& v : scaled.voxels) v *= float(std::cbrt(l.voxel_volume_mm3()));
    ml = volume_ml(scaled, 0);
    if (std::abs(ml / inside_ml - 1) > noted_change_ratio) {
      const double factor = balance(scaled, inside_ml, ml);
      for (float& v : field.voxels)
        if (v > 0) v *= float(factor);
      made.result.balanced_ratio = factor;
    }
  }
  made.result.volume_ml = ml;
  made.result.volume_change_ratio = ml / inside_ml - 1;
  if (std::abs(ml / inside_ml - 1) > noted_change_ratio)
    made.warnings.push_back({"label_volume_changed",
                             "on the volume's voxels the label holds {ml} ml, in its file {file_ml} ml ({change}): "
                             "parts of it are thinner than a voxel",
                             {{"ml", to_text(std::round(ml * 100) / 100)},
                              {"file_ml", to_text(std::round(inside_ml * 100) / 100)},
                              {"change", percent(ml / inside_ml - 1)}}});
  progress.report(1);
  return made;
}

}  // namespace trephine::segmentation

// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/head_figures.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "base/rank.h"
#include "base/text.h"
#include "head/head_doubts.h"
#include "mask/filters.h"

namespace trephine::head {
namespace {

constexpr double line_mm = 1;         ///< distance of the lines along which widths are measured
constexpr double step_mm = 0.4;       ///< of samples along them
constexpr double monro_share = 0.31;  ///< of the ventricles' length lies in front of the foramina of Monro,
constexpr double max_horn_mm = 32;    ///< but not more than this
constexpr double septum_mm = 12;      ///< walls farther apart than this are not those of a septum
constexpr double third_mm = 16;       ///< a third ventricle is no wider
constexpr double min_run_mm = 0.8;    ///< what is narrower is noise
constexpr double flank_mm = 20;       ///< inner skull: looked for from here outwards, beyond a calcified falx
constexpr double extradural_mm = 30;  ///< and at most this far from the brain

/// A head's own axes, about a point of the midsagittal plane.
struct HeadAxes {
  Vec3 origin, left, back, up;
  Vec3 at(double to_left, double to_back, double to_up) const {
    return origin + left * to_left + back * to_back + up * to_up;
  }
};

HeadAxes axes_of(Vec3 origin, Vec3 normal) {
  HeadAxes a;
  a.origin = origin;
  a.left = normalized(normal);
  const Vec3 z{0, 0, 1};
  a.up = normalized(z - a.left * dot(z, a.left));
  a.back = cross(a.up, a.left);
  return a;
}

/// Trilinear; -1 beyond the lattice, which is outside.
double value_at(const grid::Field& f, Vec3 index) {
  int low[3];
  double t[3];
  for (int a = 0; a < 3; ++a) {
    if (!(index[a] >= 0 && index[a] <= f.size[a] - 1)) return -1;
    low[a] = std::min(int(index[a]), std::max(0, f.size[a] - 2));
    t[a] = index[a] - low[a];
  }
  const std::size_t dx = f.size[0] > 1, dy = f.size[1] > 1 ? f.size[0] : 0,
                    dz = f.size[2] > 1 ? std::size_t(f.size[0]) * f.size[1] : 0;
  const float* p = &f.voxels[f.index(low[0], low[1], low[2])];
  const auto face = [&](const float* q) {
    const double a = q[0] + t[0] * (q[dx] - q[0]), b = q[dy] + t[0] * (q[dy + dx] - q[dy]);
    return a + t[1] * (b - a);
  };
  const double a = face(p), b = face(p + dz);
  return a + t[2] * (b - a);
}

struct Run {
  double from, to;
  double width() const { return to - from; }
  double middle() const { return 0.5 * (from + to); }
};

/// Where the line from + s * direction lies inside the field, s from s0 to s1, crossings placed within a step.
std::vector<Run> runs_along(const grid::Field& f, Vec3 from, Vec3 direction, double s0, double s1) {
  std::vector<Run> runs;
  const Vec3 a = f.to_index(from), b = f.to_index(from + direction) - a;
  const int steps = std::max(1, int(std::ceil((s1 - s0) / step_mm)));
  const double h = (s1 - s0) / steps;
  double before = value_at(f, a + b * s0);
  if (before > 0) runs.push_back({s0, s1});
  for (int n = 1; n <= steps; ++n) {
    const double s = s0 + n * h, now = value_at(f, a + b * s);
    if ((before > 0) != (now > 0)) {
      const double crossing = s - h + h * before / (before - now);
      if (now > 0)
        runs.push_back({crossing, s1});
      else
        runs.back().to = crossing;
    }
    before = now;
  }
  runs.erase(std::remove_if(runs.begin(), runs.end(), [](const Run& r) { return r.width() < min_run_mm; }), runs.end());
  return runs;
}

/// The ventricles cut into lines from right to left, on a raster of back and up.
struct Lines {
  HeadAxes axes;
  double back0 = 0, up0 = 0;
  int backs = 0, ups = 0;
  std::vector<std::vector<Run>> runs;

  const std::vector<Run>& at(int b, int u) const { return runs[std::size_t(u) * backs + b]; }
  double back(int b) const { return back0 + b * line_mm; }
  double up(int u) const { return up0 + u * line_mm; }
};

struct Extent {
  Vec3 least{1e9, 1e9, 1e9}, most{-1e9, -1e9, -1e9};
};

/// Of the voxels inside, along the axes.
Extent extent_of(const grid::Field& f, const HeadAxes& axes) {
  std::vector<Extent> slices(f.size[2]);
  parallel_for(0, f.size[2], 1, [&](std::int64_t k0, std::int64_t) {
    const int k = int(k0);
    Extent& e = slices[k];
    for (int j = 0; j < f.size[1]; ++j)
      for (int i = 0; i < f.size[0]; ++i) {
        if (!(f.at(i, j, k) > 0)) continue;
        const Vec3 p = f.to_world_mm({double(i), double(j), double(k)}) - axes.origin;
        const Vec3 q{dot(p, axes.left), dot(p, axes.back), dot(p, axes.up)};
        for (int a = 0; a < 3; ++a) {
          e.least[a] = std::min(e.least[a], q[a]);
          e.most[a] = std::max(e.most[a], q[a]);
        }
      }
  });
  Extent all;
  for (const Extent& e : slices)
    for (int a = 0; a < 3; ++a) {
      all.least[a] = std::min(all.least[a], e.least[a]);
      all.most[a] = std::max(all.most[a], e.most[a]);
    }
  return all;
}

Lines lines_of(const grid::Field& f, const HeadAxes& axes, const Progress& progress) {
  const Extent e = extent_of(f, axes);
  Lines l;
  l.axes = axes;
  if (!(e.least.x <= e.most.x)) return l;
  l.back0 = e.least.y - line_mm;
  l.up0 = e.least.z - line_mm;
  l.backs = int((e.most.y - l.back0) / line_mm) + 2;
  l.ups = int((e.most.z - l.up0) / line_mm) + 2;
  l.runs.resize(std::size_t(l.backs) * l.ups);
  parallel_for(0, l.ups, 1, [&](std::int64_t u, std::int64_t) {
    progress.check();
    for (int b = 0; b < l.backs; ++b)
      l.runs[std::size_t(u) * l.backs + b] =
          runs_along(f, axes.at(0, l.back(b), l.up(int(u))), axes.left, e.least.x - 2, e.most.x + 2);
  });
  return l;
}

/// Which lines belong to the frontal horns: in front of the foramina of Monro, connected with the foremost one.
struct Horns {
  double monro_back = 0;
  std::vector<char> is;  ///< of each line
};

Horns horns_of(const Lines& l, const HeadLandmarks* landmarks) {
  Horns h;
  h.is.assign(l.runs.size(), 0);
  int first = l.backs, last = -1;
  for (int b = 0; b < l.backs; ++b)
    for (int u = 0; u < l.ups; ++u)
      if (!l.at(b, u).empty()) {
        first = std::min(first, b);
        last = std::max(last, b);
      }
  if (last < 0) return h;
  h.monro_back = l.back(first) + std::min(monro_share * (l.back(last) - l.back(first)), max_horn_mm);
  if (landmarks) {
    double sum = 0;
    int n = 0;
    for (const char* name : {"monro_left", "monro_right"})
      if (const cases::CaseLandmark* m = landmarks->find(name); m && m->confidence > 0) {
        sum += dot(m->position_mm - l.axes.origin, l.axes.back);
        ++n;
      }
    if (n) h.monro_back = sum / n;
  }
  std::vector<std::size_t> open;
  const auto offer = [&](int b, int u) {
    if (b < 0 || u < 0 || b >= l.backs || u >= l.ups || l.back(b) > h.monro_back) return;
    const std::size_t at = std::size_t(u) * l.backs + b;
    if (h.is[at] || l.runs[at].empty()) return;
    h.is[at] = 1;
    open.push_back(at);
  };
  // The foremost lines of either side need not hang together: all within 5 mm of the front are a beginning.
  for (int b = first; b <= last && l.back(b) <= l.back(first) + 5; ++b)
    for (int u = 0; u < l.ups; ++u) offer(b, u);
  while (!open.empty()) {
    const std::size_t at = open.back();
    open.pop_back();
    const int b = int(at % l.backs), u = int(at / l.backs);
    offer(b - 1, u), offer(b + 1, u), offer(b, u - 1), offer(b, u + 1);
  }
  return h;
}

/// The inner skull's two sides on one line.
std::optional<Run> inner_skull_on(const HeadFields& fields, const HeadAxes& axes, double back, double up) {
  const Vec3 from = axes.at(0, back, up);
  constexpr double reach = 130;
  Run inner{0, 0};
  for (int side = -1; side <= 1; side += 2) {
    const Vec3 out = axes.left * double(side);
    const auto bone = runs_along(*fields.skull, from, out, flank_mm, reach);
    if (bone.empty() || bone[0].from <= flank_mm) return {};
    if (fields.brain) {
      const auto brain = runs_along(*fields.brain, from, out, 0, bone[0].from);
      if (brain.empty() || brain.back().to < bone[0].from - extradural_mm) return {};
    }
    (side < 0 ? inner.from : inner.to) = side * bone[0].from;
  }
  return inner;
}

/// The widest one in that axial plane.
std::optional<Run> widest_inner_skull(const HeadFields& fields, const HeadAxes& axes, double from_back, double to_back,
                                      double up) {
  const int lines = std::max(1, int((to_back - from_back) / line_mm));
  std::vector<std::optional<Run>> found(lines);
  parallel_for(0, lines, 8, [&](std::int64_t a, std::int64_t b) {
    for (auto n = a; n < b; ++n) found[n] = inner_skull_on(fields, axes, from_back + double(n) * line_mm, up);
  });
  std::optional<Run> best;
  for (const auto& r : found)
    if (r && (!best || r->width() > best->width())) best = r;
  return best;
}

void measure_evans(const HeadFields& fields, const Lines& l, const Horns& horns, HeadFigures& out) {
  Run widest{0, 0};
  int at_back = -1, at_up = -1;
  for (int u = 0; u < l.ups; ++u)
    for (int b = 0; b < l.backs; ++b) {
      if (!horns.is[std::size_t(u) * l.backs + b]) continue;
      const auto& runs = l.at(b, u);
      const Run r{runs.front().from, runs.back().to};
      if (r.width() > widest.width()) {
        widest = r;
        at_back = b;
        at_up = u;
      }
    }
  if (at_back < 0) return;
  out.frontal_horns_mm = widest.width();
  out.evans_place_mm = l.axes.at(widest.middle(), l.back(at_back), l.up(at_up));
  if (!fields.skull) return;
  // The widest place of a skull lies behind the horns: from 40 mm in front of them to 140 mm behind.
  const auto inner = widest_inner_skull(fields, l.axes, l.back(at_back) - 40, l.back(at_back) + 140, l.up(at_up));
  if (!inner) return;
  out.inner_skull_mm = inner->width();
  out.evans_index_ratio = *out.frontal_horns_mm / *out.inner_skull_mm;
}

void measure_shift(const HeadFields& fields, const Lines& l, const Horns& horns, bool has_plane, HeadFigures& out) {
  struct Middle {
    double to_left;
    int b, u;
  };
  std::vector<Middle> septum, third, horn;
  for (int u = 0; u < l.ups; ++u)
    for (int b = 0; b < l.backs; ++b) {
      const auto& runs = l.at(b, u);
      if (runs.empty()) continue;
      const double behind = l.back(b) - horns.monro_back;
      if (horns.is[std::size_t(u) * l.backs + b] && behind >= -12) {
        horn.push_back({0.5 * (runs.front().from + runs.back().to), b, u});
        if (runs.size() == 2 && runs[1].from - runs[0].to <= septum_mm)
          septum.push_back({0.5 * (runs[0].to + runs[1].from), b, u});
      }
      if (behind > 0 && behind < 16 && runs.size() == 1 && runs[0].width() <= third_mm)
        third.push_back({runs[0].middle(), b, u});
    }
  const std::vector<Middle>* of = septum.size() >= 10 ? &septum : third.size() >= 20 ? &third : &horn;
  if (of->empty()) return;
  std::vector<double> lefts, backs, ups;
  for (const Middle& m : *of) {
    lefts.push_back(m.to_left);
    backs.push_back(l.back(m.b));
    ups.push_back(l.up(m.u));
  }
  const double left = median_of(lefts), back = median_of(backs), up = median_of(ups);
  out.midline_place_mm = l.axes.at(left, back, up);
  std::vector<double> middles;
  for (int n = -5; n <= 5 && !has_plane && fields.skull; ++n)
    if (const auto inner = inner_skull_on(fields, l.axes, back + n, up)) middles.push_back(inner->middle());
  if (!has_plane && middles.empty()) return;
  out.midline_shift_mm = has_plane ? left : left - median_of(middles);
  out.midline_of = of == &septum ? "septum" : of == &third ? "third ventricle" : "frontal horns";
}

std::optional<double> ml_of(const grid::Field* f) {
  if (!f) return {};
  std::vector<std::size_t> slices(f->size[2]);
  parallel_for(0, f->size[2], 1, [&](std::int64_t k, std::int64_t) {
    const std::size_t plane = std::size_t(f->size[0]) * f->size[1];
    for (std::size_t v = plane * k; v < plane * (k + 1); ++v) {
      if (!std::isfinite(f->voxels[v])) throw Error(ExitCode::bad_input, "", "field", "a voxel is not finite");
      slices[k] += f->voxels[v] > 0;
    }
  });
  std::size_t n = 0;
  for (std::size_t s : slices) n += s;
  return double(n) * f->voxel_volume_mm3() / 1000;
}

HeadClass class_of(const HeadFigures& f, const HeadClassParams& p, bool doubted) {
  if (doubted) return HeadClass::uncertain;
  if (!f.evans_index_ratio || !f.midline_shift_mm) return HeadClass::unknown;
  if (std::abs(*f.midline_shift_mm) > p.shifted_mm) return HeadClass::shifted;
  if (*f.evans_index_ratio > p.hydrocephalic_evans_ratio) return HeadClass::hydrocephalic;
  const bool little = f.brain_ml && *f.ventricles_ml < p.small_ventricles_ratio * *f.brain_ml;
  return little && *f.evans_index_ratio <= p.small_evans_ratio ? HeadClass::small : HeadClass::normal;
}

/// What speaks against the ventricles being whole; takes the widths away that were measured across a gap.
Warnings doubts_of(const HeadFields& fields, const HeadAxes& axes, const Horns& horns, const HeadLandmarks* landmarks,
                   const HeadClassParams& params, HeadFigures& f) {
  const double middle = f.midline_shift_mm ? dot(f.midline_place_mm - axes.origin, axes.left) : 0;
  VentricleDoubts found = ventricle_doubts(
      *fields.ventricles, {axes.origin, axes.left, axes.back, middle, horns.monro_back}, landmarks, f, params);
  if (fields.scan)
    for (auto& doubt : {scan_doubt(*fields.scan, params), close_call(f, *fields.scan, params)})
      if (doubt) found.doubts.push_back(*doubt);
  f.ventricle_pieces_count = found.pieces_count;
  f.ventricle_sides_ratio = found.sides_ratio;
  f.horn_left_mm2 = found.horn_mm2[0];
  f.horn_right_mm2 = found.horn_mm2[1];
  if (!found.horns_whole) f.frontal_horns_mm = f.evans_index_ratio = std::nullopt;
  return std::move(found.doubts);
}

}  // namespace

std::optional<double>* volume_of(HeadFigures& figures, const std::string& anatomy) {
  if (anatomy == "skin") return &figures.skin_ml;
  if (anatomy == "skull") return &figures.skull_ml;
  if (anatomy == "brain") return &figures.brain_ml;
  return anatomy == "ventricles" ? &figures.ventricles_ml : nullptr;
}

Outcome<std::monostate, HeadFigures> measure_head(const HeadFields& fields, const HeadLandmarks* landmarks,
                                                  const HeadClassParams& params, const Progress& progress) {
  Outcome<std::monostate, HeadFigures> out;
  HeadFigures& f = out.result;
  f.skin_ml = ml_of(fields.skin);
  f.skull_ml = ml_of(fields.skull);
  f.brain_ml = ml_of(fields.brain);
  f.ventricles_ml = ml_of(fields.ventricles);
  bool doubted = false;
  if (fields.ventricles && *f.ventricles_ml > 0) {
    const bool has_plane = landmarks && landmarks->midsagittal.confidence > 0;
    HeadAxes axes = axes_of({0, 0, 0}, {1, 0, 0});
    if (has_plane) {
      axes = axes_of(landmarks->midsagittal.point_mm, landmarks->midsagittal.normal);
    } else {
      // Lines start inside the head: about the ventricles' middle.
      const Extent e = extent_of(*fields.ventricles, axes);
      axes.origin.x = 0.5 * (e.least.x + e.most.x);
      out.warnings.push_back({"no_midsagittal_plane",
                              "no midsagittal plane is known: widths are taken along the patient's left, and the "
                              "middle is that of the inner skull",
                              {}});
    }
    const Lines lines = lines_of(*fields.ventricles, axes, progress);
    const Horns horns = horns_of(lines, landmarks);
    measure_evans(fields, lines, horns, f);
    measure_shift(fields, lines, horns, has_plane, f);
    if (!f.evans_index_ratio && fields.skull)
      out.warnings.push_back(
          {"no_evans_index",
           "Evans' index could not be measured: no plane of the frontal horns has inner skull on both sides",
           {}});
    const Warnings doubts = doubts_of(fields, axes, horns, landmarks, params, f);
    doubted = !doubts.empty();
    for (const Warning& doubt : doubts)
      out.warnings.push_back({doubt.id, "the class is uncertain: " + doubt.form, doubt.values});
  }
  f.head_class = class_of(f, params, doubted);
  return out;
}

}  // namespace trephine::head

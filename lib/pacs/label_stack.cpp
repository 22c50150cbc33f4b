// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/memory_budget.h"
#include "base/parallel.h"
#include "dicom/geometry.h"
#include "pacs/object_reader.h"

namespace trephine::pacs {
namespace {

/// A plane's signed distance in mm within a window of its pixels; positive inside.
struct Plane {
  bool any = false;
  std::vector<float> distance;
};
struct Window {
  int i0 = 0, j0 = 0, ni = 0, nj = 0;
};

bool bit(const std::string& bits, std::size_t i) { return static_cast<unsigned char>(bits[i / 8]) >> i % 8 & 1; }

// Squared distances along one line to the nearest zero of f, in squared mm [Felzenszwalb2012].
void parabolas(std::vector<double>& f, double step) {
  const int n = int(f.size());
  std::vector<int> at(std::size_t(n), 0);
  std::vector<double> from(std::size_t(n) + 1, -1e300), out(f.size());
  int k = -1;
  for (int q = 0; q < n; ++q) {
    if (f[std::size_t(q)] >= 1e20) continue;
    double s = -1e300;
    while (k >= 0) {
      const int p = at[std::size_t(k)];
      s = ((f[std::size_t(q)] + step * step * q * q) - (f[std::size_t(p)] + step * step * p * p)) /
          (2 * step * step * (q - p));
      if (s > from[std::size_t(k)]) break;
      --k;
    }
    ++k;
    at[std::size_t(k)] = q;
    from[std::size_t(k)] = k == 0 ? -1e300 : s;
    from[std::size_t(k) + 1] = 1e300;
  }
  if (k < 0) return;
  int now = 0;
  for (int q = 0; q < n; ++q) {
    while (now < k && from[std::size_t(now) + 1] < q) ++now;
    const int p = at[std::size_t(now)];
    out[std::size_t(q)] = f[std::size_t(p)] + step * step * (q - p) * (q - p);
  }
  f = std::move(out);
}

// Distances in mm of all pixels of the window to the nearest one that is set, or not set.
std::vector<double> distances(const std::vector<std::uint8_t>& set, bool to_set, const Window& w, double dx,
                              double dy) {
  std::vector<double> squared(set.size());
  for (std::size_t i = 0; i < set.size(); ++i) squared[i] = (set[i] != 0) == to_set ? 0 : 1e20;
  std::vector<double> line;
  for (int j = 0; j < w.nj; ++j) {
    line.assign(squared.begin() + std::ptrdiff_t(j) * w.ni, squared.begin() + std::ptrdiff_t(j + 1) * w.ni);
    parabolas(line, dx);
    std::copy(line.begin(), line.end(), squared.begin() + std::ptrdiff_t(j) * w.ni);
  }
  line.resize(std::size_t(w.nj));
  for (int i = 0; i < w.ni; ++i) {
    for (int j = 0; j < w.nj; ++j) line[std::size_t(j)] = squared[std::size_t(j) * std::size_t(w.ni) + std::size_t(i)];
    parabolas(line, dy);
    for (int j = 0; j < w.nj; ++j) squared[std::size_t(j) * std::size_t(w.ni) + std::size_t(i)] = line[std::size_t(j)];
  }
  for (double& v : squared) v = std::sqrt(v);
  return squared;
}

Plane plane_of(const std::string& bits, const Window& w, const SliceSet& s) {
  Plane out;
  if (bits.empty()) return out;
  out.any = true;
  std::vector<std::uint8_t> set(std::size_t(w.ni) * std::size_t(w.nj), 0);
  for (int j = 0; j < w.nj; ++j)
    for (int i = 0; i < w.ni; ++i) {
      const int x = i + w.i0, y = j + w.j0;
      if (x >= 0 && y >= 0 && x < s.columns && y < s.rows)
        set[std::size_t(j) * std::size_t(w.ni) + std::size_t(i)] =
            bit(bits, std::size_t(y) * std::size_t(s.columns) + std::size_t(x));
    }
  const double half = 0.25 * (s.dx_mm + s.dy_mm);  // the border lies midway between pixels
  const auto in = distances(set, false, w, s.dx_mm, s.dy_mm), outside = distances(set, true, w, s.dx_mm, s.dy_mm);
  out.distance.resize(set.size());
  for (std::size_t i = 0; i < set.size(); ++i) out.distance[i] = float(set[i] ? in[i] - half : half - outside[i]);
  return out;
}

float sampled(const Plane& p, const Window& w, double x, double y) {
  x -= w.i0;
  y -= w.j0;
  if (!(x >= 0 && y >= 0 && x <= w.ni - 1 && y <= w.nj - 1)) return -1e6f;
  const int i = std::min(int(x), w.ni - 2), j = std::min(int(y), w.nj - 2);
  const float a = float(x - i), b = float(y - j);
  const float* at = &p.distance[std::size_t(j) * std::size_t(w.ni) + std::size_t(i)];
  const float top = at[0] + a * (at[1] - at[0]), bottom = at[w.ni] + a * (at[w.ni + 1] - at[w.ni]);
  return top + b * (bottom - top);
}

// The smallest window that holds all of the segment's pixels, and two more on each side.
Window window_of(const Segment& segment, const SliceSet& s) {
  int i0 = s.columns, i1 = -1, j0 = s.rows, j1 = -1;
  for (const std::string& bits : segment.bits) {
    if (bits.empty()) continue;
    for (int j = 0; j < s.rows; ++j)
      for (int i = 0; i < s.columns; ++i)
        if (bit(bits, std::size_t(j) * std::size_t(s.columns) + std::size_t(i))) {
          i0 = std::min(i0, i);
          i1 = std::max(i1, i);
          j0 = std::min(j0, j);
          j1 = std::max(j1, j);
        }
  }
  return {i0 - 2, j0 - 2, i1 - i0 + 5, j1 - j0 + 5};
}

// What of the stack's levels a slice of the lattice is made of.
struct Between {
  std::size_t lower = 0;
  double part = 0;  ///< of the way to the next level
};
Between between(const dicom::StackGeometry& g, int target) {
  const double z = g.target_mm(target);
  const auto& along = g.along_mm;
  const auto above = std::upper_bound(along.begin(), along.end(), z);
  std::size_t k = above == along.begin() ? 0 : std::size_t(above - along.begin()) - 1;
  k = std::min(k, along.size() - 2);
  double part = std::clamp((z - along[k]) / (along[k + 1] - along[k]), 0.0, 1.0);
  for (const double end : {0.0, 1.0})
    if (std::abs(part - end) * (along[k + 1] - along[k]) <= dicom::uniform_tolerance_mm) part = end;
  return {k, part};
}

class Rasteriser {
 public:
  Rasteriser(const Segment& segment, const SliceSet& slices, const dicom::StackGeometry& g, std::size_t padded)
      : segment_(segment), slices_(slices), g_(g), padded_(padded), window_(window_of(segment, slices)) {}

  // Writes 1 where the segment is.
  void slice(int target, std::uint8_t* out) const {
    const auto [lower, part] = between(g_, target);
    const std::string &a = bits_of(lower), &b = bits_of(lower + 1);
    if (part == 0 || part == 1) {
      const std::size_t level = part == 0 ? lower : lower + 1;
      const std::string& bits = part == 0 ? a : b;
      if (!bits.empty()) exact_or_moved(bits, level, out);
      return;
    }
    if (a.empty() && b.empty()) return;
    if (a.empty() || b.empty()) {
      const bool of_lower = !a.empty();
      if ((part < 0.5) == of_lower) exact_or_moved(of_lower ? a : b, of_lower ? lower : lower + 1, out);
      return;
    }
    const Plane p = plane_of(a, window_, slices_), q = plane_of(b, window_, slices_);
    each(out, [&, lower = lower, part = part](int i, int j) {
      return (1 - part) * at(p, lower, i, j) + part * at(q, lower + 1, i, j) > 0;
    });
  }

 private:
  const std::string& bits_of(std::size_t level) const {
    static const std::string none;
    const std::size_t slice = std::size_t(g_.levels[level].front());
    return slice < padded_ || slice >= padded_ + segment_.bits.size() ? none : segment_.bits[slice - padded_];
  }
  float at(const Plane& plane, std::size_t level, int i, int j) const {
    return sampled(plane, window_, i - g_.shift[level][0], j - g_.shift[level][1]);
  }
  template <class Inside>
  void each(std::uint8_t* out, Inside&& inside) const {
    for (int j = 0; j < g_.target.size[1]; ++j)
      for (int i = 0; i < g_.target.size[0]; ++i)
        out[std::size_t(j) * std::size_t(g_.target.size[0]) + std::size_t(i)] = inside(i, j);
  }
  void exact_or_moved(const std::string& bits, std::size_t level, std::uint8_t* out) const {
    const std::array<double, 2> shift = g_.sheared ? g_.shift[level] : std::array<double, 2>{0, 0};
    const int si = int(std::lround(shift[0])), sj = int(std::lround(shift[1]));
    if (std::abs(shift[0] - si) < 1e-3 && std::abs(shift[1] - sj) < 1e-3) {
      each(out, [&](int i, int j) {
        const int x = i - si, y = j - sj;
        return x >= 0 && y >= 0 && x < slices_.columns && y < slices_.rows &&
               bit(bits, std::size_t(y) * std::size_t(slices_.columns) + std::size_t(x));
      });
      return;
    }
    const Plane p = plane_of(bits, window_, slices_);
    each(out, [&](int i, int j) { return at(p, level, i, j) > 0; });
  }

  const Segment& segment_;
  const SliceSet& slices_;
  const dicom::StackGeometry& g_;
  std::size_t padded_;
  Window window_;
};

// The stack with an empty slice at either end, so that what lies beyond is known to be empty; two where there is one
// slice alone.
dicom::SliceStack stack_of(const SliceSet& s, std::size_t& padded) {
  dicom::SliceStack stack;
  stack.columns = s.columns;
  stack.rows = s.rows;
  stack.dx_mm = s.dx_mm;
  stack.dy_mm = s.dy_mm;
  stack.u = s.u;
  stack.v = s.v;
  const std::size_t n = s.origins_mm.size();
  const double step = s.uniform_step_mm();
  const Vec3 own = step > 0 ? (s.origins_mm[n - 1] - s.origins_mm[0]) / double(n - 1) : s.normal() * s.thickness_mm;
  const Vec3 before = step > 0 || n < 2 ? own : s.origins_mm[1] - s.origins_mm[0];
  const Vec3 behind = step > 0 || n < 2 ? own : s.origins_mm[n - 1] - s.origins_mm[n - 2];
  padded = 1;
  stack.positions_mm.push_back(s.origins_mm.front() - before);
  for (const Vec3& p : s.origins_mm) stack.positions_mm.push_back(p);
  stack.positions_mm.push_back(s.origins_mm.back() + behind);
  return stack;
}

}  // namespace

std::vector<std::string> bits_between(const std::string& lower, const std::string& upper,
                                      const std::vector<double>& parts, const SliceSet& s) {
  const Window w = window_of({"", {}, {lower, upper}}, s);
  const Plane p = plane_of(lower, w, s), q = plane_of(upper, w, s);
  std::vector<std::string> out;
  for (const double part : parts) {
    std::vector<std::uint8_t> pixels(s.pixels(), 0);
    bool any = false;
    for (int y = std::max(0, w.j0); y < std::min(s.rows, w.j0 + w.nj); ++y)
      for (int x = std::max(0, w.i0); x < std::min(s.columns, w.i0 + w.ni); ++x) {
        const std::size_t at = std::size_t(y - w.j0) * std::size_t(w.ni) + std::size_t(x - w.i0);
        if (!((1 - part) * p.distance[at] + part * q.distance[at] > 0)) continue;
        pixels[std::size_t(y) * std::size_t(s.columns) + std::size_t(x)] = 1;
        any = true;
      }
    out.push_back(any ? packed(pixels) : std::string());
  }
  return out;
}

grid::LabelFile label_file_of(const LabelObject& object, const Progress& progress) {
  if (object.slices.origins_mm.empty()) throw Error(ExitCode::bad_input, "", "", "holds no slice");
  std::size_t padded = 0;
  const dicom::SliceStack stack = stack_of(object.slices, padded);
  dicom::StackGeometry g = dicom::analyse_stack(stack, dicom::GapPolicy::interpolate, 1e6);
  if (!g.sheared) g.shift.assign(g.levels.size(), {0, 0});
  grid::LabelFile out;
  out.format = object.format;
  out.lattice = g.target;
  const std::size_t plane = std::size_t(g.target.size[0]) * std::size_t(g.target.size[1]), count = g.target.count();
  require_memory(3 * std::uint64_t{count}, "labels of a DICOM object");
  std::vector<std::vector<std::uint8_t>> layers;
  if (object.segments.size() > 255)
    throw Error(ExitCode::bad_input, "", "SegmentSequence", "has more than 255 segments");
  std::size_t done = 0;
  for (const Segment& segment : object.segments) {
    progress.report(double(done++) / double(object.segments.size()));
    const int value = int(done);
    std::vector<std::uint8_t> mask(count, 0);
    const bool any =
        std::any_of(segment.bits.begin(), segment.bits.end(), [](const std::string& b) { return !b.empty(); });
    if (any) {
      const Rasteriser raster(segment, object.slices, g, padded);
      parallel_for(0, g.target.size[2], 1, [&](std::int64_t k, std::int64_t) {
        progress.check();
        raster.slice(int(k), mask.data() + std::size_t(k) * plane);
      });
    }
    // The first layer in which it overlaps nothing.
    std::size_t layer = 0;
    const auto is_free = [&](const std::vector<std::uint8_t>& taken) {
      for (std::size_t i = 0; i < count; ++i)
        if (mask[i] && taken[i]) return false;
      return true;
    };
    while (layer < layers.size() && !is_free(layers[layer])) ++layer;
    if (layer == layers.size()) {
      require_memory(count * (layers.size() + 2) * 2, "labels of a DICOM object");
      layers.emplace_back(count, std::uint8_t{0});
    }
    for (std::size_t i = 0; i < count; ++i)
      if (mask[i]) layers[layer][i] = std::uint8_t(value);
    out.segments.push_back({std::to_string(value), segment.name, value, int(layer), false});
  }
  out.layers = int(layers.size());
  grid::Mask samples;
  static_cast<grid::Lattice&>(samples) = out.lattice;
  samples.size[0] *= out.layers;
  samples.voxels.resize(count * layers.size());
  for (std::size_t l = 0; l < layers.size(); ++l)
    for (std::size_t i = 0; i < count; ++i) samples.voxels[i * layers.size() + l] = layers[l][i];
  out.samples = std::move(samples);
  return out;
}

}  // namespace trephine::pacs

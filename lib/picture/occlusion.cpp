// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/occlusion.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/pi.h"

namespace trephine::picture::detail {
namespace {

constexpr int sample_count = 16, turns = 7, tile = SurfaceBuffer::phases;

struct Offset {
  int x, y;  // pixels
};

// A spiral that is turned by another angle at each pixel of a 4 x 4 tile. The blur over such a tile removes the
// pattern.
std::vector<Offset> spirals(float radius_px) {
  constexpr double full = 2 * pi;
  std::vector<Offset> out;
  for (int cell = 0; cell < tile * tile; ++cell)
    for (int k = 0; k < sample_count; ++k) {
      const double radius = (k + 0.5) / sample_count;
      const double angle = full * (radius * turns + (cell * 7 % (tile * tile)) / double(tile * tile));
      const auto pixels = [&](double v) { return static_cast<int>(std::lround(float(v) * radius_px)); };
      out.push_back({pixels(radius * std::cos(angle)), pixels(radius * std::sin(angle))});
    }
  return out;
}

// The columns of a phase of a row, and the place of its first pixel in the buffer.
struct Run {
  std::size_t at;
  int begin, end;
};

// Where the pixels lie that are offset by that from a run's. False where the picture has none of them.
bool neighbours(const SurfaceBuffer& b, const Run& run, int phase, int y, Offset offset, Run& own, std::size_t& other) {
  const int row = y + offset.y, x = phase + offset.x;
  if (row < 0 || row >= b.height) return false;
  const int shift = x >= 0 ? x / tile : -((tile - 1 - x) / tile);
  own = {run.at, std::max(run.begin, -shift), std::min(run.end, b.columns - shift)};
  if (own.begin >= own.end) return false;
  other = (std::size_t(row) * tile + std::size_t(x - shift * tile)) * b.columns;
  other += std::size_t(own.begin + shift);
  own.at += std::size_t(own.begin);
  return true;
}

// How much the pixels from q hide of those from p, added to `sum`.
void add_hidden(const SurfaceBuffer& b, std::size_t p, std::size_t q, int count, float radius_mm, float* sum) {
  const float *px = &b.position[0][p], *py = &b.position[1][p], *pz = &b.position[2][p];
  const float *qx = &b.position[0][q], *qy = &b.position[1][q], *qz = &b.position[2][q];
  const float *nx = &b.normal[0][p], *ny = &b.normal[1][p], *nz = &b.normal[2][p];
  const float reach2 = radius_mm * radius_mm * 1.5f;
  for (int i = 0; i < count; ++i) {
    const float x = qx[i] - px[i], y = qy[i] - py[i], z = qz[i] - pz[i];
    const float along = x * nx[i] + y * ny[i] + z * nz[i];
    const float length2 = x * x + y * y + z * z;
    const float near = 1 - length2 / reach2;
    const float above = along / std::sqrt(length2 > 1e-12f ? length2 : 1e-12f) - 0.05f;
    sum[i] += (above > 0 ? above : 0) * (near > 0 ? near : 0);
  }
}

// The mean over the pixels of a tile that lie at about the same depth.
void add_near(const float* z, const float* other_z, const float* hidden, int count, float depth_mm, float* sum,
              float* weight) {
  for (int i = 0; i < count; ++i) {
    const bool near = std::abs(other_z[i] - z[i]) <= depth_mm;
    sum[i] += near ? hidden[i] : 0;
    weight[i] += near ? 1 : 0;
  }
}

// The columns of a phase of a row between the first pixel and the last that hold something.
Run run_of(const SurfaceBuffer& b, int y, int phase) {
  const std::size_t at = b.at(phase, y);
  const float* z = &b.position[2][at];
  Run run{at, 0, b.columns};
  while (run.begin < run.end && z[run.begin] == SurfaceBuffer::nowhere_mm) ++run.begin;
  while (run.begin < run.end && z[run.end - 1] == SurfaceBuffer::nowhere_mm) --run.end;
  return run;
}

}  // namespace

SurfaceBuffer::SurfaceBuffer(int w, int h) : width(w), height(h), columns((w + phases - 1) / phases) {
  const std::size_t count = std::size_t(columns) * phases * h;
  for (auto& p : position) p.assign(count, nowhere_mm);
  for (auto& n : normal) n.assign(count, 0.f);
}

std::vector<float> openness(const SurfaceBuffer& b, const Camera& camera, double radius_mm) {
  const auto radius = static_cast<float>(radius_mm);
  const std::vector<Offset> offsets = spirals(static_cast<float>(radius_mm * camera.px_per_mm));
  std::vector<float> hidden(b.position[2].size(), 0.f), out(std::size_t(b.width) * b.height, 1.f);
  const auto each_run = [&](const auto& body) {
    parallel_for(0, b.height, 16, [&](std::int64_t from, std::int64_t to) {
      for (int y = static_cast<int>(from); y < to; ++y)
        for (int phase = 0; phase < tile; ++phase)
          if (const Run run = run_of(b, y, phase); run.begin < run.end) body(run, y, phase);
    });
  };
  each_run([&](const Run& run, int y, int phase) {
    Run own{};
    std::size_t other = 0;
    const Offset* spiral = offsets.data() + (y % tile * tile + phase) * sample_count;
    for (int k = 0; k < sample_count; ++k)
      if (neighbours(b, run, phase, y, spiral[k], own, other))
        add_hidden(b, own.at, other, own.end - own.begin, radius, &hidden[own.at]);
  });
  for (float& h : hidden) h /= sample_count;
  each_run([&](const Run& run, int y, int phase) {
    std::vector<float> sum(std::size_t(b.columns), 0.f), weight(sum);
    Run own{};
    std::size_t other = 0;
    for (int j = -2; j < 2; ++j)
      for (int i = -2; i < 2; ++i)
        if (neighbours(b, run, phase, y, {i, j}, own, other))
          add_near(&b.position[2][own.at], &b.position[2][other], &hidden[other], own.end - own.begin, radius / 4,
                   &sum[std::size_t(own.begin)], &weight[std::size_t(own.begin)]);
    for (int c = run.begin; c < run.end; ++c) {
      const int x = c * tile + phase;
      if (x >= b.width || b.position[2][run.at + c] == SurfaceBuffer::nowhere_mm) continue;
      out[std::size_t(y) * b.width + x] = 1 - std::min(0.85f, sum[c] / weight[c] * 6.0f);  // itself at least
    }
  });
  return out;
}

}  // namespace trephine::picture::detail

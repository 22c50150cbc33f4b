// SPDX-License-Identifier: GPL-3.0-or-later
#include "drill/live_surface.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "drill/cell_triangles.h"
#include "voxel/decode.h"
#include "voxel/raw_voxel.h"

namespace trephine::drill {
namespace {

constexpr int side = BrickLayout::side, corners = side + 1;
constexpr int unit = ShadowVolume::full / voxel::haptic_full;  // of the shares of encoding `occupancy`
constexpr float level = 0.5f * ShadowVolume::full;             // no value is equal to it, so no vertex lies in a corner

// The value of the brick's first corner: the corner (x, y, z) of its cells is voxel side * place + (x, y, z) - 1.
const std::uint16_t* first_corner(const ShadowVolume& shadow, const std::array<int, 3>& place) {
  return shadow.data() + shadow.index(side * place[0] - 1, side * place[1] - 1, side * place[2] - 1);
}

constexpr std::int32_t neighbours_say = -1;
constexpr int solid_from = ShadowVolume::full / 2 + 1;

// A voxel of the window is never drawn as one of none, however it is rounded.
int drawn_share(double share, bool in_window) {
  const int rounded = int(std::lround(ShadowVolume::full * share));
  return in_window ? std::max(rounded, solid_from) : std::min(rounded, solid_from - 1);
}

// By raw value, the share of a shape in a voxel where the value alone says it.
std::vector<std::int32_t> known_shares_of_hu(const voxel::HapticVolume& volume, int number) {
  std::vector<std::int32_t> known(65536, neighbours_say);
  const voxel::HuShares shares(volume, number);
  for (int hu = -32768; hu <= 32767; ++hu)
    if (const std::optional<double> share = shares.of_value(hu)) known[std::uint16_t(hu)] = drawn_share(*share, false);
  return known;
}

std::vector<std::int32_t> known_shares(const voxel::HapticVolume& volume, int number) {
  if (volume.encoding == voxel::HapticEncoding::hu) return known_shares_of_hu(volume, number);
  std::vector<std::int32_t> known(65536, 0);
  for (int raw = voxel::haptic_base_step; raw <= 32767; ++raw) {
    const voxel::detail::RawVoxel v = voxel::detail::split(std::int16_t(raw));
    if (v.number == 0) continue;
    if (v.number == number)
      known[std::size_t(raw)] = unit * v.share;
    else if (!v.bare && v.share < voxel::haptic_full)
      known[std::size_t(raw)] = neighbours_say;
  }
  return known;
}

}  // namespace

int ShadowVolume::share(const std::int16_t& voxel, int i, int j, int k) const {
  const int known = known_[std::uint16_t(voxel::detail::load_voxel(voxel))];
  if (known != neighbours_say) return known;
  return of_hu_ ? drawn_share(of_hu_->at(i, j, k), true)
                : unit * voxel::detail::share_of(volume_.voxels, number_, i, j, k);
}

ShadowVolume::ShadowVolume(const voxel::HapticVolume& volume, int number)
    : volume_(volume), number_(number), layout_(volume.voxels), known_(known_shares(volume, number)) {
  if (volume.encoding == voxel::HapticEncoding::hu) of_hu_.emplace(volume, number);
  for (int a = 0; a < 3; ++a) size_[a] = std::size_t(side * layout_.bricks[std::size_t(a)] + 4);
  const int beyond = of_hu_ ? known_[std::uint16_t(voxel::haptic_beyond_hu)] : 0;
  values_.assign(size_[0] * size_[1] * size_[2], std::uint16_t(beyond));
  reads_it_.assign(layout_.count(), 0);
  const grid::Grid<std::int16_t>& v = volume.voxels;
  parallel_for(0, v.size[2], 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < int(to); ++k)
      for (int j = 0; j < v.size[1]; ++j) {
        const std::int16_t* row = v.voxels.data() + v.index(0, j, k);
        std::uint16_t* out = values_.data() + index(0, j, k);
        for (int i = 0; i < v.size[0]; ++i) out[i] = std::uint16_t(share(row[i], i, j, k));
      }
  });
}

bool ShadowVolume::copy(std::size_t brick) {
  bool changed = false;
  const grid::Grid<std::int16_t>& v = volume_.voxels;
  const std::array<int, 3> at = layout_.place(brick);
  int low[3], high[3];
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::max(0, side * at[a] - 2);
    high[a] = std::min(v.size[a] - 1, side * at[a] + side);
  }
  for (int k = low[2]; k <= high[2]; ++k)
    for (int j = low[1]; j <= high[1]; ++j) {
      const std::int16_t* voxels = v.voxels.data() + v.index(0, j, k);
      std::uint16_t* row = values_.data() + index(0, j, k);
      for (int i = low[0]; i <= high[0]; ++i) {
        const std::uint16_t now = std::uint16_t(share(voxels[i], i, j, k));
        if (row[i] == now) continue;
        row[i] = now;
        changed = true;
        const int voxel[3] = {i, j, k};
        int first[3], last[3];
        for (int a = 0; a < 3; ++a) {
          first[a] = layout_.first_reader(voxel[a], 0);
          last[a] = layout_.last_reader(a, voxel[a], 0);
        }
        for (int z = first[2]; z <= last[2]; ++z)
          for (int y = first[1]; y <= last[1]; ++y)
            for (int x = first[0]; x <= last[0]; ++x) reads_it_[layout_.index(x, y, z)] = 1;
      }
    }
  return changed;
}

const std::vector<std::size_t>& ShadowVolume::follow(const std::vector<std::size_t>& marked) {
  stale_.clear();
  copied_.clear();
  // A mark may come after its change, so a brick is made anew where its values changed, and not where it is marked.
  for (const std::size_t b : marked)
    if (copy(b)) copied_.push_back(b);
  for (const std::size_t b : copied_) {
    const std::array<int, 3> at = layout_.place(b);
    for (int z = std::max(0, at[2] - 1); z <= std::min(layout_.bricks[2] - 1, at[2] + 1); ++z)
      for (int y = std::max(0, at[1] - 1); y <= std::min(layout_.bricks[1] - 1, at[1] + 1); ++y)
        for (int x = std::max(0, at[0] - 1); x <= std::min(layout_.bricks[0] - 1, at[0] + 1); ++x) {
          const std::size_t n = layout_.index(x, y, z);
          if (reads_it_[n] == 0) continue;
          reads_it_[n] = 0;
          stale_.push_back(n);
        }
  }
  std::sort(stale_.begin(), stale_.end());
  return stale_;
}

bool has_triangles(const ShadowVolume& shadow, std::size_t brick) {
  const std::uint16_t* const first = first_corner(shadow, shadow.layout().place(brick));
  const bool solid = *first >= solid_from;
  for (int z = 0; z < corners; ++z)
    for (int y = 0; y < corners; ++y) {
      const std::uint16_t* from = first + std::size_t(z) * shadow.slice() + std::size_t(y) * shadow.row();
      for (int x = 0; x < corners; ++x)
        if ((from[x] >= solid_from) != solid) return true;
    }
  return false;
}

void mesh_brick(const ShadowVolume& shadow, std::size_t brick, BrickMesh& out) {
  out.vertices.clear();
  out.indices.clear();
  const std::array<int, 3> at = shadow.layout().place(brick);
  const std::size_t row = shadow.row(), slice = shadow.slice();
  const int begin[3] = {side * at[0] - 1, side * at[1] - 1, side * at[2] - 1};
  const std::uint16_t* const first = first_corner(shadow, at);
  bool some = false, all = true;
  std::uint8_t solid[corners][corners][corners];
  for (int z = 0; z < corners; ++z)
    for (int y = 0; y < corners; ++y) {
      const std::uint16_t* from = first + std::size_t(z) * slice + std::size_t(y) * row;
      for (int x = 0; x < corners; ++x) {
        const bool in = from[x] >= solid_from;
        solid[z][y][x] = in;
        some = some || in;
        all = all && in;
      }
    }
  if (!some || all) return;
  const Vec3 s = shadow.spacing_mm();
  const float spacing[3] = {float(s.x), float(s.y), float(s.z)};
  const std::size_t step[3] = {1, row, slice};
  std::int16_t known[3][corners][corners][corners];  // the vertex of the edge from a corner along an axis
  std::fill_n(&known[0][0][0][0], 3 * corners * corners * corners, std::int16_t(-1));
  const auto vertex = [&](int axis, int x, int y, int z) {
    std::int16_t& number = known[axis][z][y][x];
    if (number >= 0) return number;
    number = std::int16_t(out.vertices.size());
    const std::uint16_t* p = first + std::size_t(z) * slice + std::size_t(y) * row + std::size_t(x);
    const std::uint16_t* q = p + step[axis];
    const float t = (level - float(*p)) / (float(*q) - float(*p));
    const int voxel[3] = {begin[0] + x, begin[1] + y, begin[2] + z};
    LiveVertex v;
    float length = 0;
    for (int a = 0; a < 3; ++a) {
      v.position_mm[a] = (float(voxel[a]) + (a == axis ? t : 0)) * spacing[a];
      const std::size_t d = step[a];
      const float at_p = float(p[d]) - float(*(p - d)), at_q = float(q[d]) - float(*(q - d));
      v.normal[a] = -(at_p + t * (at_q - at_p)) / spacing[a];
      length += v.normal[a] * v.normal[a];
    }
    if (!(length > 0)) {
      v.normal[axis] = *p > *q ? 1.0f : -1.0f;
      length = 1;
    }
    const float scale = 1 / std::sqrt(length);
    for (float& n : v.normal) n *= scale;
    out.vertices.push_back(v);
    return number;
  };
  const auto& table = detail::cell_triangles();
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        int set = 0;
        for (int c = 0; c < 8; ++c) set |= solid[z + (c >> 2)][y + (c >> 1 & 1)][x + (c & 1)] << c;
        if (set == 0 || set == 255) continue;
        const detail::CellTriangles& t = table[std::size_t(set)];
        for (int n = 0; n < 3 * t.count; ++n) {
          const int edge = t.edge[std::size_t(n)], c = detail::low_corner(edge);
          out.indices.push_back(std::uint16_t(vertex(edge >> 2, x + (c & 1), y + (c >> 1 & 1), z + (c >> 2))));
        }
      }
}

LiveSurface::LiveSurface(const voxel::HapticVolume& volume, int number)
    : shadow_(volume, number), bricks_(shadow_.layout().count()) {
  parallel_for(0, std::int64_t(bricks_.size()), 64, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t b = from; b < to; ++b) mesh_brick(shadow_, std::size_t(b), bricks_[std::size_t(b)]);
  });
}

const std::vector<std::size_t>& LiveSurface::update(const std::vector<std::size_t>& marked) {
  const std::vector<std::size_t>& stale = shadow_.follow(marked);
  make(stale);
  return stale;
}

void LiveSurface::make(const std::vector<std::size_t>& bricks) {
  for (const std::size_t b : bricks) mesh_brick(shadow_, b, bricks_[b]);
}

std::size_t LiveSurface::triangles() const {
  std::size_t n = 0;
  for (const BrickMesh& b : bricks_) n += b.indices.size() / 3;
  return n;
}

}  // namespace trephine::drill

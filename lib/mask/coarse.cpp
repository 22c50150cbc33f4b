// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/coarse.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace trephine::mask {
namespace {

/// The two cells between which each voxel's centre lies along one axis, and its position between them.
struct Between {
  std::vector<int> low, high;
  std::vector<float> part;
};

Between between(const CoarseRaster& r, int axis) {
  Between b;
  const int last = r.cells.size[axis] - 1, f = r.factor[axis];
  for (int i = 0; i < r.fine.size[axis]; ++i) {
    const double x = std::clamp((i - (f - 1) / 2.0) / f, 0.0, double(last));
    const int low = std::min(int(x), std::max(0, last - 1));
    b.low.push_back(low);
    b.high.push_back(std::min(low + 1, last));
    b.part.push_back(float(x - low));
  }
  return b;
}

/// The cell of each voxel of a row: looked up, since a division takes longer than what is done with the voxel.
std::vector<int> cells_of_row(const CoarseRaster& r) {
  std::vector<int> cell(std::size_t(r.fine.size[0]));
  for (std::size_t x = 0; x < cell.size(); ++x) cell[x] = int(x) / r.factor[0];
  return cell;
}

/// The mean of each cell, `nowhere` where it is of nothing. `row(y, z, add)` calls add(x, value) for what counts in the
/// fine raster's row, in the order of x. A cell's values are added as Sum, in the order of z, y and x.
template <class Sum, class Row>
grid::Grid<float> mean_of_cells(const CoarseRaster& r, float nowhere, const Row& row) {
  grid::Grid<float> mean(r.cells, nowhere);
  parallel_for(0, r.cells.size[2], 2, [&](std::int64_t from, std::int64_t to) {
    std::vector<Sum> sum(r.cells.size[0]);
    std::vector<int> count(r.cells.size[0]);
    const std::vector<int> cell = cells_of_row(r);
    const auto add = [&](int x, float value) {
      sum[cell[x]] += value;
      ++count[cell[x]];
    };
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < r.cells.size[1]; ++j) {
        std::fill(sum.begin(), sum.end(), Sum(0));
        std::fill(count.begin(), count.end(), 0);
        for (int z = k * r.factor[2]; z < std::min(r.fine.size[2], (k + 1) * r.factor[2]); ++z)
          for (int y = j * r.factor[1]; y < std::min(r.fine.size[1], (j + 1) * r.factor[1]); ++y) row(y, z, add);
        float* out = &mean.at(0, j, k);
        for (int i = 0; i < r.cells.size[0]; ++i)
          if (count[i]) out[i] = float(sum[i] / Sum(count[i]));
      }
  });
  return mean;
}

}  // namespace

CoarseRaster coarse_raster(const grid::Lattice& fine, double cell_mm, bool at_most) {
  std::array<int, 3> factor;
  for (int a = 0; a < 3; ++a) {
    const double voxels = cell_mm / fine.spacing_mm[a];
    // Spacings that were rounded to float differ by at most 1e-7.
    const double whole = at_most ? std::floor(voxels + 1e-6) : std::round(voxels);
    factor[a] = int(std::clamp(whole, 1.0, std::max(1.0, double(fine.size[a]))));
  }
  return coarse_raster(fine, factor);
}

CoarseRaster coarse_raster(const grid::Lattice& fine, const std::array<int, 3>& factor) {
  CoarseRaster r{fine, fine, factor};
  Vec3 middle;
  for (int a = 0; a < 3; ++a) {
    r.cells.size[a] = (fine.size[a] + factor[a] - 1) / factor[a];
    r.cells.spacing_mm[a] = fine.spacing_mm[a] * factor[a];
    middle[a] = (factor[a] - 1) / 2.0;
  }
  r.cells.origin_mm = fine.to_world_mm(middle);
  return r;
}

BitMask fine_mask(const BitMask& cells, const CoarseRaster& raster) {
  const auto& factor = raster.factor;
  return make_mask(raster.fine, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0, c = 0; i < raster.fine.size[0]; ++c) {
      const std::uint8_t set = cells.get(c, j / factor[1], k / factor[2]);
      for (const int end = std::min(i + factor[0], raster.fine.size[0]); i < end; ++i) row[i] = set;
    }
  });
}

BitMask coarse_mask(const BitMask& fine, const CoarseRaster& r, double share) {
  const grid::Lattice& l = r.fine;
  const int fx = r.factor[0];
  const std::vector<int> cell = cells_of_row(r);
  return make_mask(r.cells, [&](int j, int k, std::uint8_t* row) {
    const int z0 = k * r.factor[2], z1 = std::min(l.size[2], z0 + r.factor[2]);
    const int y0 = j * r.factor[1], y1 = std::min(l.size[1], y0 + r.factor[1]);
    if (share <= 0) {
      std::vector<std::uint64_t> any(fine.words());
      for (int z = z0; z < z1; ++z)
        for (int y = y0; y < y1; ++y)
          for (int w = 0; w < fine.words(); ++w) any[w] |= fine.row(y, z)[w];
      for (int w = 0; w < fine.words(); ++w)
        for (std::uint64_t bits = any[w]; bits; bits &= bits - 1) row[cell[w * 64 + __builtin_ctzll(bits)]] = 1;
      return;
    }
    std::vector<int> count(r.cells.size[0]);
    for (int z = z0; z < z1; ++z)
      for (int y = y0; y < y1; ++y)
        for (int w = 0; w < fine.words(); ++w)
          for (std::uint64_t bits = fine.row(y, z)[w]; bits; bits &= bits - 1)
            ++count[cell[w * 64 + __builtin_ctzll(bits)]];
    for (int i = 0; i < r.cells.size[0]; ++i) {
      const int wide = std::min(l.size[0], (i + 1) * fx) - i * fx;
      row[i] = count[i] >= share * wide * (y1 - y0) * (z1 - z0) - 1e-9;
    }
  });
}

grid::Grid<float> coarse_mean(const HuView& hu, const BitMask& known, const CoarseRaster& r, float nowhere) {
  const grid::Box at = grid::place_in(r.fine, hu.lattice());
  return mean_of_cells<float>(r, nowhere, [&](int y, int z, const auto& add) {
    const std::size_t start = hu.lattice().index(at.begin[0], at.begin[1] + y, at.begin[2] + z);
    const std::uint64_t* row = known.row(y, z);
    for (int w = 0; w < known.words(); ++w)
      for (std::uint64_t bits = row[w]; bits; bits &= bits - 1) {
        const int x = w * 64 + __builtin_ctzll(bits);
        add(x, hu(start + std::size_t(x)));
      }
  });
}

grid::Field coarse_mean(const grid::Field& field, const CoarseRaster& r) {
  return mean_of_cells<double>(r, 0, [&](int y, int z, const auto& add) {
    const float* row = &field.at(0, y, z);
    for (int x = 0; x < field.size[0]; ++x) add(x, row[x]);
  });
}

grid::Field refined(const grid::Field& cells, const CoarseRaster& r) {
  const Between x = between(r, 0), y = between(r, 1), z = between(r, 2);
  grid::Field fine(r.fine);
  const int nx = cells.size[0];
  parallel_for(0, r.fine.size[2], 2, [&](std::int64_t from, std::int64_t to) {
    std::vector<float> line(nx);
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < r.fine.size[1]; ++j) {
        const float v = y.part[j], w = z.part[k];
        const float *a = &cells.at(0, y.low[j], z.low[k]), *b = &cells.at(0, y.high[j], z.low[k]),
                    *c = &cells.at(0, y.low[j], z.high[k]), *d = &cells.at(0, y.high[j], z.high[k]);
        for (int i = 0; i < nx; ++i) line[i] = (1 - w) * ((1 - v) * a[i] + v * b[i]) + w * ((1 - v) * c[i] + v * d[i]);
        float* out = &fine.at(0, j, k);
        for (int i = 0; i < r.fine.size[0]; ++i)
          out[i] = line[x.low[i]] + x.part[i] * (line[x.high[i]] - line[x.low[i]]);
      }
  });
  return fine;
}

}  // namespace trephine::mask

// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/bits.h"

#include <algorithm>
#include <bitset>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"

namespace trephine::mask {

using Word = std::uint64_t;

BitMask::BitMask(const grid::Lattice& lattice)
    : lattice_(lattice),
      words_((lattice.size[0] + 63) / 64),
      bits_(std::size_t(words_) * lattice.size[1] * lattice.size[2]) {}

std::size_t BitMask::count() const {
  std::size_t n = 0;
  for (Word w : bits_) n += std::bitset<64>(w).count();
  return n;
}

bool BitMask::any() const {
  return std::any_of(bits_.begin(), bits_.end(), [](Word w) { return w != 0; });
}

grid::Box BitMask::bounds() const {
  grid::Box box;
  box.begin = lattice_.size;
  box.end = {0, 0, 0};
  for (int k = 0; k < lattice_.size[2]; ++k)
    for (int j = 0; j < lattice_.size[1]; ++j) {
      const Word* r = row(j, k);
      int first = 0, last = words_ - 1;
      while (first < words_ && !r[first]) ++first;
      if (first == words_) continue;
      while (!r[last]) --last;
      box.begin[0] = std::min(box.begin[0], first * 64 + __builtin_ctzll(r[first]));
      box.end[0] = std::max(box.end[0], last * 64 + 64 - __builtin_clzll(r[last]));
      box.begin[1] = std::min(box.begin[1], j);
      box.end[1] = std::max(box.end[1], j + 1);
      box.begin[2] = std::min(box.begin[2], k);
      box.end[2] = k + 1;
    }
  return box;
}

Vec3 BitMask::centre_mm() const {
  std::int64_t sum[3] = {0, 0, 0}, all = 0;
  for (int k = 0; k < lattice_.size[2]; ++k)
    for (int j = 0; j < lattice_.size[1]; ++j) {
      const Word* r = row(j, k);
      std::int64_t n = 0;
      for (int w = 0; w < words_; ++w)
        for (Word left = r[w]; left; left &= left - 1, ++n) sum[0] += w * 64 + __builtin_ctzll(left);
      sum[1] += n * j;
      sum[2] += n * k;
      all += n;
    }
  const double n = double(std::max<std::int64_t>(all, 1));
  return lattice_.to_world_mm({double(sum[0]) / n, double(sum[1]) / n, double(sum[2]) / n});
}

BitMask& BitMask::operator&=(const BitMask& o) {
  for (std::size_t i = 0; i < bits_.size(); ++i) bits_[i] &= o.bits_[i];
  return *this;
}
BitMask& BitMask::operator|=(const BitMask& o) {
  for (std::size_t i = 0; i < bits_.size(); ++i) bits_[i] |= o.bits_[i];
  return *this;
}
BitMask& BitMask::remove(const BitMask& o) {
  for (std::size_t i = 0; i < bits_.size(); ++i) bits_[i] &= ~o.bits_[i];
  return *this;
}
BitMask& BitMask::invert() {
  for (Word& w : bits_) w = ~w;
  trim();
  return *this;
}

void BitMask::trim() {
  const int rest = lattice_.size[0] & 63;
  if (!rest) return;
  const Word keep = (Word{1} << rest) - 1;
  for (std::size_t i = std::size_t(words_) - 1; i < bits_.size(); i += words_) bits_[i] &= keep;
}

namespace {

/// One bit for every byte, set where the byte is not 0, eight at a time.
void pack(const std::vector<std::uint8_t>& flags, Word* row) {
  constexpr Word low = 0x0101010101010101, gather = 0x0102040810204080;
  for (std::size_t i = 0; i < flags.size(); i += 8) {
    Word bytes = 0;
    for (int b = 0; b < 8; ++b) bytes |= Word(flags[i + b]) << (8 * b);
    if (!bytes) continue;
    bytes |= bytes >> 4 & 0x0f * low;
    bytes |= bytes >> 2 & 0x03 * low;
    bytes |= bytes >> 1 & low;
    row[i >> 6] |= (bytes & low) * gather >> 56 << (i & 63);
  }
}

/// Copies the bits [from, from + count) of one row to position `to` of another, whose bits there are 0.
void copy_bits(const Word* in, int from, Word* out, int to, int count) {
  while (count > 0) {
    const int shift = from & 63, room = 64 - (to & 63), n = std::min(room, count);
    Word bits = in[from >> 6] >> shift;
    if (shift + n > 64) bits |= in[(from >> 6) + 1] << (64 - shift);
    if (n < 64) bits &= (Word{1} << n) - 1;
    out[to >> 6] |= bits << (to & 63);
    from += n;
    to += n;
    count -= n;
  }
}

/// Row by row in parallel.
void for_each_row(const grid::Lattice& lattice, const std::function<void(int j, int k)>& visit) {
  parallel_for(0, lattice.size[2], 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < lattice.size[1]; ++j) visit(j, k);
  });
}

}  // namespace

BitMask make_mask(const grid::Lattice& lattice, const std::function<void(int, int, std::uint8_t*)>& test) {
  BitMask mask(lattice);
  parallel_for(0, lattice.size[2], 4, [&](std::int64_t from, std::int64_t to) {
    std::vector<std::uint8_t> flags(std::size_t(mask.words()) * 64);  // bits beyond the row's end stay 0
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < lattice.size[1]; ++j) {
        std::fill(flags.begin(), flags.end(), 0);
        test(j, k, flags.data());
        pack(flags, mask.row(j, k));
      }
  });
  return mask;
}

BitMask positive(const grid::Field& field, const grid::Lattice& lattice) {
  const grid::Box at = grid::place_in(field, lattice);
  return make_mask(lattice, [&](int j, int k, std::uint8_t* row) {
    if (j < at.begin[1] || j >= at.end[1] || k < at.begin[2] || k >= at.end[2]) return;
    const float* f = &field.voxels[field.index(0, j - at.begin[1], k - at.begin[2])];
    const int from = std::max(0, at.begin[0]), to = std::min(lattice.size[0], at.end[0]);
    for (int i = from; i < to; ++i) row[i] = f[i - at.begin[0]] > 0;
  });
}

BitMask crop(const BitMask& mask, const grid::Box& box) {
  BitMask out(grid::cropped(mask.lattice(), box));
  for_each_row(out.lattice(), [&](int j, int k) {
    copy_bits(mask.row(j + box.begin[1], k + box.begin[2]), box.begin[0], out.row(j, k), 0, out.lattice().size[0]);
  });
  return out;
}

BitMask placed(const BitMask& mask, const grid::Lattice& lattice) {
  const grid::Box at = grid::place_in(mask.lattice(), lattice);
  BitMask out(lattice);
  const int from = std::max(0, at.begin[0]), to = std::min(lattice.size[0], at.end[0]);
  for_each_row(lattice, [&](int j, int k) {
    if (j < at.begin[1] || j >= at.end[1] || k < at.begin[2] || k >= at.end[2]) return;
    copy_bits(mask.row(j - at.begin[1], k - at.begin[2]), from - at.begin[0], out.row(j, k), from, to - from);
  });
  return out;
}

namespace {

/// out |= in, shifted by n bits towards higher x (n > 0) or lower x (n < 0), |n| < 64.
void or_shifted(const Word* in, Word* out, int words, int n) {
  if (n > 0) {
    for (int w = words - 1; w >= 0; --w) out[w] |= in[w] << n | (w ? in[w - 1] >> (64 - n) : 0);
  } else {
    for (int w = 0; w < words; ++w) out[w] |= in[w] >> -n | (w + 1 < words ? in[w + 1] << (64 + n) : 0);
  }
}

/// row |= row, shifted by every distance up to `half` to both sides.
void dilate_row(Word* row, Word* scratch, int words, int half) {
  for (int reached = 0; reached < half;) {
    const int step = std::min({reached + 1, half - reached, 63});
    std::copy(row, row + words, scratch);
    or_shifted(scratch, row, words, step);
    or_shifted(scratch, row, words, -step);
    reached += step;
  }
}

struct Chord {
  int dj, dk, half;
};

// Limits the time for rows of voxels: a radius of 113 voxels takes minutes for a head.
constexpr long long max_rows = 40000;

/// The rows of a ball of that radius, by half-width, widest first.
std::vector<Chord> ball(const grid::Lattice& lattice, double radius_mm) {
  const Vec3 s = lattice.spacing_mm;
  if (!(radius_mm * radius_mm <= max_rows / M_PI * s.y * s.z))
    throw Error(ExitCode::bad_input, "", "spacing_mm",
                "voxels of " + to_text(s.y) + " x " + to_text(s.z) + " mm are too small for a radius of " +
                    to_text(radius_mm) + " mm: a ball has more than " + grouped_text(max_rows) +
                    " rows of voxels; resample the volume first");
  const double r2 = radius_mm * radius_mm * (1 + 1e-9);
  const int nj = int(radius_mm / s.y + 1e-9), nk = int(radius_mm / s.z + 1e-9);
  std::vector<Chord> chords;
  for (int dk = -nk; dk <= nk; ++dk)
    for (int dj = -nj; dj <= nj; ++dj) {
      const double rest = r2 - dj * s.y * dj * s.y - dk * s.z * dk * s.z;
      if (rest >= 0) chords.push_back({dj, dk, int(std::sqrt(rest) / s.x + 1e-9)});
    }
  std::stable_sort(chords.begin(), chords.end(), [](const Chord& a, const Chord& b) { return a.half > b.half; });
  return chords;
}

}  // namespace

BitMask dilated(const BitMask& mask, double radius_mm, const Progress& progress) {
  const grid::Lattice& lattice = mask.lattice();
  const auto chords = ball(lattice, radius_mm);
  const int words = mask.words();
  if (words == 0) return mask;
  const Word last = lattice.size[0] & 63 ? (Word{1} << (lattice.size[0] & 63)) - 1 : ~Word{0};
  const auto is_full = [&](const Word* row) {
    Word all = row[words - 1] | ~last;
    for (int w = 0; w + 1 < words; ++w) all &= row[w];
    return all == ~Word{0};
  };
  // Most rows of a mask are empty, and most of what is around it is full.
  enum Kind : std::uint8_t { empty, mixed, full };
  std::vector<Kind> kinds(std::size_t(lattice.size[1]) * lattice.size[2], mixed);
  for_each_row(lattice, [&](int j, int k) {
    const Word* row = mask.row(j, k);
    Kind& kind = kinds[std::size_t(k) * lattice.size[1] + j];
    if (std::all_of(row, row + words, [](Word w) { return w == 0; }))
      kind = empty;
    else if (is_full(row))
      kind = full;
  });
  BitMask out(lattice);
  parallel_for(0, lattice.size[2], 4, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    std::vector<Word> acc(words), scratch(words);
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < lattice.size[1]; ++j) {
        // Rows of equal width are joined before they are widened.
        Word* result = out.row(j, k);
        bool done = false;
        for (std::size_t c = 0; c < chords.size() && !done;) {
          const int half = chords[c].half;
          bool any = false;
          for (; c < chords.size() && chords[c].half == half; ++c) {
            const int sj = j + chords[c].dj, sk = k + chords[c].dk;
            if (sj < 0 || sk < 0 || sj >= lattice.size[1] || sk >= lattice.size[2]) continue;
            const Kind kind = kinds[std::size_t(sk) * lattice.size[1] + sj];
            if (kind == empty) continue;
            const Word* in = mask.row(sj, sk);
            if (kind == full) {
              std::copy(in, in + words, result);
              done = true;
              break;
            }
            if (!any) std::fill(acc.begin(), acc.end(), 0);
            any = true;
            for (int w = 0; w < words; ++w) acc[w] |= in[w];
          }
          if (!any || done) continue;
          dilate_row(acc.data(), scratch.data(), words, half);
          for (int w = 0; w < words; ++w) result[w] |= acc[w];
          done = is_full(result);
        }
        result[words - 1] &= last;
      }
  });
  return out;
}

BitMask eroded(const BitMask& mask, double radius_mm, const Progress& progress) {
  BitMask outside = mask;
  outside.invert();
  outside = dilated(outside, radius_mm, progress);
  outside.invert();
  return outside;
}

BitMask closed(const BitMask& mask, double radius_mm, const Progress& progress) {
  grid::Lattice room = mask.lattice();
  Vec3 corner;
  for (int a = 0; a < 3; ++a) {
    const int margin = int(std::ceil(radius_mm / room.spacing_mm[a])) + 1;
    room.size[a] += 2 * margin;
    corner[a] = -margin;
  }
  room.origin_mm = mask.lattice().to_world_mm(corner);
  return placed(eroded(dilated(placed(mask, room), radius_mm, progress), radius_mm, progress), mask.lattice());
}

BitMask dilated_6(const BitMask& mask) {
  const grid::Lattice& lattice = mask.lattice();
  const int words = mask.words();
  BitMask out = mask;
  parallel_for(0, lattice.size[2], 8, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < lattice.size[1]; ++j) {
        Word* r = out.row(j, k);
        const auto add = [&](const Word* in) {
          for (int w = 0; w < words; ++w) r[w] |= in[w];
        };
        or_shifted(mask.row(j, k), r, words, 1);
        or_shifted(mask.row(j, k), r, words, -1);
        if (j > 0) add(mask.row(j - 1, k));
        if (j + 1 < lattice.size[1]) add(mask.row(j + 1, k));
        if (k > 0) add(mask.row(j, k - 1));
        if (k + 1 < lattice.size[2]) add(mask.row(j, k + 1));
        if (const int rest = lattice.size[0] & 63) r[words - 1] &= (Word{1} << rest) - 1;
      }
  });
  return out;
}

BitMask grown_within(const BitMask& mask, const BitMask& domain, double radius_mm, const Progress& progress) {
  const Vec3 s = mask.lattice().spacing_mm;
  BitMask reach = dilated(mask, radius_mm, progress);
  reach &= domain;
  BitMask grown = mask;
  const int steps = int(radius_mm / std::min({s.x, s.y, s.z}) + 1e-9);
  for (int step = 0; step < steps; ++step) {
    progress.check();
    BitMask next = dilated_6(grown);
    next &= reach;
    next |= mask;
    grown = std::move(next);
  }
  return grown;
}

}  // namespace trephine::mask

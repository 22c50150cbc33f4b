// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/hu.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

namespace trephine::dicom {
namespace {

enum Flag : std::uint8_t { is_padding = 1, is_clamped = 2, is_below_air = 4, is_beyond = 8, is_of_more_bits = 16 };

struct Mapped {
  double value;
  std::uint8_t flags;
};

std::int64_t decode(const HuRule& r, std::uint32_t word, int bits_stored) {
  const std::uint32_t mask = bits_stored >= 32 ? 0xffffffffu : (1u << bits_stored) - 1;
  const std::uint32_t bits = word & mask;  // what stands above the stored bits (overlays) is no part of the value
  if (r.is_signed && (bits >> (bits_stored - 1)) != 0) return std::int64_t{bits} - (std::int64_t{mask} + 1);
  return bits;
}

bool is_padded(const HuRule& r, std::uint32_t word, std::int64_t value) {
  if (!r.padding) return false;
  const auto declared = [&](std::uint16_t p) {
    if (r.bits_allocated == 8) return r.is_signed ? std::int64_t{static_cast<std::int8_t>(p)} : std::int64_t{p & 0xff};
    return r.is_signed ? std::int64_t{static_cast<std::int16_t>(p)} : std::int64_t{p};
  };
  const std::int64_t a = declared(*r.padding), b = r.padding_limit ? declared(*r.padding_limit) : a;
  // Some scanners write a padding that does not fit the stored bits: compare the whole word as well.
  return (value >= std::min(a, b) && value <= std::max(a, b)) || (r.bits_allocated == 16 && word == *r.padding);
}

Mapped map_word(const HuRule& r, std::uint32_t word) {
  const std::int64_t stored = decode(r, word, r.bits_stored);
  if (is_padded(r, word, stored)) return {r.air, is_padding};
  const double hu = static_cast<double>(stored) * r.slope + r.intercept;
  Mapped m{hu, 0};
  if (r.counts_more_bits && decode(r, word, r.bits_allocated) != stored) m.flags |= is_of_more_bits;
  if (hu < -1024) m.flags |= is_below_air;
  if (hu < r.low) m = {r.low, std::uint8_t(m.flags | is_clamped)};
  if (hu > r.high) m = {r.high, std::uint8_t(m.flags | is_clamped)};
  return m;
}

template <class T>
T to_sample(Mapped& m);
template <>
float to_sample<float>(Mapped& m) {
  return static_cast<float>(m.value);
}
template <>
std::int16_t to_sample<std::int16_t>(Mapped& m) {
  const double v = std::nearbyint(m.value);
  if (v < -32768 || v > 32767) m.flags |= is_beyond;
  return static_cast<std::int16_t>(std::clamp(v, -32768.0, 32767.0));
}

void count_flags(std::uint8_t flags, HuCounts& counts) {
  counts.padding += (flags & is_padding) != 0;
  counts.clamped += (flags & is_clamped) != 0;
  counts.below_air += (flags & is_below_air) != 0;
  counts.more_bits += (flags & is_of_more_bits) != 0;
}

}  // namespace

bool HuRule::is_integral() const { return slope == std::floor(slope) && intercept == std::floor(intercept); }

bool operator==(const HuRule& a, const HuRule& b) {
  const auto key = [](const HuRule& r) {
    return std::tie(r.bits_allocated, r.bits_stored, r.is_signed, r.counts_more_bits, r.slope, r.intercept, r.padding,
                    r.padding_limit, r.air, r.low, r.high);
  };
  return key(a) == key(b);
}

HuRule hu_rule(const FileHeader& h, const Frame& f, double low, double high) {
  HuRule r;
  r.bits_allocated = h.bits_allocated;
  r.bits_stored = h.bits_stored;
  r.is_signed = h.is_signed;
  r.slope = f.slope.value_or(1);
  r.intercept = f.intercept.value_or(0);
  r.padding = h.padding;
  r.padding_limit = h.padding_limit;
  r.air = h.is_ct() ? air_hu : 0;
  r.low = low;
  r.high = high;
  return r;
}

void HuCounts::add(const HuCounts& o) {
  padding += o.padding;
  clamped += o.clamped;
  below_air += o.below_air;
  more_bits += o.more_bits;
  min = std::min(min, o.min);
  max = std::max(max, o.max);
}

template <class T>
void HuMapper<T>::make_table(const HuRule& rule) {
  const std::size_t words = std::size_t{1} << rule.bits_allocated;
  values_.resize(words);
  flags_.resize(words);
  for (std::size_t w = 0; w < words; ++w) {
    Mapped m = map_word(rule, static_cast<std::uint32_t>(w));
    values_[w] = to_sample<T>(m);
    flags_[w] = m.flags;
  }
  rule_ = rule;
}

template <class T>
void HuMapper<T>::apply(const HuRule& rule, const std::uint8_t* stored, std::size_t count, T* out, HuCounts& counts) {
  std::uint8_t beyond = 0;
  if (rule.bits_allocated == 32) {
    for (std::size_t i = 0; i < count; ++i) {
      Mapped m = map_word(rule, le32(stored + 4 * i));
      out[i] = to_sample<T>(m);
      beyond |= m.flags & is_beyond;
      count_flags(m.flags, counts);
    }
  } else {
    if (!rule_ || !(*rule_ == rule)) make_table(rule);
    constexpr std::size_t block = 4096;  // flags are rare: counted only in blocks that have any
    for (std::size_t from = 0; from < count; from += block) {
      const std::size_t to = std::min(count, from + block);
      std::uint8_t seen = 0;
      const auto word = [&](std::size_t i) -> std::size_t {
        return rule.bits_allocated == 8 ? stored[i] : le16(stored + 2 * i);
      };
      for (std::size_t i = from; i < to; ++i) {
        const std::size_t w = word(i);
        out[i] = values_[w];
        seen |= flags_[w];
      }
      beyond |= seen & is_beyond;
      if (seen & ~is_beyond)
        for (std::size_t i = from; i < to; ++i) count_flags(flags_[word(i)], counts);
    }
  }
  const auto [low, high] = std::minmax_element(out, out + count);
  if (count > 0) {
    counts.min = std::min(counts.min, static_cast<double>(*low));
    counts.max = std::max(counts.max, static_cast<double>(*high));
  }
  if (beyond) counts.max = std::numeric_limits<double>::infinity();
}

template class HuMapper<std::int16_t>;
template class HuMapper<float>;

}  // namespace trephine::dicom

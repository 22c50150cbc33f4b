// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "dicom/header.h"

namespace trephine::dicom {

constexpr double air_hu = -1000;

/// How one slice's stored words become values.
struct HuRule {
  int bits_allocated = 16, bits_stored = 16;
  bool is_signed = false;
  /// Words whose bits above the stored ones say anything else are counted: where bits_stored differs within a series,
  /// it is believed only of slices in which it changes nothing.
  bool counts_more_bits = false;
  double slope = 1, intercept = 0;
  std::optional<std::uint16_t> padding, padding_limit;
  double air = air_hu;  ///< value of padding
  double low = -1e6, high = 1e6;

  /// Whether slope and intercept are integers, so that every value is one.
  bool is_integral() const;
};
bool operator==(const HuRule& a, const HuRule& b);
HuRule hu_rule(const FileHeader& header, const Frame& frame, double low, double high);

struct HuCounts {
  std::int64_t padding = 0, clamped = 0;
  std::int64_t below_air = 0;  ///< below -1024 and not declared as padding
  std::int64_t more_bits = 0;  ///< of more bits than are stored, where HuRule::counts_more_bits is set
  double min = std::numeric_limits<double>::infinity(), max = -std::numeric_limits<double>::infinity();
  void add(const HuCounts& o);
  bool fits_int16() const { return !(min < -32768) && !(max > 32767); }
};

/// Applies a rule through a table of all stored words, which is made again only where the rule changes. T is float, or
/// int16, for which rules must be integral; a value beyond int16 is clamped, and counts.fits_int16() says so.
template <class T>
class HuMapper {
 public:
  /// `stored`: count words of bits_allocated bits, little endian.
  void apply(const HuRule& rule, const std::uint8_t* stored, std::size_t count, T* out, HuCounts& counts);

 private:
  void make_table(const HuRule& rule);
  std::optional<HuRule> rule_;
  std::vector<T> values_;
  std::vector<std::uint8_t> flags_;
  double least_ = 0, most_ = 0;
};

extern template class HuMapper<std::int16_t>;
extern template class HuMapper<float>;

}  // namespace trephine::dicom

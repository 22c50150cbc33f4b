// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

#include "grid/gzip_limit.h"

struct z_stream_s;

namespace trephine::grid::detail {

bool is_gzip(std::string_view bytes);

/// A file's bytes in order, inflated where they are compressed (several gzip members make one stream). Throws Error 65,
/// field "data", where they are cut short or damaged. For the sources of this room only.
class ByteSource {
 public:
  ByteSource(std::string_view bytes, GzipLimit limit);
  ~ByteSource();
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  /// Whether so many bytes can follow at all (deflate gains at most a factor of 1032).
  bool may_hold(std::uint64_t count) const;
  /// Throws Error 65 where compressed bytes would grow to more than the limit allows.
  void require_growth(std::uint64_t count) const;
  void read(char* out, std::size_t count);
  void skip(std::uint64_t count);
  /// Throws Error 65 where more follows: the header does not say what the file holds. A gzip stream's checksum is
  /// compared here.
  void require_end();

 private:
  /// As many as there are, at most `count`.
  std::size_t read_some(char* out, std::size_t count);
  std::string_view bytes_;
  const GzipLimit limit_;
  std::size_t at_ = 0;
  std::unique_ptr<z_stream_s> z_;  ///< null: not compressed
  bool ended_ = false;             ///< at the end of a member of the gzip stream
};

}  // namespace trephine::grid::detail

// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/byte_source.h"

#define ZLIB_CONST
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "base/error.h"

namespace trephine::grid::detail {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw Error(ExitCode::bad_input, "", "data", what); }

}  // namespace

bool is_gzip(std::string_view bytes) { return bytes.size() > 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b'; }

ByteSource::ByteSource(std::string_view bytes, GzipLimit limit) : bytes_(bytes), limit_(limit) {
  if (!is_gzip(bytes)) return;
  z_ = std::make_unique<z_stream>();
  if (inflateInit2(z_.get(), 15 + 16) != Z_OK) throw Error(ExitCode::internal, "", "gzip", "cannot start");
}

ByteSource::~ByteSource() {
  if (z_) inflateEnd(z_.get());
}

bool ByteSource::may_hold(std::uint64_t count) const {
  return z_ ? count / 1032 <= bytes_.size() : count <= bytes_.size() - at_;
}

void ByteSource::require_growth(std::uint64_t count) const {
  if (z_ && count > limit_.bytes(bytes_.size()))
    refuse(std::to_string(bytes_.size()) + " bytes would grow to " + std::to_string(count) + ", which no scan's do");
}

std::size_t ByteSource::read_some(char* out, std::size_t count) {
  if (!z_) {
    count = std::min(count, bytes_.size() - at_);
    if (count > 0) std::memcpy(out, bytes_.data() + at_, count);
    at_ += count;
    return count;
  }
  z_->next_out = reinterpret_cast<Bytef*>(out);
  z_->avail_out = static_cast<uInt>(count);  // callers read pieces of a few MB
  while (z_->avail_out > 0) {
    if (z_->avail_in == 0 && at_ < bytes_.size()) {
      z_->next_in = reinterpret_cast<const Bytef*>(bytes_.data()) + at_;
      z_->avail_in = static_cast<uInt>(std::min<std::size_t>(bytes_.size() - at_, std::size_t{1} << 30));
      at_ += z_->avail_in;
    }
    const bool starved = z_->avail_in == 0 && at_ == bytes_.size();
    if (ended_) {
      if (starved) break;
      if (inflateReset(z_.get()) != Z_OK) refuse("the gzip stream is damaged");
      ended_ = false;
    }
    const int result = inflate(z_.get(), Z_NO_FLUSH);
    if (result == Z_STREAM_END)
      ended_ = true;
    else if (result == Z_BUF_ERROR && starved)
      refuse("the file is cut short");
    else if (result != Z_OK && result != Z_BUF_ERROR)
      refuse("the gzip stream is damaged");
  }
  return count - z_->avail_out;
}

void ByteSource::read(char* out, std::size_t count) {
  if (read_some(out, count) != count) refuse("the file is cut short");
}

void ByteSource::skip(std::uint64_t count) {
  std::vector<char> scratch(std::min<std::uint64_t>(count, 1 << 16));
  for (; count > 0; count -= std::min<std::uint64_t>(count, scratch.size()))
    read(scratch.data(), std::min<std::uint64_t>(count, scratch.size()));
}

void ByteSource::require_end() {
  char one = 0;
  if (read_some(&one, 1) != 0) refuse("is longer than the header says");
}

}  // namespace trephine::grid::detail

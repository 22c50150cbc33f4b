// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>

#include "dicom/header.h"
#include "dicom/header_tags.h"

namespace trephine::dicom {
namespace {

constexpr std::uint64_t max_pixel_bytes = std::uint64_t{4} << 30;
constexpr std::uint64_t max_compressed_frame = std::uint64_t{256} << 20;  // decoded; 8192 x 8192 words take 128 MiB

class PixelCheck {
 public:
  PixelCheck(FileHeader& header, ByteSource& source, int representation)
      : h_(header), source_(source), representation_(representation) {}

  void check() {
    if (h_.pixels.tag == 0) return fault(t_pixels, "missing");
    if (h_.pixels.tag != t_pixels) return fault(h_.pixels.tag, "not supported, only integer pixel data");
    if (h_.syntax->encoding == Encoding::unsupported)
      return fault(t_transfer_syntax, std::string(h_.syntax->name) + " is not supported");
    if (h_.rows == 0) return fault(t_rows, "missing or 0");
    if (h_.columns == 0) return fault(t_columns, "missing or 0");
    const int a = h_.bits_allocated;
    if (a != 8 && a != 16 && a != 32) return fault(t_allocated, fmt::format("{}, must be 8, 16 or 32", a));
    if (h_.bits_stored < 1 || h_.bits_stored > a)
      return fault(t_stored, fmt::format("{}, must be 1 to BitsAllocated {}", h_.bits_stored, a));
    if (h_.high_bit != h_.bits_stored - 1)
      return fault(t_high_bit, fmt::format("{}, must be BitsStored - 1 = {}", h_.high_bit, h_.bits_stored - 1));
    if (representation_ != 0 && representation_ != 1)
      return fault(t_representation, "missing, or neither 0 (unsigned) nor 1 (signed)");
    h_.is_signed = representation_ == 1;
    if (h_.samples != 1) return fault(t_samples, fmt::format("{}, must be 1", h_.samples));
    if (!h_.photometric.empty() && h_.photometric != "MONOCHROME2" && h_.photometric != "MONOCHROME1")
      return fault(t_photometric, "must be MONOCHROME1 or MONOCHROME2");
    if (h_.frame_count < 1 || h_.frame_count > max_frames)
      return fault(t_frames, fmt::format("must be 1 to {}", max_frames));
    const std::uint64_t bytes = h_.frame_bytes() * static_cast<std::uint64_t>(h_.frame_count);
    if (bytes > max_pixel_bytes)
      return fault(t_rows, fmt::format("{} x {} x {} frames make {} bytes, at most 4 GiB a file are read", h_.columns,
                                       h_.rows, h_.frame_count, bytes));
    const std::uint64_t remain = source_.size() - std::min(source_.size(), h_.pixels.offset);
    if (h_.syntax->encoding == Encoding::native) {
      if (h_.pixels.undefined_length) return fault(t_pixels, "undefined length in an uncompressed transfer syntax");
      if (h_.pixels.length > remain)
        return fault(t_pixels, fmt::format("claims {} bytes, {} remain in the file", h_.pixels.length, remain));
      if (h_.pixels.length < bytes)
        return fault(t_pixels, fmt::format("{} bytes, {} are needed", h_.pixels.length, bytes));
    } else {
      if (!h_.pixels.undefined_length)
        return fault(t_pixels, std::string("not encapsulated, as ") + h_.syntax->name + " must be");
      if (h_.frame_bytes() > max_compressed_frame)
        return fault(t_rows,
                     fmt::format("a compressed frame of {} x {}, at most 256 MiB are decoded", h_.columns, h_.rows));
      if (a == 32) return fault(t_allocated, std::string("32 is not supported in ") + h_.syntax->name);
      check_fragments();
    }
  }

 private:
  void fault(std::uint32_t tag, const std::string& what) { h_.faults.push_back({tag, what}); }

  // Finds which fragments belong to which frame: one fragment a frame, or as the basic offset table says.
  void check_fragments() {
    std::vector<Fragment> all;
    try {
      all = walk_fragments(source_, h_.pixels.offset, source_.size());
    } catch (const WalkFault& f) {
      return fault(t_pixels, f.what);
    }
    if (all.size() < 2) return fault(t_pixels, "holds no compressed data");
    const Fragment table = all.front();
    h_.fragments.assign(all.begin() + 1, all.end());
    const std::size_t count = h_.fragments.size(), frames = static_cast<std::size_t>(h_.frame_count);
    if (frames == 1) {
      h_.frame_fragments = {{0, count}};
    } else if (count == frames) {
      for (std::size_t i = 0; i < frames; ++i) h_.frame_fragments.push_back({i, i + 1});
    } else {
      if (table.length != frames * 4 || table.length > ByteSource::max_value)
        return fault(t_pixels, fmt::format("{} fragments for {} frames and no offset table", count, frames));
      const std::uint8_t* p = source_.get(table.offset, table.length);
      if (!p) return fault(t_pixels, "the offset table is cut short");
      const std::uint64_t base = h_.fragments.front().offset - 8;
      std::size_t at = 0;
      for (std::size_t i = 0; i < frames; ++i) {
        if (h_.fragments[at].offset - 8 - base != le32(p + 4 * i)) return fault(t_pixels, "a wrong offset table");
        const std::size_t from = at++;
        while (at < count && (i + 1 == frames || h_.fragments[at].offset - 8 - base < le32(p + 4 * (i + 1)))) ++at;
        if (at == count && i + 1 < frames) return fault(t_pixels, "a wrong offset table");
        h_.frame_fragments.push_back({from, at});
      }
    }
    // No codec makes a stream much larger than its image, so the bytes that are read at once stay bounded by the image.
    const std::uint64_t most = 4 * h_.frame_bytes() + (1 << 20);
    for (const auto& [from, to] : h_.frame_fragments) {
      std::uint64_t stream = 0;
      for (std::size_t i = from; i < to; ++i) stream += h_.fragments[i].length;
      if (stream > most)
        return fault(t_pixels, fmt::format("{} compressed bytes for a frame of {} bytes", stream, h_.frame_bytes()));
    }
  }

  FileHeader& h_;
  ByteSource& source_;
  const int representation_;
};

}  // namespace

void check_pixels(FileHeader& header, ByteSource& source, int representation) {
  PixelCheck(header, source, representation).check();
}

}  // namespace trephine::dicom

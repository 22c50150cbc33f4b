// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/decode.h"

#include <system_error>

#include "base/error.h"
#include "base/hash.h"

namespace trephine::dicom {
namespace {

[[noreturn]] void lost(const FileHeader& h) {
  throw Error(ExitCode::io, h.name, tag_name(h.pixels.tag), "cannot be read, or the file shrank meanwhile");
}

/// Calls f(source) and turns a fault of the system into an Error.
template <class F>
void with_source(const FileHeader& h, F&& f) {
  try {
    ByteSource source(h.origin);
    f(source);
  } catch (const std::system_error&) {
    lost(h);
  }
}

void hash_bytes(const FileHeader& h, ByteSource& source, std::uint64_t offset, std::uint64_t count, Sha256& sha) {
  std::vector<char> buffer(std::min<std::uint64_t>(count, 1 << 18));
  while (count > 0) {
    const std::size_t n = static_cast<std::size_t>(std::min<std::uint64_t>(count, buffer.size()));
    if (!source.read(offset, buffer.data(), n)) lost(h);
    sha.bytes(buffer.data(), n);
    offset += n;
    count -= n;
  }
}

}  // namespace

void read_frames(const std::vector<FrameRef>& frames, const FrameSink& sink, const Progress& progress) {
  if (frames.empty()) return;
  if (frames.front().header->syntax->encoding != Encoding::native) return decode_in_child(frames, sink, progress);
  std::vector<std::uint8_t> buffer;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const FileHeader& h = *frames[i].header;
    progress.report(static_cast<double>(i) / static_cast<double>(frames.size()));
    buffer.resize(h.frame_bytes());
    with_source(h, [&](ByteSource& source) {
      if (!source.read(h.pixels.offset + h.frame_bytes() * static_cast<std::uint64_t>(frames[i].frame), buffer.data(),
                       buffer.size()))
        lost(h);
    });
    sink(i, buffer.data());
  }
}

void different_duplicates(const FileHeader& h) {
  throw Error(ExitCode::bad_input, h.name, tag_name(make_tag(0x0020, 0x0032)),
              "two slices at one position with different pixels");
}

std::string stream_of_frame(const FrameRef& ref) {
  const FileHeader& h = *ref.header;
  std::string stream;
  const auto range = h.frame_fragments[static_cast<std::size_t>(ref.frame)];
  with_source(h, [&](ByteSource& source) {
    for (std::size_t i = range[0]; i < range[1]; ++i) {
      const Fragment& f = h.fragments[i];
      const std::size_t at = stream.size();
      if (f.offset > source.size() || f.length > source.size() - f.offset) lost(h);
      stream.resize(at + f.length);
      if (!source.read(f.offset, stream.data() + at, f.length)) lost(h);
    }
  });
  return stream;
}

void check_frame_stream(const FrameRef& ref) {
  const FileHeader& h = *ref.header;
  const std::string what =
      codecs::check_codestream(h.syntax->encoding, stream_of_frame(ref), h.columns, h.rows, h.bits_allocated);
  if (!what.empty())
    throw Error(ExitCode::bad_input, h.name, tag_name(h.pixels.tag), std::string(h.syntax->name) + ": " + what);
}

std::string hash_of_frame(const FrameRef& ref) {
  const FileHeader& h = *ref.header;
  const Frame& f = h.frames[static_cast<std::size_t>(ref.frame)];
  Sha256 sha;
  sha.text("trephine dicom frame 2").text(h.syntax->uid).text(h.modality).integer(h.is_ct());
  sha.text(h.image_type)
      .text(h.kernel)
      .text(h.patient_position)
      .integer(h.contrast == "yes"  ? 1
               : h.contrast == "no" ? 2
                                    : 0)
      .number(h.tilt_tag_deg.value_or(0));
  sha.number(h.kvp.value_or(0)).integer(h.burned_in);
  sha.integer(h.rows).integer(h.columns).integer(h.bits_allocated).integer(h.bits_stored).integer(h.is_signed);
  sha.integer(h.padding ? *h.padding : -1).integer(h.padding_limit ? *h.padding_limit : -1);
  for (const Vec3& v : {*f.position_mm, (*f.orientation)[0], (*f.orientation)[1]})
    sha.number(v.x).number(v.y).number(v.z);
  sha.number((*f.spacing_mm)[0]).number((*f.spacing_mm)[1]).number(f.thickness_mm.value_or(0));
  sha.number(f.slope.value_or(1)).number(f.intercept.value_or(0));
  with_source(h, [&](ByteSource& source) {
    if (h.syntax->encoding == Encoding::native) {
      hash_bytes(h, source, h.pixels.offset + h.frame_bytes() * static_cast<std::uint64_t>(ref.frame), h.frame_bytes(),
                 sha);
    } else {
      const auto [from, to] = h.frame_fragments[static_cast<std::size_t>(ref.frame)];
      for (std::size_t i = from; i < to; ++i) {
        sha.integer(h.fragments[i].length);
        hash_bytes(h, source, h.fragments[i].offset, h.fragments[i].length, sha);
      }
    }
  });
  return sha.hex();
}

}  // namespace trephine::dicom

// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a DICOM file: the scanner says what is wrong with them, or a header that holds what it promises.
#include <cstdlib>
#include <string_view>

#include "base/child.h"
#include "base/error.h"
#include "dicom/decode.h"
#include "dicom/hu.h"

using namespace trephine;
using namespace trephine::dicom;

namespace {

void hold(bool promise) {
  if (!promise) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  run_child_if_asked(*argc, *argv);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FileHeader h;
  try {
    h = read_header(Origin::memory({reinterpret_cast<const char*>(data), size}));
  } catch (const WalkFault& f) {
    hold(!f.what.empty());
    return 0;
  }
  for (const TagFault& f : h.faults) hold(!f.what.empty());
  (void)h.has_geometry();
  if (!h.faults.empty()) return 0;
  hold(h.rows > 0 && h.columns > 0 && static_cast<int>(h.frames.size()) == h.frame_count);
  for (const Frame& f : h.frames) hold(f.position_mm && f.orientation && f.spacing_mm);
  const bool native = h.syntax->encoding == Encoding::native;
  if (native)
    hold(h.pixels.offset + h.frame_bytes() * static_cast<std::uint64_t>(h.frame_count) <= size);
  else
    hold(static_cast<int>(h.frame_fragments.size()) == h.frame_count);
  for (const auto& [from, to] : h.frame_fragments) {
    hold(from < to && to <= h.fragments.size());
    for (std::size_t i = from; i < to; ++i) hold(h.fragments[i].offset + h.fragments[i].length <= size);
  }
  const FrameRef last{&h, h.frame_count - 1};
  hold(hash_of_frame(last).size() == 64);
  try {
    if (!native) {
      check_frame_stream(last);
      return 0;
    }
    HuMapper<float> mapper;
    HuCounts counts;
    std::vector<float> hu(std::size_t(h.rows) * std::size_t(h.columns));
    read_frames({last}, [&](std::size_t, const std::uint8_t* stored) {
      mapper.apply(hu_rule(h, h.frames.back(), -1e6, 1e6), stored, hu.size(), hu.data(), counts);
    });
    for (const float v : hu) hold(v >= -1e6f && v <= 1e6f);
  } catch (const Error& e) {
    hold(e.code() == ExitCode::bad_input);
  }
  return 0;
}

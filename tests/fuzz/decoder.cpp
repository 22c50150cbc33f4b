// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a file through parent and decoding child: whatever the child does, the parent has the frames or an error
// that names the file.
#include <algorithm>
#include <cstdlib>

#include "as_file.h"
#include "base/child.h"
#include "base/error.h"
#include "dicom/decode.h"

using namespace trephine;
using namespace trephine::dicom;

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  run_child_if_asked(*argc, *argv);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FileHeader h;
  try {
    h = read_header(as_file(data, size));
  } catch (const WalkFault&) {
    return 0;
  }
  h.name = "file";
  if (!h.faults.empty() || h.frame_bytes() > (1 << 24)) return 0;
  std::vector<FrameRef> frames;
  for (int f = 0; f < std::min(h.frame_count, 4); ++f) frames.push_back({&h, f});
  std::size_t got = 0;
  try {
    read_frames(frames, [&](std::size_t i, const std::uint8_t* stored) {
      if (i != got++) std::abort();
      volatile std::uint8_t last = stored[h.frame_bytes() - 1];
      (void)last;
    });
    if (got != frames.size()) std::abort();
  } catch (const Error& e) {
    if (e.code() != ExitCode::bad_input && e.code() != ExitCode::internal) std::abort();
    if (e.file() != "file") std::abort();
  }
  return 0;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as an archive: members within their bounds, or an error.
#include <cstdio>
#include <cstdlib>

#include "as_file.h"
#include "base/child.h"
#include "base/error.h"
#include "dicom/archive.h"

using namespace trephine;
using namespace trephine::dicom;

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  run_child_if_asked(*argc, *argv);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto& file = as_file(data, size);
  if (!is_zip(file)) return 0;
  ArchiveLimits limits;
  limits.members = 100;
  limits.member_bytes = 1 << 20;
  limits.bytes = 4 << 20;
  try {
    const Archive archive = read_archive(file, {}, limits);
    std::size_t bytes = 0;
    for (const Archive::Member& m : archive.members) bytes += m.bytes.size();
    if (archive.members.size() > limits.members || bytes > limits.bytes) std::abort();
  } catch (const Error& e) {
    if (e.code() != ExitCode::bad_input) {
      std::fprintf(stderr, "%s\n", e.line("archive").c_str());
      std::abort();
    }
  }
  return 0;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "grid/nrrd.h"
#include "phantom/phantom.h"

using namespace trephine;
using namespace trephine::phantom;

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

// The full-size phantom is synthesized in about a minute on 2 cores.
TEST(LongPhantom, FullSizeScanTakesAboutAMinute) {
  const auto start = std::chrono::steady_clock::now();
  const phantom::Scan s = phantom::scan(phantom::Head(phantom::HeadParams{}), phantom::ScanParams{});
  const double seconds = seconds_since(start);
  std::printf("512 x 512 x 192: %.1f s\n", seconds);
  EXPECT_EQ(s.hu.size(), 512u * 512 * 192);
  EXPECT_LT(seconds, 180) << "thrice what an idle machine of 2 cores takes";
}

// Writes phantoms for trying things out: TREPHINE_PHANTOM_OUT=FOLDER, TREPHINE_PHANTOM_SIZE=full or small.
TEST(LongPhantom, WritesWhereAsked) {
  const char* out = std::getenv("TREPHINE_PHANTOM_OUT");
  if (!out) GTEST_SKIP() << "TREPHINE_PHANTOM_OUT is not set";
  const char* size = std::getenv("TREPHINE_PHANTOM_SIZE");
  phantom::PhantomParams p;
  if (size && std::string(size) == "small") p = phantom::sample_phantom();
  const auto start = std::chrono::steady_clock::now();
  const phantom::PhantomResult r = phantom::make_phantom(out, p);
  for (const auto& f : figures_of(r)) std::printf("%s %s\n", f.first.c_str(), to_text(f.second).c_str());
  std::printf("%.1f s\n", seconds_since(start));
  grid::write_nrrd(std::filesystem::path(out) / "volume.nrrd",
                   grid::HuVolume(phantom::volume_of(phantom::scan(phantom::Head(p.head), p.scan))));
}

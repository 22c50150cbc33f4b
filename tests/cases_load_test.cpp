// SPDX-License-Identifier: GPL-3.0-or-later
// Loading a case as the simulator does: L1 to L3 of the acceptance cases.
#include "cases/load_case.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <random>

#include "base/text.h"
#include "case_samples.h"
#include "cases_requested_memory.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;
using case_samples::MemoryCase;

// "" where it loads, else the code, the file and the field.
std::string refusal(const cases::CaseFileReader& read) {
  try {
    cases::load_case_through(read);
  } catch (const Error& e) {
    return std::to_string(int(e.code())) + " " + e.file() + ": " + e.field();
  }
  return "";
}
std::string refusal(const MemoryCase& c) { return refusal(c.reader()); }

// The case's reader with one file in another state.
cases::CaseFileReader with(const MemoryCase& c, const std::string& name, const std::string& content) {
  return [&, read = c.reader()](const std::string& asked, std::uint64_t most) {
    return asked == name ? std::vector<char>(content.begin(), content.end()) : read(asked, most);
  };
}

void flip(std::string& bytes, std::size_t bit) { bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8)); }

std::string file_of(const std::string& refusal) { return refusal.substr(0, refusal.find(':')); }

TEST(LoadCase, WhatWasPublishedIsLoaded) {
  const MemoryCase c = case_samples::minimal_case();
  ScratchFolder folder;
  c.write(folder.path());
  const cases::LoadedCase loaded = cases::load_case(folder.path());
  EXPECT_EQ(cases::to_json(loaded.manifest), c.files.at("case.json"));
  EXPECT_EQ(loaded.bytes, c.bytes());
  ASSERT_EQ(loaded.surfaces.size(), 2u);
  const surface::TriMesh* outer = loaded.find_surface("outer");
  ASSERT_TRUE(outer);
  EXPECT_EQ(outer->triangles.size(), c.manifest.anatomies[0].triangles);
  EXPECT_EQ(outer->origin_mm, c.manifest.center_mm);
  EXPECT_EQ(outer->normals.size(), outer->points_mm.size());
  EXPECT_FALSE(loaded.find_surface("nobody"));
  ASSERT_TRUE(loaded.has_haptic());
  const voxel::HapticVolume made =
      case_samples::haptic_of({{"outer", 80, 7}, {"inner", 40, 4}}, c.manifest.center_mm, 10);
  EXPECT_EQ(loaded.haptic.voxels, made.voxels);
  EXPECT_EQ(loaded.haptic.hardness, made.hardness);
  EXPECT_EQ(loaded.haptic.find_shape("inner")->number, 2);
}

TEST(LoadCase, WithoutAHapticVolume) {
  MemoryCase c = case_samples::minimal_case();
  c.manifest.haptic = {};
  c.seal();
  // Its files are named still: they are checked, and nobody reads them.
  EXPECT_EQ(refusal(c), "");
  EXPECT_FALSE(cases::load_case_through(c.reader()).has_haptic());
  c.files.at(c.manifest.files[2].name) += "x";
  EXPECT_EQ(refusal(c), "65 " + c.manifest.files[2].name + ": size");
}

TEST(LoadCase, MissingFilesAreNamed) {
  const MemoryCase c = case_samples::minimal_case();
  for (const auto& [name, content] : c.files) {
    MemoryCase less = c;
    less.files.erase(name);
    EXPECT_EQ(refusal(less), "66 " + name + ": ");
    ScratchFolder folder;
    c.write(folder.path());
    fs::remove(folder.path() / name);
    try {
      cases::load_case(folder.path());
      ADD_FAILURE() << name;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::no_input);
      EXPECT_EQ(e.file(), (folder.path() / name).string());
    }
  }
}

TEST(LoadCase, L1EveryTruncationIsRefusedNamingTheFile) {
  const MemoryCase c = case_samples::minimal_case();
  ASSERT_LE(c.bytes(), 65536u);
  std::atomic<std::size_t> tried{0}, wrong{0};
  for (const auto& [name, content] : c.files) {
    const std::string expected = "65 " + name;
    parallel_for(0, static_cast<std::int64_t>(content.size()), 64, [&](std::int64_t from, std::int64_t to) {
      for (std::int64_t size = from; size < to; ++size, ++tried)
        wrong += file_of(refusal(with(c, name, content.substr(0, size)))) != expected;
    });
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(tried, c.bytes());
}

/// Every `step`-th bit of every file is flipped by itself.
void check_flips(std::int64_t step) {
  const MemoryCase c = case_samples::minimal_case();
  EXPECT_EQ(refusal(c), "");
  std::atomic<std::size_t> tried{0}, wrong{0};
  for (const auto& [name, content] : c.files) {
    const std::string expected = "65 " + name;
    parallel_for(0, static_cast<std::int64_t>(content.size()) * 8 / step, 512, [&](std::int64_t from, std::int64_t to) {
      for (std::int64_t bit = from * step; bit < to * step; bit += step, ++tried) {
        std::string damaged = content;
        flip(damaged, static_cast<std::size_t>(bit));
        wrong += file_of(refusal(with(c, name, damaged))) != expected;
      }
    });
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GE(tried, 100000u / step);
  testing::Test::RecordProperty("flips", static_cast<int>(tried));
}

TEST(LoadCase, L1EveryNinthBitFlippedIsRefusedNamingTheFile) { check_flips(9); }
TEST(LongLoadCase, L1EverySingleBitFlipIsRefusedNamingTheFile) { check_flips(1); }

// What checksums do not catch: content that was hostile before it was hashed. It loads, or is refused with a file's
// name; it never crashes, and never asks for more memory than a small multiple of what there is to read.
TEST(LoadCase, L2ContentWithARightChecksumIsRefusedOrHarmless) {
  const MemoryCase good = case_samples::minimal_case();
  const std::uint64_t max_requested = 16 * good.bytes() + (1 << 20);
  std::mt19937_64 random(7);
  std::map<std::string, int> refused;
  int loaded = 0;
  std::uint64_t largest = 0;
  for (int i = 0; i < 6000; ++i) {
    MemoryCase c = good;
    auto& [name, content] = *std::next(c.files.begin(), static_cast<std::ptrdiff_t>(random() % c.files.size()));
    // Mostly in the headers, where the sizes are.
    const std::size_t span = random() % 4 == 0 ? content.size() : std::min<std::size_t>(content.size(), 1500);
    for (std::uint64_t n = 1 + random() % 3; n > 0; --n) flip(content, random() % (span * 8));
    if (random() % 8 == 0) content.resize(random() % content.size());
    if (name == "case.json") {
      const std::size_t tail = content.rfind(",\n \"checksum\"");
      if (tail == std::string::npos) continue;
      content.resize(tail);
      content += ",\n \"checksum\": \"" + sha256_of_bytes(content) + "\"\n}\n";
    } else {
      c.seal();
    }
    const std::uint64_t before = requested_bytes();
    const std::string said = refusal(c);
    largest = std::max(largest, requested_bytes() - before);
    if (said.empty()) {
      ++loaded;
    } else {
      EXPECT_EQ(said.substr(0, 2), "65") << said;
      ++refused[name];
      // A fault of case.json can show in a file that it names.
      if (name != "case.json") {
        // Where the two volumes no longer fit each other, either may be meant.
        const bool volume =
            name == good.manifest.haptic.file && file_of(said) == "65 " + good.manifest.haptic.hardness_file;
        EXPECT_TRUE(volume || file_of(said) == "65 " + name) << said << " of " << name;
      }
    }
  }
  EXPECT_LE(largest, max_requested);
  EXPECT_GT(loaded, 250);  // coordinates and colours that are a little different
  for (const auto& [name, content] : good.files) EXPECT_GT(refused[name], 250) << name;
}

// One part of a file replaced, the checksum right; sizes that NRRD and GLB hold in their headers.
TEST(LoadCase, L2HostileSizesAllocateNothing) {
  const MemoryCase good = case_samples::minimal_case();
  const auto names = [&](const char* part) {
    for (const auto& f : good.files)
      if (f.first.find(part) != std::string::npos) return f.first;
    return std::string();
  };
  const std::string volume = names("haptic-"), hardness = names("hardness-"), outer = names("outer-");
  const auto try_one = [&](const std::string& name, const std::string& from, const std::string& to) {
    MemoryCase c = good;
    if (name == "case.json") {
      c.edit_json(from, to);
    } else {
      std::string& content = c.files.at(name);
      const auto at = content.find(from);
      ASSERT_NE(at, std::string::npos) << name << " " << from;
      content.replace(at, from.size(), to);
      c.seal();
    }
    const std::uint64_t before = requested_bytes();
    const std::string said = refusal(c);
    EXPECT_EQ(file_of(said), "65 " + name) << to.substr(0, 80);
    EXPECT_LE(requested_bytes() - before, 16 * c.bytes() + (1 << 20)) << to.substr(0, 80);
  };
  for (const char* sizes : {"60000 60000 60000", "2147483647 2147483647 2147483647", "4294967296 10 10", "0 10 10",
                            "-10 10 10", "10 10 11", "10 10", "nan 10 10"})
    for (const std::string& file : {volume, hardness}) try_one(file, "10 10 10", sizes);
  for (const char* number : {"4294967295", "18446744073709551615", "99999999999999999999", "-1", "1e300"})
    for (const char* key : {"\"count\":", "\"byteLength\":", "\"bufferView\":"}) {
      const std::string content = good.files.at(outer);
      const auto at = content.find(key) + std::string(key).size();
      try_one(
          outer,
          content.substr(at - std::string(key).size(), content.find_first_of(",}", at) - at + std::string(key).size()),
          key + std::string(number));
    }
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"\"size\": [\n   10,\n   10,\n   10", "\"size\": [\n   65535,\n   65535,\n   65536"},
           {"\"size\": [\n   10,\n   10,\n   10", "\"size\": [\n   1e9,\n   10,\n   10"},
           {"\"samples\": 50000", "\"samples\": 99999999999999999999"},
           {"\"bytes\": ", "\"bytes\": 99999999"},
           {"\"bytes\": ", "\"bytes\": -"},
           {"\"landmarks\": [", "\"landmarks\": [" + std::string(50000, '[')},
           {"\"parameters\": {", "\"parameters\": {\"x\": [" + [] {
              std::string zeros;
              for (int i = 0; i < 300000; ++i) zeros += "0,";
              return zeros;
            }() + "0],"}})
    try_one("case.json", from, to);
}

TEST(LoadCase, L2ASizeThatOnlyTheManifestClaimsNamesTheFile) {
  // case.json says more than the file holds: whoever reads must not believe it.
  MemoryCase c = case_samples::minimal_case();
  const std::string name = c.manifest.files[0].name;
  c.edit_json("\"bytes\": " + std::to_string(c.manifest.files[0].bytes), "\"bytes\": 17179869184");
  const std::uint64_t before = requested_bytes();
  EXPECT_EQ(refusal(c), "65 " + name + ": size");
  ScratchFolder folder;
  c.write(folder.path());
  EXPECT_THROW(cases::load_case(folder.path()), Error);
  EXPECT_LE(requested_bytes() - before, 1u << 21);
}

TEST(LoadCase, L2FilesThatContradictCaseJsonAreRefused) {
  const MemoryCase good = case_samples::minimal_case();
  const std::string volume = good.manifest.haptic.file, hardness = good.manifest.haptic.hardness_file,
                    outer = good.manifest.anatomies[0].file, inner = good.manifest.anatomies[1].file;
  const auto refused = [&](const std::function<void(cases::CaseManifest&)>& change) {
    MemoryCase c = good;
    change(c.manifest);
    c.seal();
    return refusal(c);
  };
  using M = cases::CaseManifest;
  EXPECT_EQ(refused([](M& m) { m.anatomies[0].triangles += 1; }), "65 " + outer + ": triangles");
  EXPECT_EQ(refused([](M& m) { m.anatomies[1].points -= 1; }), "65 " + inner + ": points");
  EXPECT_EQ(refused([](M& m) { m.anatomies[0].volume_ml *= 1.01; }), "65 " + outer + ": volume_ml");
  EXPECT_EQ(refused([](M& m) { m.anatomies[0].area_cm2 *= 0.99; }), "65 " + outer + ": area_cm2");
  EXPECT_EQ(refused([](M& m) { m.center_mm.x += 1; }), "65 " + outer + ": center_mm");
  EXPECT_EQ(refused([](M& m) { std::swap(m.anatomies[0].file, m.anatomies[1].file); }), "65 " + inner + ": triangles");
  EXPECT_EQ(refused([](M& m) { m.haptic.size[2] = 9; }), "65 " + volume + ": size");
  EXPECT_EQ(refused([](M& m) { m.haptic.spacing_mm.y *= 1.001; }), "65 " + volume + ": spacing_mm");
  EXPECT_EQ(refused([](M& m) { m.haptic.encoding = "hu"; }), "65 " + volume + ": encoding");
  EXPECT_EQ(refused([](M& m) { m.haptic.shapes[1].number = 3; }), "65 " + volume + ": shapes.inner.number");
  EXPECT_EQ(refused([](M& m) { m.haptic.shapes[1].window_high -= 1; }), "65 " + volume + ": shapes.inner.window");
  EXPECT_EQ(refused([](M& m) { m.haptic.shapes.pop_back(); }), "65 " + volume + ": shapes");
  EXPECT_EQ(refused([](M& m) { std::swap(m.haptic.shapes[0].name, m.haptic.shapes[1].name); }),
            "65 " + volume + ": shapes.inner.name");
  EXPECT_EQ(refused([](M& m) { std::swap(m.haptic.file, m.haptic.hardness_file); }), "65 " + hardness + ": type");
}

TEST(LoadCase, L3ANewerMinorVersionLoadsWithoutWhatIsUnknown) {
  MemoryCase c = case_samples::minimal_case();
  c.manifest.version_minor = cases::case_version_minor + 6;
  const std::string dose = "dose-0123456789abcdef.bin";
  c.files[dose] = "what a later version needs";
  c.manifest.files.push_back({dose, "", 0});
  c.seal();
  c.edit_json(" \"landmarks\"", " \"dose\": {\"file\": \"" + dose + "\", \"unit\": [\"Gy\", {}]},\n \"landmarks\"");
  c.edit_json("\"cuttable\"", "\"conductivity_s_per_m\": {\"x\": 1},\n    \"cuttable\"");
  const cases::LoadedCase loaded = cases::load_case_through(c.reader());
  EXPECT_EQ(loaded.manifest.version_minor, cases::case_version_minor + 6);
  EXPECT_TRUE(loaded.has_haptic());
  EXPECT_EQ(loaded.surfaces.size(), 2u);
  // It is a file of the case all the same.
  c.files[dose][3] ^= 1;
  EXPECT_EQ(refusal(c), "65 " + dose + ": checksum");
}

TEST(LoadCase, L3AnotherMajorVersionIsRefusedWithBothVersions) {
  for (const int other : {-1, 1}) {
    MemoryCase c = case_samples::minimal_case();
    c.manifest.version_major = cases::case_version_major + other;
    c.manifest.version_minor = 4;
    c.seal();
    try {
      cases::load_case_through(c.reader());
      FAIL();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      EXPECT_EQ(e.file(), "case.json");
      EXPECT_EQ(std::string(e.what()),
                other < 0 ? "version 1.4, this program reads versions 2.*: make the case again with `trephine run`"
                          : "version 3.4, this program reads versions 2.*: take a newer Trephine, or make the case "
                            "again with this one");
    }
  }
}

TEST(LongLoadCase, L1FlipsOfAFullSizeCase) {
  const MemoryCase c = case_samples::full_size_case();
  EXPECT_EQ(refusal(c), "");
  std::mt19937_64 random(11);
  std::uint64_t all = 0;
  for (const auto& f : c.files) all += f.second.size();
  for (int i = 0; i < 100; ++i) {
    std::uint64_t at = random() % all;
    auto f = c.files.begin();
    for (; at >= f->second.size(); ++f) at -= f->second.size();
    std::string damaged = f->second;
    flip(damaged, at * 8 + random() % 8);
    EXPECT_EQ(file_of(refusal(with(c, f->first, damaged))), "65 " + f->first);
  }
}

TEST(LongLoadCase, AFullSizeCaseLoadsWithin600Milliseconds) {
  const MemoryCase c = case_samples::full_size_case();
  ScratchFolder folder;
  c.write(folder.path());
  double best = 1e300;
  std::size_t triangles = 0;
  for (int i = 0; i < 5; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    const cases::LoadedCase loaded = cases::load_case(folder.path());
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    triangles = 0;
    for (const surface::TriMesh& m : loaded.surfaces) triangles += m.triangles.size();
    EXPECT_EQ(loaded.haptic.voxels.count(), std::size_t{256} * 256 * 256);
  }
  EXPECT_GE(triangles, 210000u);
  EXPECT_LT(best, 0.6);
  std::cout << "loaded " << triangles << " triangles, 256^3 voxels in " << best << " s\n";
}

}  // namespace
}  // namespace trephine

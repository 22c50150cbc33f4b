// SPDX-License-Identifier: GPL-3.0-or-later
// A case's page, read back from its HTML.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <random>

#include "base/base64.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/write_file.h"
#include "case_samples.h"
#include "grid/nrrd.h"
#include "page/case_page.h"
#include "page/html.h"
#include "page/pack.h"
#include "page_reading.h"
#include "scratch_folder.h"
#include "voxel/decode.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;
using page_reading::Page;
using page_reading::read_page;

cases::LoadedCase loaded(const case_samples::MemoryCase& c) { return cases::load_case_through(c.reader()); }

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++n;
  return n;
}

// Every point of the case's surface, in the order in which its triangles first use it, with its number.
std::vector<std::uint32_t> by_first_use(const surface::TriMesh& mesh) {
  std::vector<std::uint32_t> order;
  std::vector<bool> seen(mesh.points_mm.size());
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t p : t)
      if (!seen[p]) {
        seen[p] = true;
        order.push_back(p);
      }
  return order;
}

TEST(Page, SurfacesAreThoseOfTheCase) {
  const cases::LoadedCase c = loaded(case_samples::make_case({{"outer", 90, 40}, {"inner", 40, 20}}, 24));
  page::PageNotes notes;
  for (std::size_t a = 0; a < 2; ++a)
    for (std::size_t i = 0; i < c.surfaces[a].points_mm.size(); ++i)
      notes.deviation_mm[c.manifest.anatomies[a].name].push_back(i % 7 == 3 ? std::numeric_limits<float>::quiet_NaN()
                                                                            : 0.3f * std::sin(float(i)));
  const Page page = read_page(page::make_case_page(c, notes));
  ASSERT_EQ(page.surfaces.size(), 2u);
  for (std::size_t a = 0; a < 2; ++a) {
    const surface::TriMesh& mine = c.surfaces[a];
    const auto& read = page.surfaces[a];
    const auto order = by_first_use(mine);
    ASSERT_EQ(read.mesh.points_mm.size(), order.size());
    ASSERT_EQ(read.mesh.triangles.size(), mine.triangles.size());
    for (std::size_t t = 0; t < mine.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) ASSERT_EQ(order[read.mesh.triangles[t][k]], mine.triangles[t][k]);
    const double level = page.data["anatomies"][a]["deviation_scale_mm"].get<double>() / 127;
    for (std::size_t p = 0; p < order.size(); ++p) {
      ASSERT_LT(norm(read.mesh.points_mm[p] - mine.world_mm(order[p])), 0.005);
      const float d = notes.deviation_mm.at(read.name)[order[p]];
      ASSERT_EQ(read.known[p], !std::isnan(d));
      if (!std::isnan(d)) {
        ASSERT_NEAR(read.deviation_mm[p], d, level);
      }
    }
  }
}

TEST(Page, SaysWhatTheCaseSays) {
  const cases::LoadedCase c = loaded(case_samples::minimal_case());
  page::PageNotes notes;
  notes.warnings = {{"import: a warning, word for word", "look"}};
  notes.trade.rule = "seconds 10";
  notes.trade.chosen = "a";
  notes.trade.points = {{"a", 3, 0.2, 1000, ""}, {"b", 30, 0.1, 5000, "too thin"}};
  const auto data = read_page(page::make_case_page(c, notes)).data;
  EXPECT_EQ(data["case"], "sample");
  EXPECT_EQ(data["anatomies"][1]["deviation_mm"]["p99"], 0.1);
  EXPECT_EQ(data["landmarks"][0]["position_mm"], (std::vector<double>{1, -110, 300}));
  EXPECT_EQ(data["targets"][0]["anatomy"], "inner");
  EXPECT_EQ(data["burr_holes"][0]["figures"]["bone_thickness_mm"], 6.5);
  EXPECT_EQ(data["warnings"], (std::vector<std::string>{"import: a warning, word for word"}));
  EXPECT_EQ(data["trade"]["points"][1]["refused"], "too thin");
  EXPECT_EQ(data["provenance"]["parameters"]["outer.decimate.max_deviation_mm"], 0.2);
  EXPECT_EQ(data["felt"]["shapes"][0]["name"], "outer");
  EXPECT_FALSE(data.contains("ct")) << "the case holds no CT";
}

TEST(Page, HoldsHowMuchOfEachVoxelItsShapesFill) {
  const cases::LoadedCase c = loaded(case_samples::make_case({{"outer", 40, 7}, {"inner", 20, 4}}, 12));
  const page::PackedShapes packed = page::pack_shapes(c.haptic);
  const grid::Lattice& l = packed.numbers.lattice;
  ASSERT_EQ(l.size, c.haptic.voxels.size);
  const voxel::HapticDecoder decoder(c.haptic);
  int parted = 0;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        for (int number = 1; number <= 2; ++number) {
          const std::size_t at = l.index(i, j, k);
          const int share = static_cast<unsigned char>(packed.shares[at]);
          const double occupancy = packed.numbers.bytes[at] == number        ? share / 255.0
                                   : packed.shares[l.count() + at] == number ? 1 - share / 255.0
                                                                             : 0;
          ASSERT_NEAR(occupancy, decoder.occupancy(number, i, j, k), 17.0 / 255);
          parted += occupancy > 0 && occupancy < 1;
        }
  EXPECT_GT(parted, 100);
}

TEST(Page, SeesHuAsTheSceneSays) {
  case_samples::MemoryCase made = case_samples::minimal_case();
  cases::LoadedCase c = loaded(made);
  c.haptic.encoding = voxel::HapticEncoding::hu;
  c.manifest.haptic.shapes[0].window_low = 227;
  c.manifest.haptic.shapes[0].window_high = 3000;
  voxel::TransferFunction ramp;
  ramp.points = {{100, 0, {1, 0, 0}}, {200, 0.5, {0, 1, 0}}};
  c.manifest.haptic.shapes[1].transfer = ramp;
  const auto felt = read_page(page::make_case_page(c, {})).data["felt"];
  EXPECT_FALSE(felt.contains("shares"));
  EXPECT_EQ(felt["shapes"][0]["transfer"][0][0], 226);
  EXPECT_EQ(felt["shapes"][1]["transfer"].dump(), "[[100.0,0.0,1.0,0.0,0.0],[200.0,0.5,0.0,1.0,0.0]]");
}

TEST(Page, IsTheSameWhateverTheThreads) {
  const auto c = case_samples::make_case({{"outer", 90, 30}, {"inner", 40, 20}}, 40);
  set_thread_count(1);
  const std::string one = page::make_case_page(loaded(c), {});
  set_thread_count(4);
  EXPECT_EQ(page::make_case_page(loaded(c), {}), one);
  set_thread_count(0);
}

TEST(Page, HostileTextsStayText) {
  const cases::LoadedCase c = loaded(case_samples::minimal_case());
  const std::string plain = page::make_case_page(c, {});
  page::PageNotes hostile;
  hostile.warnings = {
      {"</script><script>alert(1)</script><!-- @SCRIPT@ @BLOCKS@ <img src=http://x/ onerror=alert(1)>", "look"}};
  const std::string page = page::make_case_page(c, hostile);
  EXPECT_EQ(count_of(page, "<script"), count_of(plain, "<script"));
  EXPECT_EQ(count_of(page, "</script"), count_of(plain, "</script"));
  EXPECT_EQ(count_of(page, "<!--"), 0u);
  EXPECT_EQ(count_of(page, "<img"), 0u);
  EXPECT_EQ(read_page(page).data["warnings"][0], hostile.warnings[0].text);
  hostile.warnings[0].text = "a\u202egpj.exe";  // reads as "aexe.jpg"
  EXPECT_EQ(read_page(page::make_case_page(c, hostile)).data["warnings"][0], "a?gpj.exe");
}

TEST(Page, TemplateIsFilledOnce) {
  EXPECT_EQ(page::html_page("a@b @STYLE@ @DATA@ @lower@ @", "s", "", "\"@SCRIPT@<\"", {}),
            "a@b s \"@SCRIPT@\\u003c\" @lower@ @");
  EXPECT_THROW(page::html_page("@OTHER@", "", "", "", {}), Error);
  EXPECT_THROW(page::html_page("@SCRIPT@", "", "'</ScRipt>'", "", {}), Error);
  EXPECT_EQ(base64("abcd"), "YWJjZA==");
}

// A shape that is displayed from the haptic volume has a surface of its own in the page, and nothing is said twice.
TEST(Page, FeltShapeIsContoured) {
  const auto c = case_samples::make_case({{"outer", 90, 10}, {"inner", 40, 10}}, 60);
  const voxel::HapticVolume haptic = loaded(c).haptic;
  const surface::TriMesh whole = page::felt_surface_for_page(haptic, 2),
                         coarse = page::felt_surface_for_page(haptic, 2, 2000);
  EXPECT_NEAR(surface::volume_mm3(whole) / surface::volume_mm3(case_samples::ball(40, 60)), 1, 0.02);
  EXPECT_NEAR(surface::volume_mm3(coarse) / surface::volume_mm3(whole), 1, 0.05);
  EXPECT_NEAR(double(coarse.triangles.size()), 2000, 600);
  EXPECT_TRUE(page::felt_surface_for_page(haptic, 9).triangles.empty()) << "no such shape";
}

TEST(Page, CtIsCompanded) {
  grid::Lattice lattice;
  lattice.size = {300, 4, 3};
  lattice.spacing_mm = {0.5, 2, 3};
  lattice.origin_mm = {10, 20, 30};
  lattice.direction.column[0] = {-1, 0, 0};  // towards the right: the page runs towards the left
  grid::Grid<std::int16_t> grid(lattice);
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 300; ++i) grid.at(i, j, k) = std::int16_t(i - 150 + 10 * j);
  const page::PackedVolume packed = page::pack_ct(grid);
  EXPECT_EQ(packed.lattice.size, (std::array<int, 3>{256, 4, 3}));
  EXPECT_TRUE(packed.lattice.direction == Mat3());
  EXPECT_NEAR(packed.lattice.origin_mm.x, 10 - 299 * 0.5, 0.5);
  for (int i = 1; i < 255; ++i) {
    const Vec3 at = packed.lattice.to_world_mm({double(i), 2, 1});
    const double hu = (10 - at.x) / 0.5 - 150 + 20;
    const int level = static_cast<unsigned char>(packed.bytes[packed.lattice.index(i, 2, 1)]);
    if (std::abs(hu) < 158) {
      ASSERT_NEAR((level - 24) * 2 - 160, hu, 1.6) << i;
    }
  }
}

// A volume that lies oblique: what it measures is found where it lies.
TEST(Page, ObliqueCtIsResampled) {
  grid::Lattice lattice;
  lattice.size = {40, 50, 60};
  lattice.spacing_mm = {1.1, 1, 0.9};
  lattice.origin_mm = {-30, 12, 5};
  const double c = std::cos(0.3), s = std::sin(0.3);
  lattice.direction.column = {Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, 1}};
  grid::Grid<std::int16_t> grid(lattice);
  const auto truth = [](Vec3 p) { return 1.5 * p.x - 0.7 * p.y + 0.4 * p.z; };
  for (int k = 0; k < 60; ++k)
    for (int j = 0; j < 50; ++j)
      for (int i = 0; i < 40; ++i)
        grid.at(i, j, k) = std::int16_t(std::lround(truth(lattice.to_world_mm({double(i), double(j), double(k)}))));
  const page::PackedVolume packed = page::pack_ct(grid);
  int inside = 0;
  for (int k = 0; k < packed.lattice.size[2]; k += 3)
    for (int j = 0; j < packed.lattice.size[1]; j += 3)
      for (int i = 0; i < packed.lattice.size[0]; i += 3) {
        const Vec3 at = packed.lattice.to_world_mm({double(i), double(j), double(k)}), index = lattice.to_index(at);
        const int level = static_cast<unsigned char>(packed.bytes[packed.lattice.index(i, j, k)]);
        bool in = true, out = false;
        for (int a = 0; a < 3; ++a) {
          in &= index[a] > 0.01 && index[a] < lattice.size[a] - 1.01;
          out |= index[a] < -0.01 || index[a] > lattice.size[a] - 0.99;
        }
        if (out) {
          ASSERT_EQ(level, 0);
        }
        if (in && std::abs(truth(at)) < 158) {
          ASSERT_NEAR((level - 24) * 2 - 160, truth(at), 1.51);  // half a level, and half an HU of the volume
        }
        inside += in;
      }
  EXPECT_GT(inside, 1000);
}

// A page that would be too large shows slices on larger voxels, and what it shows is still the CT.
TEST(Page, SlicesAreCoarserWhereThePageWouldBeTooLarge) {
  auto c = case_samples::minimal_case();
  grid::Lattice lattice;
  lattice.size = {200, 200, 120};
  lattice.spacing_mm = {1, 1, 1.5};
  grid::Grid<std::int16_t> grid(lattice);
  std::mt19937 random(5);
  for (int k = 0; k < 120; ++k)
    for (int j = 0; j < 200; ++j)
      for (int i = 0; i < 200; ++i) grid.at(i, j, k) = std::int16_t((i < 100 ? -60 : 60) + int(random() % 41) - 20);
  const std::string bytes = grid::encode_nrrd(grid::HuVolume(grid), {}, grid::NrrdEncoding::gzip);
  c.manifest.files.push_back(cases::describe_case_file("ct", ".nrrd", bytes));
  c.manifest.ct = {c.manifest.files.back().name, grid.size, grid.spacing_mm};
  c.files[c.manifest.ct.file] = bytes;
  c.seal();
  const cases::LoadedCase whole = cases::load_case_through(c.reader(), cases::LoadParts{true});
  const Page fine = read_page(page::make_case_page(whole, {}, page::PageParams{100}));
  EXPECT_EQ(fine.lattice("ct").size, lattice.size);
  ASSERT_GT(fine.html.size(), 2.2e6);
  const Page small = read_page(page::make_case_page(whole, {}, page::PageParams{2}));
  EXPECT_LE(small.html.size(), 2e6);
  EXPECT_GT(small.html.size(), 1.4e6) << "no coarser than it must be";
  const auto ct = small.ct();
  EXPECT_LT(ct.size[0], 200);
  EXPECT_EQ(small.data["ct"]["of_spacing_mm"], nlohmann::json::array({1.0, 1.0, 1.5}));
  for (const double x : {40.0, 150.0}) {
    const Vec3 at = ct.to_index({x, 90, 80});
    double mean = 0;
    for (int j = -8; j <= 8; ++j) mean += ct.at(int(at.x), int(at.y) + j, int(at.z)) / 17.0;
    EXPECT_NEAR(mean, x < 100 ? -60 : 60, 12);
  }
}

std::vector<std::int16_t> gradient(const grid::Lattice& lattice) {
  std::vector<std::int16_t> out(lattice.count());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = std::int16_t(i % 2000);
  return out;
}

// The case's CT is in the page, and only loaded where it is asked for.
TEST(Page, ShowsTheCaseOwnCt) {
  auto c = case_samples::minimal_case();
  grid::Lattice lattice;
  lattice.size = {7, 6, 5};
  lattice.spacing_mm = {2, 3, 4};
  grid::Grid<std::int16_t> grid(lattice);
  grid.voxels = gradient(lattice);
  const std::string bytes = grid::encode_nrrd(grid::HuVolume(grid), {}, grid::NrrdEncoding::gzip);
  c.manifest.files.push_back(cases::describe_case_file("ct", ".nrrd", bytes));
  c.manifest.ct = {c.manifest.files.back().name, grid.size, grid.spacing_mm};
  c.files[c.manifest.ct.file] = bytes;
  c.seal();
  EXPECT_FALSE(loaded(c).has_ct()) << "not asked for";
  const cases::LoadedCase whole = cases::load_case_through(c.reader(), cases::LoadParts{true});
  EXPECT_TRUE(whole.ct == grid);
  const Page page = read_page(page::make_case_page(whole, {}));
  EXPECT_EQ(page.data["ct"]["from"], "ct");
  const auto shown = page.ct();
  for (std::size_t i = 0; i < grid.voxels.size(); ++i)
    ASSERT_NEAR(shown.voxels[i], grid.voxels[i], i < 160 ? 1 : 21) << i;

  c.manifest.ct.size[0] = 8;
  c.seal();
  EXPECT_THROW(cases::load_case_through(c.reader(), cases::LoadParts{true}), Error) << "the file contradicts case.json";
  c.manifest.ct.size[0] = 7;
  c.seal();
  c.files[c.manifest.ct.file].back() ^= 1;
  EXPECT_THROW(loaded(c), Error) << "also where it is only hashed";
}

TEST(Page, NotesAreReadBack) {
  const ScratchFolder scratch;
  const fs::path& folder = scratch.path();
  const auto c = case_samples::minimal_case();
  c.write(folder);
  page::PageNotes notes;
  notes.warnings = {{"one", "note"}};
  notes.trade = {{{"a", 3, 0.2, 1000, ""}}, "a", "rule", "why"};
  notes.deviation_mm["outer"].assign(c.manifest.anatomies[0].points, 0.25f);
  const fs::path report = folder / "report",
                 values = report / page::deviation_file_name(c.manifest, c.manifest.anatomies[0]);
  fs::create_directories(report);
  write_file(report / page::page_notes_file, page::page_notes_json(notes));
  write_file(values, page::encode_deviation(notes.deviation_mm["outer"]));
  EXPECT_EQ(page::make_case_page(folder), page::make_case_page(loaded(c), notes))
      << "`page` makes the page that `run` made";

  std::string damaged = page::encode_deviation(notes.deviation_mm["outer"]);
  damaged.back() ^= 1;
  write_file(values, damaged);
  try {
    page::make_case_page(folder);
    ADD_FAILURE() << "damaged deviations were taken";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
    EXPECT_EQ(e.file(), values.string());
  }
  fs::remove(values);
  write_file(report / page::page_notes_file, "{\"warnings\": 1}");
  EXPECT_THROW(page::make_case_page(folder), Error);
}

}  // namespace
}  // namespace trephine

// SPDX-License-Identifier: GPL-3.0-or-later
// The library's parts without a build: its configuration, what makes a case stale, memory pools, signatures, the sheet.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"
#include "grid/nrrd.h"
#include "library/build.h"
#include "library/catalogue.h"
#include "library/library_config.h"
#include "library/ninja.h"
#include "library/plan.h"
#include "library/series_state.h"
#include "library/settings.h"
#include "library/sheet.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;
const fs::path source = TREPHINE_SOURCE_DIR;

class Library : public testing::Test {
 protected:
  Library() { scratch_.write("trephine.root", ""); }
  library::LibraryConfig read(const std::string& text, const library::LibraryOverrides& overrides = {}) {
    return library::read_library_config(scratch_.write("l.yaml", "trephine: 1\n" + text), overrides);
  }
  std::string fault(const std::string& text) {
    try {
      read(text);
    } catch (const ErrorList& e) {
      std::string all;
      for (const Error& one : e.all()) all += one.line("t") + "\n";
      return all;
    }
    return "";
  }
  ScratchFolder scratch_;
};

TEST_F(Library, CasesOfSeveralConfigurations) {
  const library::LibraryConfig c = read(
      "configs: {drilled: a.yaml, voxels: b.yaml}\nset: {x.y.z: 1}\n"
      "cases:\n  - {case: one, series: s, set: {x.y.z: 2, p.q.r: [1, 2.5]}}\n  - {case: two, series: t, config: "
      "own.yaml}\n"
      "phantoms: {shared: {level: clinical}, list: [{name: ph, seed: 5, variant: small}]}\n",
      {{"x.y.z=3"}, {"columns_count=100"}, {}});
  ASSERT_EQ(c.cases.size(), 5u);
  EXPECT_EQ(c.cases[0].token, "one-drilled");
  EXPECT_EQ(c.cases[1].token, "one-voxels");
  EXPECT_EQ(c.cases[2].token, "two");
  EXPECT_EQ(c.cases[2].config.filename(), "own.yaml");
  EXPECT_EQ(c.cases[4].token, "ph-voxels");
  EXPECT_EQ(c.cases[4].phantom, 0);
  EXPECT_EQ(c.cases[0].set, (std::vector<std::string>{"x.y.z=1", "x.y.z=2", "p.q.r=[1, 2.5]", "x.y.z=3"}));
  ASSERT_EQ(c.phantoms.size(), 1u);
  EXPECT_EQ(c.phantoms[0].params.head.seed, 5);
  EXPECT_EQ(c.phantoms[0].params.head.variant, phantom::Variant::small);
  EXPECT_EQ(c.phantoms[0].params.head.level, phantom::Level::clinical);
  EXPECT_EQ(c.phantoms[0].params.scan.columns_count, 100);
}

TEST_F(Library, SharedValuesOfPhantomsHoldWhereverTheyStand) {
  const library::LibraryConfig c = read(
      "config: a.yaml\nphantoms: {list: [{name: one}, {name: two, columns_count: 64}], shared: {columns_count: 128}}\n",
      {});
  ASSERT_EQ(c.phantoms.size(), 2u);
  EXPECT_EQ(c.phantoms[0].params.scan.columns_count, 128);
  EXPECT_EQ(c.phantoms[1].params.scan.columns_count, 64);
}

TEST_F(Library, FoundSeriesHaveNoTokenYet) {
  for (const char* name : {"s/b", "s/a", "s/.hidden"}) fs::create_directories(scratch_.path() / name);
  scratch_.write("s/z.zip", "x");
  scratch_.write("s/notes.txt", "x");
  const library::LibraryConfig c = read("config: a.yaml\nseries: [s/*]\n");
  ASSERT_EQ(c.cases.size(), 3u);
  EXPECT_EQ(c.cases[0].series.filename(), "a");
  EXPECT_EQ(c.cases[2].series.filename(), "z.zip");
  for (const library::LibraryCase& one : c.cases) EXPECT_TRUE(one.token.empty());
  EXPECT_EQ(c.cases[1].origin, "series[0] folder 2");
}

TEST_F(Library, AllFaultsAtOnceWithTheirPlace) {
  const std::string all = fault(
      "config: a.yaml\nconfigs: {b: b.yaml}\ncases:\n  - {case: UPPER, series: ../../etc}\n  - {series: s}\nsereis: "
      "[]\n");
  EXPECT_NE(all.find("l.yaml:3:10: configs: stands beside config"), std::string::npos) << all;
  EXPECT_NE(all.find("l.yaml:5:12: cases[0].case: 'UPPER'"), std::string::npos) << all;
  EXPECT_NE(all.find("cases[0].series: ../../etc, leads out of the root"), std::string::npos) << all;
  EXPECT_NE(all.find("cases[1].case: is missing"), std::string::npos) << all;
  EXPECT_NE(all.find("sereis: "), std::string::npos) << all;
  EXPECT_NE(fault("cases: [{case: a, series: s}]\n").find("has no configuration"), std::string::npos);
  EXPECT_NE(fault("config: 010\ncases: [{case: a, series: s}, {case: a, series: s}]\n").find("is there already"),
            std::string::npos);
  EXPECT_NE(fault("config: a\nphantoms: {list: [{name: a, noise_hu: .nan}]}\n").find("noise_hu"), std::string::npos);
}

TEST_F(Library, SampleLibraryIsWhatTheDissertationHad) {
  const library::LibraryConfig c = library::read_library_config(source / "configs/library.yaml");
  EXPECT_EQ(c.phantoms.size(), 15u);
  EXPECT_EQ(c.cases.size(), 30u);
  std::map<phantom::Variant, int> variants;
  for (const library::LibraryPhantom& p : c.phantoms) ++variants[p.params.head.variant];
  EXPECT_EQ(variants.size(), 4u);
  for (const library::LibraryCase& one : c.cases)
    EXPECT_NO_THROW(library::read_case_settings(one, {}, true, "p 1")) << one.token;
}

// A path that no configuration has is found when the case's configuration is read; it is named where the library has
// it.
TEST_F(Library, AFaultOfASettingHasItsPlace) {
  fs::copy(source / "pipelines/ventriculostomy.yaml", scratch_.path() / "p.yaml");
  scratch_.write("s.yaml", "trephine: 1\nanatomies: {skull: {max_triangles: 5000}}\n");
  scratch_.write("c.yaml", "trephine: 1\npipeline: p.yaml\nscene: s.yaml\n");
  const auto said = [&](const library::LibraryOverrides& overrides) {
    const library::LibraryConfig c = read(
        "config: c.yaml\nset: {skull.smoth.iterations_count: 3}\ncases:\n  - {case: a, series: s, set: "
        "{skull.segment.lower_hu: much}}\n",
        overrides);
    try {
      library::read_case_settings(c.cases.at(0), {}, true, "p 1");
    } catch (const ErrorList& e) {
      std::string all;
      for (const Error& one : e.all()) all += one.line("t") + "\n";
      return all;
    }
    return std::string();
  };
  const std::string all = said({});
  EXPECT_NE(all.find("l.yaml:3:7: skull.smoth.iterations_count: no such parameter, did you mean"), std::string::npos)
      << all;
  EXPECT_NE(all.find("l.yaml:5:32: skull.segment.lower_hu: "), std::string::npos) << all;
  const std::string replaced = said({{"skull.segment.lower_hu=more"}, {}, {}});
  EXPECT_NE(replaced.find("--set skull.segment.lower_hu: "), std::string::npos) << replaced;
}

// So is a configuration that is not there, with the one beside it that may be meant.
TEST_F(Library, AConfigurationThatIsNotThereHasItsPlace) {
  scratch_.write("ct_head.yaml", "");
  const library::LibraryConfig c =
      read("config: ct_haed.yaml\ncases:\n  - {case: a, series: s}\n  - {case: b, config: c.yaml, series: s}\n");
  const auto said = [&](std::size_t i) -> std::string {
    try {
      library::read_case_settings(c.cases.at(i), {}, true, "p 1");
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::no_input);
      return e.line("t");
    }
    return "read";
  };
  EXPECT_NE(said(0).find("l.yaml:2:9: config: "), std::string::npos) << said(0);
  EXPECT_NE(said(0).find("ct_haed.yaml, not found, did you mean ct_head.yaml?"), std::string::npos) << said(0);
  EXPECT_NE(said(1).find("l.yaml:5:23: config: "), std::string::npos) << said(1);
  EXPECT_NE(c.cases.at(1).series_at.find("l.yaml:5:39"), std::string::npos) << c.cases.at(1).series_at;
}

TEST_F(Library, SettingsChangeWithWhatCountsOnly) {
  fs::copy(source / "pipelines/ventriculostomy.yaml", scratch_.path() / "p.yaml");
  const auto scene = [&](const std::string& text) { scratch_.write("s.yaml", "trephine: 1\n" + text); };
  scene("anatomies: {skull: {max_triangles: 5000}}\n");
  scratch_.write("c.yaml", "trephine: 1\npipeline: p.yaml\nscene: s.yaml\n");
  library::LibraryCase one;
  one.config = scratch_.path() / "c.yaml";
  const auto settings = [&] { return library::read_case_settings(one, {}, true, "p 1"); };
  const library::CaseSettings first = settings();
  EXPECT_EQ(first.values.at("scene.anatomies.skull.max_triangles"), "5000");
  EXPECT_EQ(first.values.at("program"), "p 1");
  EXPECT_TRUE(first.values.count("skull.decimate.max_deviation_mm"));
  EXPECT_FALSE(first.values.count("brain.decimate.max_deviation_mm")) << "the scene does not show it";
  EXPECT_EQ(library::parse_settings_json(library::settings_json(first)), first.values);

  scene("# a comment\nanatomies:\n  skull:\n    max_triangles: 5000\n");
  EXPECT_EQ(settings().sha256, first.sha256);
  one.set = {"brain.decimate.max_deviation_mm=0.7"};
  EXPECT_EQ(settings().sha256, first.sha256) << "of an anatomy that the scene does not show";
  one.set = {"skull.decimate.max_deviation_mm=0.4"};
  const auto lines = library::explain_difference(first.values, settings().values);
  ASSERT_EQ(lines.size(), 1u) << lines[0];
  EXPECT_EQ(lines[0].rfind("skull.decimate.max_deviation_mm: 0.4, was ", 0), 0u) << lines[0];
  one.set.clear();
  scene("anatomies: {skull: {max_triangles: 5000}}\nface: {policy: keep, reason: synthetic}\n");
  EXPECT_NE(settings().sha256, first.sha256);
  EXPECT_NE(library::read_case_settings(one, {}, true, "p 2").sha256, settings().sha256);
  EXPECT_NE(library::read_case_settings(one, {}, false, "p 1").sha256, settings().sha256);
}

// A further scan's content is remembered as the first one's is: where the memory says another content, a plan that
// reads nothing takes that one.
TEST_F(Library, APlanReadsNoFurtherScanAgain) {
  grid::Grid<std::int16_t> voxels;
  voxels.size = {8, 8, 8};
  voxels.voxels.assign(512, 40);
  for (const char* name : {"ct.nrrd", "mr.nrrd"}) {
    grid::write_nrrd(scratch_.path() / name, grid::HuVolume(voxels));
    voxels.voxels[100] = 50;
  }
  scratch_.write("p.yaml",
                 "trephine: 1\nanatomies: {bone: {shows_face: false, stages: [segment: {scan: mr}, contour, decimate, "
                 "normals]}}\n");
  scratch_.write("s.yaml", "trephine: 1\nanatomies: {bone: {}}\n");
  scratch_.write("c.yaml",
                 "trephine: 1\npipeline: p.yaml\nscene: s.yaml\nscans: {mr: {modality: mr, series: mr.nrrd}}\n");
  const library::LibraryConfig config = read("config: c.yaml\ncases: [{case: one, series: ct.nrrd}]\n");
  const library::LibraryState state(scratch_.path() / "out");
  state.make_folders();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // files that changed just now are not trusted
  const auto plan = [&](bool rehash) {
    library::PlanOptions options;
    options.rehash = rehash;
    const library::LibraryPlan p = library::make_plan(config, state, options, {});
    EXPECT_FALSE(p.cases.at(0).fault);
    return p.cases.at(0).inputs.settings_sha256;
  };
  const std::string first = plan(false);
  const std::vector<char> bytes = read_file(state.series_file(), 1 << 20);
  auto memory = nlohmann::json::parse(bytes.begin(), bytes.end());
  ASSERT_EQ(memory.at("series").size(), 2u);
  const std::string content = dicom::hash_of_series_input(scratch_.path() / "mr.nrrd", {});
  for (auto& entry : memory.at("series"))
    if (entry.at(0) == content) entry.at(0) = sha256_of_bytes("another content");
  memory["checksum"] = sha256_of_bytes(memory.at("series").dump());
  write_file(state.series_file(), memory.dump());
  EXPECT_NE(plan(false), first);
  EXPECT_EQ(plan(true), first);
}

TEST(LibraryPlan, TellsWhatAPersonDidInWords) {
  const std::map<std::string, std::string> before = {{"skull.correct.file", "sha256 1"},
                                                     {"given_landmarks.landmarks.inion.confidence", "1"}},
                                           now = {{"skull.correct.file", "sha256 2"},
                                                  {"given_landmarks.landmarks.vertex.confidence", "1"},
                                                  {"given_landmarks.landmarks.vertex.position_mm", "[0, 0, 9]"},
                                                  {"landmarks.vertex", "0, 0, 9, given 1"},
                                                  {"skull.segment.lower_hu", "300"}};
  EXPECT_EQ(library::explain_difference(before, now),
            (std::vector<std::string>{"landmark vertex changed", "skull: its correction by hand changed",
                                      "skull.segment.lower_hu: 300, is new", "landmark inion changed"}));
}

TEST(LibraryPools, NoChoiceOfJobsExceedsTheBudget) {
  const std::vector<std::vector<double>> loads = {
      {300, 300, 300, 300}, {1200, 1200, 300, 300, 300}, {5000, 1200, 600, 300, 100, 100}, {9000, 100}, {100}};
  for (const auto& load : loads)
    for (const double budget : {500.0, 2000.0, 4000.0, 16000.0})
      for (const int jobs : {1, 2, 4, 16}) {
        const library::MemoryPools p = library::make_pools(load, budget, jobs);
        // The heaviest jobs that may run together.
        std::vector<double> heavy = load;
        std::sort(heavy.rbegin(), heavy.rend());
        std::vector<int> left = p.places;
        double sum = 0;
        int running = 0;
        for (const double mb : heavy)
          if (running < p.jobs && left[p.class_of(mb)] > 0) {
            --left[p.class_of(mb)];
            sum += mb;
            ++running;
          }
        EXPECT_TRUE(sum <= budget || running == 1) << sum << " of " << budget << " with " << jobs;
        EXPECT_GE(running, 1);
        if (budget >= 16000 && jobs <= static_cast<int>(load.size())) {
          EXPECT_EQ(running, jobs) << "places are wasted";
        }
      }
}

TEST(LibraryPools, NinjaFileIsQuoted) {
  library::NinjaJob job;
  job.job.name = "case.a";
  job.after = {"phantom.b"};
  const std::string text = library::ninja_file({job}, library::make_pools({100}, 1000, 2), "/a b/it's $x");
  EXPECT_NE(text.find("command = exec '/a b/it'\\''s $$x' library job $out"), std::string::npos) << text;
  EXPECT_NE(text.find("build case.a: job || phantom.b\n  pool = memory0"), std::string::npos) << text;
}

TEST(LibrarySignature, ChangesWithContentNotWithNames) {
  ScratchFolder scratch;
  scratch.write("s/a", "1");
  scratch.write("s/below/b", "2");
  const std::string first = library::sign_files(scratch.path() / "s").sha256;
  EXPECT_EQ(first, library::sign_files(scratch.path() / "s").sha256);
  std::ofstream(scratch.path() / "s/below/b", std::ios::app) << "3";
  const std::string second = library::sign_files(scratch.path() / "s").sha256;
  EXPECT_NE(first, second);
  fs::rename(scratch.path() / "s", scratch.path() / "t");
  EXPECT_EQ(second, library::sign_files(scratch.path() / "t").sha256) << "the folder's name goes into it";
  fs::remove(scratch.path() / "t/a");
  EXPECT_NE(second, library::sign_files(scratch.path() / "t").sha256);
  EXPECT_EQ(library::sign_files(scratch.path() / "nowhere").sha256, "");
}

TEST(LibrarySheet, EscapesAndShowsWhatThereIs) {
  ScratchFolder scratch;
  library::CaseRow good, bad;
  good.token = "a";
  good.patient_class = "small";
  good.manifest.anatomies.push_back({});
  good.manifest.anatomies[0].name = "skull";
  good.manifest.anatomies[0].triangles = 12345;
  good.warnings = {"<script>alert(1)</script>"};
  bad.token = "b";
  bad.fault = "was never built";
  scratch.write("a/report/view.html", "page");
  scratch.write("a/report/cut.png", "picture");
  const auto row = [&](std::size_t i) { return i == 1 ? bad : good; };
  const auto [png, page] = library::sheet_of(scratch.path(), 2, row);
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  EXPECT_NE(page.find("\\u003cscript>alert(1)\\u003c/script>"), std::string::npos);
  EXPECT_NE(page.find("12345"), std::string::npos);
  good.severities = {"wrong"};
  EXPECT_NE(library::sheet_of(scratch.path(), 2, row).html.find("\"severities\":[\"wrong\"]"), std::string::npos);
  EXPECT_NE(library::case_text(good).find("  wrong: <script>"), std::string::npos) << library::case_text(good);
  EXPECT_NE(page.find("\"pictures\":[\"report/cut.png\"],\"page\":true"), std::string::npos);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  EXPECT_NE(page.find("was never built"), std::string::npos);
  EXPECT_GT(picture::decode_png(png).width, 400);
  const picture::Image many = picture::decode_png(library::sheet_of(scratch.path(), 1000, row).png);
  EXPECT_LT(double(many.width) * many.height, 6e7);
  EXPECT_GT(picture::decode_png(library::sheet_of(scratch.path(), 0, row).png).width, 0);
}

}  // namespace
}  // namespace trephine

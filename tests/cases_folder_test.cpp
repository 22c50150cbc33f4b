// SPDX-License-Identifier: GPL-3.0-or-later
// A case on disk: published, read, damaged, published again.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "base/error.h"
#include "base/write_file.h"
#include "cases/case.h"
#include "cases/glb.h"
#include "cases_manifest.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;
using cases_test::sample_manifest;

surface::TriMesh tetrahedron() {
  surface::TriMesh m;
  m.origin_mm = {10, 20, 30};
  m.points_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  m.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return m;
}

std::string slurp(const fs::path& f) {
  const auto b = read_file(f);
  return std::string(b.begin(), b.end());
}

void put(const fs::path& f, const std::string& bytes) { std::ofstream(f, std::ios::binary) << bytes; }

class CaseTest : public testing::Test {
 protected:
  // A published case of one surface; returns what was written.
  cases::CaseManifest publish() const {
    cases::CaseManifest m = sample_manifest();
    cases::GlbParams p;
    p.name = "skull";
    p.center_mm = m.center_mm;
    m.files = {cases::write_case_file(folder_, "meshes/skull", ".glb", cases::make_glb(tetrahedron(), p))};
    m.anatomies[0].file = m.files[0].name;
    cases::publish_case(folder_, m);
    return m;
  }
  // "" where the case reads, else code and file.
  std::string refusal() const {
    try {
      cases::read_case(folder_);
    } catch (const Error& e) {
      return std::to_string(int(e.code())) + " " + fs::path(e.file()).lexically_relative(folder_).string();
    }
    return "";
  }
  ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
};

TEST_F(CaseTest, PublishedAndRead) {
  const cases::CaseManifest m = publish();
  const cases::CaseManifest back = cases::read_case(folder_);
  EXPECT_EQ(cases::to_json(back), cases::to_json(m));
  ASSERT_EQ(back.files.size(), 1u);
  EXPECT_EQ(back.files[0].name, "meshes/skull-" + back.files[0].sha256.substr(0, 16) + ".glb");
  const cases::GlbMesh mesh = cases::read_glb(cases::read_case_file(folder_, back.files[0]));
  EXPECT_EQ(mesh.mesh.triangles, tetrahedron().triangles);
  // Published again: the same bytes.
  const std::string before = slurp(folder_ / "case.json");
  publish();
  EXPECT_EQ(slurp(folder_ / "case.json"), before);
}

TEST_F(CaseTest, EveryDamageNamesItsFile) {
  const cases::CaseManifest m = publish();
  const fs::path glb = folder_ / m.files[0].name, json = folder_ / "case.json";
  const std::string glb_bytes = slurp(glb), json_bytes = slurp(json);
  for (const auto& [path, bytes] : {std::make_pair(glb, glb_bytes), std::make_pair(json, json_bytes)}) {
    const std::string expected = "65 " + path.lexically_relative(folder_).string();
    for (std::size_t i = 0; i < bytes.size(); i += 7) {
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(damaged[i] ^ (1 << (i % 8)));
      put(path, damaged);
      EXPECT_EQ(refusal(), expected) << i;
      put(path, bytes.substr(0, i));
      EXPECT_EQ(refusal(), expected) << i;
    }
    put(path, bytes + "x");
    EXPECT_EQ(refusal(), expected);
    fs::remove(path);
    EXPECT_EQ(refusal(), "66 " + path.lexically_relative(folder_).string());
    put(path, bytes);
    EXPECT_EQ(refusal(), "");
  }
}

TEST_F(CaseTest, NothingIsPublishedWithoutItsFiles) {
  cases::CaseManifest m = publish();
  const std::string before = slurp(folder_ / "case.json");
  m.files[0].bytes += 1;
  EXPECT_THROW(cases::publish_case(folder_, m), Error);
  m.files[0] = cases::describe_case_file("meshes/skull", ".glb", "never written");
  m.anatomies[0].file = m.files[0].name;
  EXPECT_THROW(cases::publish_case(folder_, m), Error);
  EXPECT_EQ(slurp(folder_ / "case.json"), before);
  EXPECT_EQ(refusal(), "");
}

TEST_F(CaseTest, DamagedContentIsWrittenAnew) {
  const cases::CaseManifest m = publish();
  std::string damaged = slurp(folder_ / m.files[0].name);
  damaged[100] = static_cast<char>(damaged[100] ^ 1);
  put(folder_ / m.files[0].name, damaged);
  EXPECT_NE(refusal(), "");
  publish();
  EXPECT_EQ(refusal(), "");
}

TEST_F(CaseTest, OldFilesStayUntilCollected) {
  const cases::CaseManifest m = publish();
  const cases::CaseFile old = cases::write_case_file(folder_, "meshes/skull", ".glb", "an older surface");
  put(folder_ / "notes.txt", "the user's own");
  publish();
  EXPECT_TRUE(fs::exists(folder_ / old.name));
  EXPECT_EQ(cases::remove_unnamed_case_files(folder_), 1);
  EXPECT_FALSE(fs::exists(folder_ / old.name));
  EXPECT_TRUE(fs::exists(folder_ / "notes.txt"));
  EXPECT_EQ(cases::to_json(cases::read_case(folder_)), cases::to_json(m));
  EXPECT_THROW(cases::write_case_file(folder_, "../skull", ".glb", "x"), Error);
}

}  // namespace
}  // namespace trephine

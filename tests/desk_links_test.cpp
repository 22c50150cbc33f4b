// SPDX-License-Identifier: GPL-3.0-or-later
// A library of a stranger, or one that somebody else may write to: links in it lead the desk nowhere. What a desk
// leaves of patients is for its owner alone, and goes when nobody uses it.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <iterator>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "desk/desk.h"
#include "desk/desk_library.h"
#include "desk/message.h"
#include "library/dropped.h"
#include "scratch_folder.h"

namespace trephine::desk {
namespace {

namespace fs = std::filesystem;

class DeskLinks : public testing::Test {
 protected:
  DeskLinks() {
    folder.write("root/trephine.root", "");
    fs::create_directories(library);
    folder.write("outside/case.json", "canary-1f20");
    folder.write("outside/journal.json", "canary-1f20");
  }
  // A library of one case, of a scan that is not read.
  DeskOptions one_case() const {
    folder.write(
        "root/p.yaml",
        "trephine: 1\nanatomies:\n  skull:\n    shows_face: false\n    stages:\n      - segment: {lower_hu: 226}\n"
        "      - contour\n      - normals\n");
    folder.write("root/s.yaml", "trephine: 1\nanatomies:\n  skull: {max_triangles: 80000}\n");
    folder.write("root/a.yaml", "trephine: 1\npipeline: p.yaml\nscene: s.yaml\n");
    folder.write("root/l.yaml", "trephine: 1\ncases:\n  - {case: aa, series: scan, config: a.yaml}\n");
    fs::create_directories(folder.path() / "root/scan");
    DeskOptions options;
    options.library = library;
    options.config = folder.path() / "root/l.yaml";
    return options;
  }
  static Request get(const std::string& path, const std::map<std::string, std::string>& query = {}) {
    Request request;
    request.method = "GET";
    request.path = path;
    for (const auto& [name, value] : query) request.query.emplace(name, value);
    return request;
  }
  static Request post(const std::string& path, const nlohmann::json& json) {
    Request request;
    request.method = "POST";
    request.path = path;
    request.body = json.dump();
    return request;
  }
  // The exit code of what the desk says, and its words.
  std::pair<int, std::string> said(const Request& request) {
    DeskOptions options;
    options.library = library;
    try {
      return {0, Desk(options).answer(request).body};
    } catch (const Error& e) {
      return {int(e.code()), e.line("")};
    }
  }
  std::map<std::string, std::string> outside() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::directory_iterator(folder.path() / "outside")) {
      std::ifstream in(entry.path());
      all[entry.path().filename().string()] = {std::istreambuf_iterator<char>(in), {}};
    }
    return all;
  }
  const ScratchFolder folder;
  const fs::path library = folder.path() / "root/library";
};

TEST_F(DeskLinks, ACaseThatIsALinkIsNeitherReadNorApproved) {
  fs::create_directory_symlink(folder.path() / "outside", library / "bb");
  const auto before = outside();
  for (const Request& request :
       {get("api/lessons", {{"case", "bb"}}), get("api/compare", {{"case", "bb"}}), get("api/log", {{"case", "bb"}}),
        post("api/approve", {{"case", "bb"}, {"by", "anna"}}),
        post("api/approve", {{"case", "bb"}, {"by", "anna"}, {"withdraw", true}})}) {
    const auto [code, words] = said(request);
    EXPECT_EQ(code, 65) << request.path << words;
    EXPECT_NE(words.find("bb: is a symbolic link, and the desk follows none"), std::string::npos) << words;
  }
  const auto [code, list] = said(get("api/library"));
  EXPECT_EQ(code, 0);
  EXPECT_NE(list.find("is a symbolic link"), std::string::npos) << list;
  EXPECT_EQ(list.find("canary"), std::string::npos) << list;
  EXPECT_EQ(outside(), before);
}

TEST_F(DeskLinks, NorIsAFileOfACase) {
  folder.write("root/library/aa/case.json", "{}");
  fs::create_symlink(folder.path() / "outside/case.json", library / "aa/approved.json");
  EXPECT_EQ(said(post("api/approve", {{"case", "aa"}, {"by", "anna"}})).first, 65);
  EXPECT_EQ(said(get("api/lessons", {{"case", "aa"}})).first, 65);
}

TEST_F(DeskLinks, NorAreTheDesksOwnFolders) {
  fs::create_directories(library / ".library");
  fs::create_directory_symlink(folder.path() / "outside", library / ".library/desk");
  EXPECT_EQ(said(get("api/draft", {{"case", "aa"}, {"what", "view"}})).first, 65);
  fs::remove(library / ".library/desk");
  EXPECT_EQ(said(get("api/draft", {{"case", "aa"}, {"what", "view"}})).first, 0);
  fs::remove(library / ".library");
  fs::create_directory_symlink(folder.path() / "outside", library / ".library");
  EXPECT_EQ(said(get("api/library")).first, 65);
}

// What was done by hand lies beside the configuration, in a folder of the case's name.
TEST_F(DeskLinks, NorIsTheFolderOfTheHand) {
  DeskLibrary of(one_case());
  EXPECT_EQ(of.find("aa").token, "aa");
  fs::create_directory_symlink(folder.path() / "outside", folder.path() / "root/aa.desk");
  try {
    of.find("aa");
    FAIL() << "the link is followed";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
  }
}

TEST_F(DeskLinks, WhatWasDroppedAndIsNotUsedGoes) {
  const std::string used = "0123456789abcdef", named = "1123456789abcdef.zip", unused = "2123456789abcdef.zip",
                    incoming = std::string(library::incoming_prefix) + "3123456789abcdef", fresh = "4123456789abcdef";
  folder.write("root/l.yaml", "trephine: 1\ncases:\n  - {case: aa, series: dropped/" + used + ", config: a.yaml}\n");
  folder.write("root/a.yaml", "trephine: 1\nscans: {mr: {series: dropped/" + named + "}}\n");
  const fs::path dropped = folder.path() / "root/dropped";
  for (const std::string& name : {used, incoming, fresh}) folder.write("root/dropped/" + name + "/000000", "a scan");
  for (const std::string& name : {named, unused, std::string("notes.txt")}) folder.write("root/dropped/" + name, "x");
  for (const auto& entry : fs::directory_iterator(dropped))
    if (entry.path().filename() != fresh)
      fs::last_write_time(entry.path(), fs::file_time_type::clock::now() - std::chrono::hours(25));
  // A text that a desk was about to judge when it was killed; no process has that number.
  const fs::path left = folder.write("root/.trephine-tmp-4194999-desk-1-l.yaml", "x");
  DeskOptions options;
  options.library = library;
  options.config = folder.path() / "root/l.yaml";
  EXPECT_EQ(library::unused_drops(options.config, {}, 3600),
            (std::vector<fs::path>{dropped / incoming, dropped / unused}));
  const Desk desk(options);
  for (const std::string& name : {used, named, fresh, std::string("notes.txt")})
    EXPECT_TRUE(fs::exists(dropped / name)) << name;
  for (const std::string& name : {unused, incoming}) EXPECT_FALSE(fs::exists(dropped / name)) << name;
  EXPECT_FALSE(fs::exists(left));
}

// What a stranger calls a folder is a text like any other.
TEST_F(DeskLinks, TextsOfOthersTurnNoDirection) {
  const DeskOptions options = one_case();
  fs::create_directories(folder.path() / "root/skull\u202egpj.exe");
  const std::string body = Desk(options).answer(get("api/folders", {{"path", "0"}})).body;
  EXPECT_NE(body.find("skull?gpj.exe"), std::string::npos) << body;
  EXPECT_EQ(body.find("\u202e"), std::string::npos) << body;
}

TEST_F(DeskLinks, WhatItKeepsIsForItsOwnerAlone) {
  const DeskOptions options = one_case();
  Request keep = post("api/keep", {});
  keep.body = "painted";
  keep.query.emplace("case", "aa");
  keep.query.emplace("what", "view");
  const mode_t before = ::umask(022);
  Desk(options).answer(keep);
  ::umask(before);
  for (const char* name : {".library", ".library/desk"}) {
    struct stat s {};
    ASSERT_EQ(::stat((library / name).c_str(), &s), 0) << name;
    EXPECT_EQ(s.st_mode & 07777, 0700u) << name;
  }
}

}  // namespace
}  // namespace trephine::desk

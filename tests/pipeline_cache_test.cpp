// SPDX-License-Identifier: GPL-3.0-or-later
// An entry of the cache counts only under its own key, and only where nobody else could have put it there.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <map>

#include "base/error.h"
#include "pipeline/stage_cache.h"
#include "scratch_folder.h"

using namespace trephine;
namespace fs = std::filesystem;

namespace {

struct Letter {
  std::string letter;
  template <class V>
  static void describe(V& v) {
    v.text(&Letter::letter, "letter", "A letter.");
  }
};

struct Cache {
  Cache() {
    for (const char digit : {'a', 'b', 'c', 'd'}) {
      const std::string key(64, digit);
      keys.push_back(key);
      surface::TriMesh mesh;
      mesh.points_mm = {{double(digit), 0, 0}, {1, 0, 0}, {0, 1, 0}};
      mesh.triangles = {{0, 1, 2}};
      cache.store(key, stages::DataKind::mesh,
                  {std::make_shared<const surface::TriMesh>(mesh),
                   AnyParams::make<Letter>({std::string(1, digit)}),
                   {{"small", "only {count} triangle", {{"count", std::int64_t{1}}}}}},
                  3);
    }
    for (const auto& e : fs::directory_iterator(path)) content[e.path().filename()] = read(e.path());
  }
  static std::string read(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void restore() const {
    for (const auto& [name, bytes] : content) std::ofstream(path / name, std::ios::binary) << bytes;
  }
  /// What the cache gives for the key, or nothing; never that of another one.
  bool holds(const std::string& key) const {
    stages::StageType type;
    type.declares<NothingDeclared, Letter>();
    const auto made = cache.load_outcome(key, type).made;
    if (!made) return false;
    EXPECT_EQ(result_as<Letter>(made->result).letter, key.substr(0, 1));
    EXPECT_EQ(to_text(made->warnings.at(0)), "only 1 triangle");
    const auto data = cache.load_data(key, stages::DataKind::mesh);
    if (!data) return false;
    EXPECT_EQ(std::get<std::shared_ptr<const surface::TriMesh>>(*data)->points_mm[0].x, double(key[0]));
    return true;
  }
  ScratchFolder folder;
  fs::path path = folder.path() / "cache";
  pipeline::StageCache cache{path};
  std::vector<std::string> keys;
  std::map<std::string, std::string> content;
};

}  // namespace

TEST(StageCache, AnEntryUnderAnotherNameIsNone) {
  Cache c;
  ASSERT_EQ(c.content.size(), 8u);
  for (const std::string& key : c.keys) ASSERT_TRUE(c.holds(key));
  for (const std::string& from : c.keys)
    for (const std::string& to : c.keys)
      for (const int which : {1, 2, 3}) {  // the index, the data, both
        if (from == to) continue;
        c.restore();
        for (const auto& [bit, extension] : {std::pair<int, const char*>{1, ".index"}, {2, ".vtp"}})
          if (which & bit)
            fs::copy_file(c.path / (from + extension), c.path / (to + extension), fs::copy_options::overwrite_existing);
        EXPECT_FALSE(c.cache.look_up(to).has_result && (which & 1)) << "the index of another key";
        EXPECT_FALSE(c.holds(to)) << from[0] << " as " << to[0] << ", " << which;
        EXPECT_FALSE(fs::exists(c.path / (to + ".index"))) << "what is wrong is removed";
        EXPECT_TRUE(c.holds(from));
      }
}

TEST(StageCache, AnEntryThatIsNotAFileOfOursIsNone) {
  Cache c;
  const fs::path index = c.path / (c.keys[0] + ".index"), elsewhere = c.folder.path() / "elsewhere";
  fs::rename(index, elsewhere);
  fs::create_symlink(elsewhere, index);
  EXPECT_FALSE(c.holds(c.keys[0]));
  EXPECT_TRUE(fs::exists(elsewhere));
  if (::geteuid() != 0) return;
  ASSERT_EQ(::chown((c.path / (c.keys[1] + ".vtp")).c_str(), 65534, 65534), 0);
  ASSERT_EQ(::chown((c.path / (c.keys[2] + ".index")).c_str(), 65534, 65534), 0);
  EXPECT_FALSE(c.holds(c.keys[1])) << "somebody else's data";
  EXPECT_FALSE(c.holds(c.keys[2])) << "somebody else's index";
  EXPECT_TRUE(c.holds(c.keys[3]));
}

TEST(StageCache, AFolderThatOthersMayWriteIsRefusedWithWhatMendsIt) {
  Cache c;
  const auto said = [&] {
    try {
      const pipeline::StageCache again(c.path);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::cannot_create);
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(said(), "");
  for (const fs::perms p : {fs::perms::group_write, fs::perms::others_write}) {
    fs::permissions(c.path, fs::perms::owner_all | p);
    EXPECT_NE(said().find("chmod 700 '" + c.path.string() + "'"), std::string::npos) << said();
  }
  fs::permissions(c.path, fs::perms::owner_all | fs::perms::others_read | fs::perms::others_exec);
  EXPECT_EQ(said(), "");
  if (::geteuid() != 0) return;
  ASSERT_EQ(::chown(c.path.c_str(), 65534, 65534), 0);
  EXPECT_NE(said().find("belongs to another user"), std::string::npos) << said();
}

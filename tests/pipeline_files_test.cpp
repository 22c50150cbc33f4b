// SPDX-License-Identifier: GPL-3.0-or-later
// Files that stages read are known by the hash of what was read.
#include <gtest/gtest.h>

#include <fstream>

#include "base/error.h"
#include "base/hash.h"
#include "pipeline/executor.h"
#include "scratch_folder.h"

using namespace trephine;

namespace {

struct FileParams {
  std::string file;
  template <class V>
  static void describe(V& v) {
    v.text(&FileParams::file, "file", "What the stage reads.").names("file");
  }
};

struct NoResult {
  template <class V>
  static void describe(V&) {}
};

using NobodyLooks = pipeline::RunObserver;

}  // namespace

// Where a file is another one when it is read than when it was hashed, the cache would give the result of one for the
// other for ever.
TEST(ExecutorFiles, AFileThatChangesIsStoredUnderNoHash) {
  const ScratchFolder folder;
  const pipeline::StageCache cache(folder.path() / "cache");
  const auto file = folder.write("a.txt", "as it was hashed");
  bool changes = true, refuses = false;
  stages::StageType type;
  type.name = "reads";
  type.output = stages::DataKind::mesh;
  type.declares<FileParams, NoResult>();
  type.run = [&](const AnyParams&, const stages::StageInputs&, const Progress&) -> stages::StageOutcome {
    if (changes) std::ofstream(file) << "as it is read";
    if (refuses) throw Error(ExitCode::quality, "", "", "of what was read");
    auto mesh = std::make_shared<surface::TriMesh>();
    mesh->points_mm = {{1, 2, 3}};
    return {std::shared_ptr<const surface::TriMesh>(mesh), AnyParams::make<NoResult>(), {}};
  };
  pipeline::Node node;
  node.name = "reads";
  node.type = &type;
  node.params = AnyParams::make(FileParams{file.string()});
  node.file_sha256["file"] = sha256_of_file(file);
  node.key = std::string(64, 'b');
  node.output = type.output;
  pipeline::Graph graph;
  graph.nodes.push_back(node);
  pipeline::ExecuteOptions options;
  options.cache = &cache;
  NobodyLooks silent;
  for (const bool refused : {false, true}) {
    refuses = refused;
    try {
      pipeline::execute(graph, {0}, options, silent);
      FAIL() << "no error";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      EXPECT_EQ(e.field(), "reads: file");
      EXPECT_STREQ(e.what(), "changed while it was read: run it again");
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "cache"));
  }
  changes = refuses = false;
  graph.nodes[0].file_sha256["file"] = sha256_of_file(file);
  EXPECT_NO_THROW(pipeline::execute(graph, {0}, options, silent));
}

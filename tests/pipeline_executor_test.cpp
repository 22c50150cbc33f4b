// SPDX-License-Identifier: GPL-3.0-or-later
// The executor on graphs of small made-up stages: order, lifetime of intermediates, errors, cancelling, the cache.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <mutex>
#include <thread>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "dicom/import.h"
#include "pipeline/executor.h"
#include "scratch_folder.h"
#include "stages/import.h"

using namespace trephine;

namespace {

struct NoParams {
  double value = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&NoParams::value, "value", Range{}, "What the stage adds; of its result, where the point lies.");
  }
};

class Silent : public pipeline::RunObserver {
 public:
  void finished(const std::string& node, bool cached, double, const stages::StageOutcome&) override {
    const std::lock_guard<std::mutex> lock(mutex);
    log[node] = cached ? "cached" : "computed";
  }
  std::mutex mutex;
  std::map<std::string, std::string> log;
};

// A mesh of one point whose x is the sum of the sources' x and the parameter; it keeps an eye on who still lives.
struct Fixture {
  std::vector<std::unique_ptr<stages::StageType>> types;
  std::map<std::string, std::weak_ptr<const surface::TriMesh>> made;
  std::vector<std::string> alive_at_end_stage;
  std::mutex mutex;
  pipeline::Graph graph;
  double stage_seconds = 0;
  std::map<std::string, std::size_t> triangles;                       // of what a stage makes
  std::map<std::string, std::function<void(const Progress&)>> first;  // what a stage does before anything else

  int add(const std::string& name, std::vector<int> sources, const std::string& key = "") {
    auto type = std::make_unique<stages::StageType>();
    type->name = name;
    for (std::size_t i = 0; i < sources.size(); ++i)
      type->ports.push_back(stages::port("p" + std::to_string(i), stages::DataKind::mesh));
    type->declares<NoParams, NoParams>();
    type->run = [this, name, n = sources.size()](const AnyParams& p, const stages::StageInputs& in,
                                                 const Progress& progress) -> stages::StageOutcome {
      progress.report(0.5);
      if (const auto f = first.find(name); f != first.end()) f->second(progress);
      if (name.rfind("fails", 0) == 0) throw Error(ExitCode::quality, "", "", "as asked");
      if (name == "waits")
        for (;;) {
          progress.check();
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
      std::this_thread::sleep_for(std::chrono::duration<double>(stage_seconds));
      auto mesh = std::make_shared<surface::TriMesh>();
      mesh->points_mm = {{p.as<NoParams>().value, 0, 0}};
      for (std::size_t i = 0; i < n; ++i)
        mesh->points_mm[0].x += in.get<surface::TriMesh>("p" + std::to_string(i))->points_mm[0].x;
      const std::lock_guard<std::mutex> lock(mutex);
      made[name] = mesh;
      if (name == "last")
        for (const auto& [other, weak] : made)
          if (other != "last" && !weak.expired()) alive_at_end_stage.push_back(other);
      return {std::shared_ptr<const surface::TriMesh>(mesh), AnyParams::make<NoParams>({mesh->points_mm[0].x}), {}};
    };
    pipeline::Node node;
    node.name = name;
    node.type = type.get();
    node.params = AnyParams::make<NoParams>();
    std::static_pointer_cast<NoParams>(node.params.object)->value = double(types.size() + 1);
    for (std::size_t i = 0; i < sources.size(); ++i) node.sources["p" + std::to_string(i)] = sources[i];
    node.key = key.empty() ? std::string(64 - name.size(), '0') + name : key;
    node.output = stages::DataKind::mesh;
    types.push_back(std::move(type));
    graph.nodes.push_back(std::move(node));
    return int(graph.nodes.size()) - 1;
  }
};

double x_of(const pipeline::NodeResult& r) {
  return std::get<std::shared_ptr<const surface::TriMesh>>(r.data)->points_mm.at(0).x;
}

}  // namespace

TEST(Executor, ComputesADiamondAndLetsGoOfWhatIsRead) {
  for (const int threads : {1, 2, 8}) {
    set_thread_count(threads);
    Fixture f;
    const int a = f.add("a", {}), b = f.add("b", {a}), c = f.add("c", {a}), d = f.add("d", {b, c}),
              last = f.add("last", {d});
    Silent silent;
    const auto results = pipeline::execute(f.graph, {last}, {}, silent);
    EXPECT_EQ(x_of(results[size_t(last)]), 1 + 2 + 1 + 3 + 4 + 5);
    EXPECT_EQ(f.alive_at_end_stage, std::vector<std::string>{"d"});
    EXPECT_TRUE(std::holds_alternative<std::monostate>(results[size_t(b)].data));
  }
  set_thread_count(0);
}

TEST(Executor, AnErrorNamesItsStageAndStopsTheOthers) {
  Fixture f;
  set_thread_count(2);
  const int fails = f.add("fails", {}), waits = f.add("waits", {});
  Silent silent;
  try {
    pipeline::execute(f.graph, {waits, fails}, {}, silent);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_EQ(e.field(), "fails");
  }
  set_thread_count(0);
}

// The order hangs on the graph alone: the node that others wait for comes first, though it fails later.
TEST(Executor, TellsTheFirstErrorInOrderAndNotInTime) {
  for (const bool may_be_missing : {false, true}) {
    set_thread_count(2);
    Fixture f;
    std::atomic<bool> other_failed{false};
    const int soon = f.add("fails_soon", {}), late = f.add("fails_late", {}), reader = f.add("reader", {late});
    for (const int n : {soon, late}) f.graph.nodes[std::size_t(n)].may_be_missing = may_be_missing;
    f.first["fails_soon"] = [&](const Progress&) { other_failed = true; };
    f.first["fails_late"] = [&](const Progress& progress) {
      while (!other_failed) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      for (int i = 0; i < 300; ++i, std::this_thread::sleep_for(std::chrono::milliseconds(1))) progress.check();
    };
    Silent silent;
    try {
      pipeline::execute(f.graph, {soon, reader}, {}, silent);
      FAIL() << "no error";
    } catch (const Error& e) {
      EXPECT_EQ(e.field(), "fails_late") << may_be_missing;
    }
  }
  set_thread_count(0);
}

// What comes after a refused node in order is not begun: whether the case can do without it is to be known first.
TEST(Executor, BeginsNothingAfterARefusal) {
  for (const bool may_be_missing : {false, true}) {
    set_thread_count(1);
    Fixture f;
    const int a = f.add("a", {}), fails = f.add("fails", {a}), reader = f.add("reader", {fails}), b = f.add("b", {a}),
              c = f.add("c", {}), last = f.add("last", {b, c, reader});
    f.graph.nodes[std::size_t(fails)].may_be_missing = may_be_missing;
    Silent silent;
    EXPECT_THROW(pipeline::execute(f.graph, {last}, {}, silent), Error);
    EXPECT_EQ(silent.log, (std::map<std::string, std::string>{{"a", "computed"}}));
  }
  set_thread_count(0);
}

// What may refuse the case (a check, a part of the body that is not recognised), and what it reads, comes first.
TEST(Executor, ChecksAndWhatTheyReadComeFirst) {
  set_thread_count(1);
  for (const bool recognises : {false, true}) {
    Fixture f;
    const int a = f.add("a", {}), b = f.add("b", {a}), c = f.add("c", {b}), field = f.add("field", {}),
              check = f.add("fails_check", {field}), last = f.add("last", {c});
    f.types[std::size_t(check)]->check.recognises = recognises;
    f.types[std::size_t(check)]->place = recognises ? stages::StagePlace::anatomy : stages::StagePlace::scan;
    if (!recognises)
      f.types[std::size_t(check)]->output = f.graph.nodes[std::size_t(check)].output = stages::DataKind::nothing;
    Silent silent;
    EXPECT_THROW(pipeline::execute(f.graph, {last, check}, {}, silent), Error);
    EXPECT_EQ(silent.log, (std::map<std::string, std::string>{{"field", "computed"}})) << recognises;
  }
  set_thread_count(0);
}

// What a case asks of a node is held against it when it is made, and when it is read from the cache.
TEST(Executor, IsRefusedByANodeAsSoonAsItIsMade) {
  set_thread_count(1);
  ScratchFolder folder;
  const pipeline::StageCache cache(folder.path() / "cache");
  for (const char* how : {"computed", "cached"}) {
    Fixture f;
    const int a = f.add("a", {}), last = f.add("last", {a});
    pipeline::ExecuteOptions options;
    options.cache = &cache;
    options.asked[a] = [](const pipeline::NodeResult& made) {
      if (x_of(made) == 1) throw Error(ExitCode::quality, "", "of the case", "asks for more");
    };
    Silent silent;
    try {
      pipeline::execute(f.graph, {last}, options, silent);
      FAIL() << "no error";
    } catch (const Error& e) {
      EXPECT_EQ(e.field(), "of the case");  // not the node's: the case asks it
    }
    EXPECT_EQ(silent.log, (std::map<std::string, std::string>{{"a", how}}));
  }
  set_thread_count(0);
}

// What the scene can do without is refused: what runs beside it is made, and is not made again without it.
TEST(Executor, WhatMayBeMissingEndsNothingThatRuns) {
  set_thread_count(2);
  Fixture f;
  std::atomic<bool> runs{false}, refused{false};
  const int fails = f.add("fails", {}), reader = f.add("reader", {fails}), a = f.add("a", {}), b = f.add("b", {a}),
            last = f.add("last", {b, reader});
  for (const int n : {fails, reader}) f.graph.nodes[std::size_t(n)].may_be_missing = true;
  f.first["fails"] = [&](const Progress&) {
    while (!runs) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    refused = true;
  };
  f.first["a"] = [&](const Progress& progress) {
    runs = true;
    while (!refused) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    for (int i = 0; i < 100; ++i, std::this_thread::sleep_for(std::chrono::milliseconds(1))) progress.check();
  };
  std::vector<pipeline::NodeResult> made;
  pipeline::ExecuteOptions options;
  options.made = &made;
  Silent silent;
  try {
    pipeline::execute(f.graph, {last}, options, silent);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.field(), "fails");
  }
  EXPECT_EQ(silent.log.count("a"), 1u);
  ASSERT_EQ(made.size(), f.graph.nodes.size());

  Fixture without;
  const int a2 = without.add("a", {}, f.graph.nodes[std::size_t(a)].key),
            b2 = without.add("b", {a2}, f.graph.nodes[std::size_t(b)].key), last2 = without.add("last", {b2});
  options.known[f.graph.nodes[std::size_t(a)].key] = made[std::size_t(a)];
  Silent again;
  const auto results = pipeline::execute(without.graph, {last2}, options, again);
  EXPECT_EQ(again.log, (std::map<std::string, std::string>{{"b", "computed"}, {"last", "computed"}}));
  EXPECT_EQ(x_of(results[std::size_t(last2)]), (3 + 2) + 3);  // a has the value of the first graph
  EXPECT_EQ(results[std::size_t(a2)].state, pipeline::NodeResult::State::computed);
  set_thread_count(0);
}

TEST(Executor, StopsWhenTheUserCancels) {
  Fixture f;
  const int waits = f.add("waits", {});
  std::atomic<bool> cancel{false};
  std::thread user([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    cancel = true;
  });
  pipeline::ExecuteOptions options;
  options.cancel = &cancel;
  Silent silent;
  EXPECT_THROW(pipeline::execute(f.graph, {waits}, options, silent), Cancelled);
  user.join();
}

TEST(Executor, TakesFromTheCacheWhatIsThereAndWhole) {
  ScratchFolder folder;
  const pipeline::StageCache cache(folder.path() / "cache");
  pipeline::ExecuteOptions options;
  options.cache = &cache;
  const auto run = [&](std::map<std::string, std::string>& log) {
    Fixture f;
    f.stage_seconds = 0.01;
    const int a = f.add("a", {}), b = f.add("b", {a}), last = f.add("last", {b});
    Silent silent;
    const auto results = pipeline::execute(f.graph, {last}, options, silent);
    log = silent.log;
    EXPECT_EQ(result_as<NoParams>(results[size_t(a)].result).value, 1) << "results of what was skipped are known too";
    return x_of(results[size_t(last)]);
  };
  std::map<std::string, std::string> log;
  EXPECT_EQ(run(log), 6);
  EXPECT_EQ(log["a"], "computed");
  EXPECT_EQ(run(log), 6);
  EXPECT_EQ(log, (std::map<std::string, std::string>{{"last", "cached"}}))
      << "what only a cached stage read is not loaded";

  // Any byte of any file of the cache changed, or the file cut short: computed again, never wrong.
  std::vector<std::filesystem::path> files;
  for (const auto& e : std::filesystem::directory_iterator(folder.path() / "cache")) files.push_back(e.path());
  ASSERT_GE(files.size(), 4u);
  for (const auto& file : files)
    for (const double at : {0.0, 0.3, 0.6, 0.99}) {
      std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
      stream.seekg(std::streamoff(double(std::filesystem::file_size(file)) * at));
      const auto place = stream.tellg();
      const char byte = char(stream.get() ^ 0x55);
      stream.seekp(place);
      stream.put(byte);
      stream.close();
      EXPECT_EQ(run(log), 6) << file << " at " << at;
      EXPECT_EQ(run(log), 6);
    }
  for (const auto& file : files) {
    std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
    EXPECT_EQ(run(log), 6) << file;
  }
  cache.shrink_to(0);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "cache"));
  EXPECT_EQ(run(log), 6);
}

TEST(Executor, KeepsEveryOutputAlsoOfWhatTheCacheLetsItSkip) {
  ScratchFolder folder;
  const pipeline::StageCache cache(folder.path() / "cache");
  for (const char* run : {"cold", "warm"}) {
    pipeline::ExecuteOptions options;
    options.cache = &cache;
    options.keep = folder.path() / run;
    std::filesystem::create_directory(options.keep);
    Fixture f;
    f.stage_seconds = 0.01;
    const int a = f.add("a", {}), b = f.add("b", {a}), last = f.add("last", {b});
    Silent silent;
    const auto results = pipeline::execute(f.graph, {last}, options, silent);
    EXPECT_EQ(x_of(results[size_t(last)]), 6);
    EXPECT_TRUE(std::holds_alternative<std::monostate>(results[size_t(a)].data)) << "nobody reads it any more";
    for (const char* name : {"a.vtp", "b.vtp", "last.vtp"})
      EXPECT_TRUE(std::filesystem::exists(options.keep / name)) << run << " " << name;
  }
}

TEST(Executor, GoesOnWithoutACacheThatCannotStore) {
  ScratchFolder folder;
  const pipeline::StageCache cache(folder.path() / "cache");
  std::filesystem::remove_all(folder.path() / "cache");
  folder.write("cache", "a file");
  pipeline::ExecuteOptions options;
  options.cache = &cache;
  Fixture f;
  f.stage_seconds = 0.01;
  const int a = f.add("a", {}), last = f.add("last", {a});
  std::vector<std::string> lines;
  const LogSink before = set_log_sink([&](const std::string& line) { lines.push_back(line); });
  Silent silent;
  const auto results = pipeline::execute(f.graph, {last}, options, silent);
  set_log_sink(before);
  EXPECT_EQ(x_of(results[size_t(last)]), 3);
  ASSERT_EQ(lines.size(), 1u) << "told once";
  EXPECT_NE(lines[0].find("the cache keeps nothing more of this run"), std::string::npos) << lines[0];
}

TEST(Executor, ASeriesThatChangedSinceItWasHashedIsRefusedAndNotCached) {
  ScratchFolder folder;
  const pipeline::StageCache cache(folder.path() / "cache");
  pipeline::Graph graph;
  pipeline::Node import;
  import.name = "import";
  import.type = &stages::stage_named("import");
  const std::filesystem::path series = std::filesystem::path(TREPHINE_SOURCE_DIR) / "sample_dicom";
  stages::ImportStageParams params;
  params.input = series.string();
  import.params = AnyParams::make(params);
  import.file_sha256["input"] = std::string(64, '0');
  import.key = std::string(64, 'a');
  graph.nodes.push_back(std::move(import));
  pipeline::ExecuteOptions options;
  options.cache = &cache;
  Silent silent;
  try {
    pipeline::execute(graph, {0}, options, silent);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
    EXPECT_STREQ(e.what(), "the series changed while it was read");
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "cache"));
  graph.nodes[0].file_sha256["input"] = dicom::hash_of_series_input(series, {});
  EXPECT_NO_THROW(pipeline::execute(graph, {0}, options, silent));
}

TEST(Executor, KeepsEveryOutputWhereAsked) {
  ScratchFolder folder;
  pipeline::ExecuteOptions options;
  options.keep = folder.path();
  Fixture f;
  const int a = f.add("a", {}), last = f.add("last", {a});
  Silent silent;
  pipeline::execute(f.graph, {last}, options, silent);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "a.vtp"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "last.vtp"));
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Large results that wait for a reader lie on disk, and come back as they were.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <functional>

#include "base/error.h"
#include "base/parallel.h"
#include "pipeline/executor.h"
#include "scratch_folder.h"

using namespace trephine;

namespace {

using Field = std::shared_ptr<const grid::Field>;

struct NoParams {
  template <class V>
  static void describe(V&) {}
};

using Silent = pipeline::RunObserver;

struct Nodes {
  std::vector<std::unique_ptr<stages::StageType>> types;
  pipeline::Graph graph;

  int add(const std::string& name, std::vector<int> sources,
          std::function<stages::StageData(const stages::StageInputs&)> run) {
    auto type = std::make_unique<stages::StageType>();
    type->name = name;
    for (std::size_t i = 0; i < sources.size(); ++i)
      type->ports.push_back(stages::port("p" + std::to_string(i), stages::DataKind::field));
    type->make_params = [] { return AnyParams::make<NoParams>(); };
    type->run = [run](const AnyParams&, const stages::StageInputs& in, const Progress&) {
      stages::StageOutcome out;
      out.data = run(in);
      return out;
    };
    pipeline::Node node;
    node.name = name;
    node.type = type.get();
    node.params = AnyParams::make<NoParams>();
    for (std::size_t i = 0; i < sources.size(); ++i) node.sources["p" + std::to_string(i)] = sources[i];
    node.key = std::string(64 - name.size(), '0') + name;
    node.output = stages::DataKind::field;
    types.push_back(std::move(type));
    graph.nodes.push_back(std::move(node));
    return int(graph.nodes.size()) - 1;
  }
};

// A disk with little room, or one that lies in memory, takes nothing.
bool takes_nothing(const std::filesystem::path& folder) {
  return !pipeline::SpilledData::write(std::make_shared<const grid::Field>(grid::Lattice{{200, 250, 100}}), folder);
}

// Of 20 MB, each voxel another value.
grid::Field large(float first) {
  grid::Lattice lattice;
  lattice.size = {200, 250, 100};
  lattice.spacing_mm = {0.4, 0.5, 2};
  lattice.origin_mm = {-3, 5, 7};
  grid::Field out(lattice);
  for (std::size_t i = 0; i < out.voxels.size(); ++i) out.voxels[i] = first + float(i % 100003);
  return out;
}

grid::Field sum(const grid::Field& a, const grid::Field& b) {
  grid::Field out = a;
  for (std::size_t i = 0; i < out.voxels.size(); ++i) out.voxels[i] += b.voxels[i];
  return out;
}

}  // namespace

TEST(Spill, WhatWaitsLeavesTheMemoryAndComesBackAsItWas) {
  const ScratchFolder scratch;
  if (takes_nothing(scratch.path())) GTEST_SKIP() << "the temporary folder has less than 1 GB, or lies in memory";
  for (const bool spills : {true, false}) {
    set_thread_count(1);
    Nodes n;
    std::weak_ptr<const grid::Field> first;
    bool gone = false;
    const int a = n.add("a", {}, [&](const stages::StageInputs&) {
      auto made = std::make_shared<const grid::Field>(large(1));
      first = made;
      return made;
    });
    const int b = n.add("b", {}, [&](const stages::StageInputs&) {
      gone = first.expired();
      return std::make_shared<const grid::Field>(large(2));
    });
    const int c = n.add("c", {a, b}, [&](const stages::StageInputs& in) {
      return std::make_shared<const grid::Field>(sum(*in.get<grid::Field>("p0"), *in.get<grid::Field>("p1")));
    });
    pipeline::ExecuteOptions options;
    if (spills) options.spill = scratch.path();
    Silent silent;
    const auto results = pipeline::execute(n.graph, {a, c}, options, silent);
    EXPECT_EQ(gone, spills);
    EXPECT_EQ(results[std::size_t(c)].spilled != nullptr, spills);
    EXPECT_EQ(std::get<Field>(results[std::size_t(c)].loaded())->voxels, sum(large(1), large(2)).voxels);
    EXPECT_EQ(*std::get<Field>(results[std::size_t(a)].loaded()), large(1));
    EXPECT_EQ(results[std::size_t(b)].loaded().index(), 0u) << "nobody reads it any more";
    EXPECT_TRUE(std::filesystem::is_empty(scratch.path())) << "its files have no names";
  }
  set_thread_count(0);
}

// A surface is not written, however large; what else waits is, also after it.
TEST(Spill, ALargeSurfaceThatWaitsKeepsNothingElseInMemory) {
  const ScratchFolder scratch;
  if (takes_nothing(scratch.path())) GTEST_SKIP() << "the temporary folder has less than 1 GB, or lies in memory";
  set_thread_count(1);
  Nodes n;
  std::weak_ptr<const grid::Field> field;
  bool gone = false;
  const int surface = n.add("a", {}, [&](const stages::StageInputs&) {
    auto made = std::make_shared<surface::TriMesh>();
    made->triangles.resize(2000000);
    return std::shared_ptr<const surface::TriMesh>(std::move(made));
  });
  const int large_field = n.add("b", {}, [&](const stages::StageInputs&) {
    auto made = std::make_shared<const grid::Field>(large(1));
    field = made;
    return made;
  });
  n.add("c", {}, [&](const stages::StageInputs&) {
    gone = field.expired();
    return std::make_shared<const grid::Field>();
  });
  pipeline::ExecuteOptions options;
  options.spill = scratch.path();
  Silent silent;
  const auto results = pipeline::execute(n.graph, {surface, large_field}, options, silent);
  EXPECT_TRUE(gone);
  EXPECT_EQ(results[std::size_t(surface)].data.index(),
            stages::StageData(std::shared_ptr<const surface::TriMesh>()).index());
  set_thread_count(0);
}

// Where a stage reads nothing but the lattice, the voxels stay on disk; the next reader has them all.
TEST(Spill, ALatticeIsReadWithoutItsVoxels) {
  const ScratchFolder scratch;
  if (takes_nothing(scratch.path())) GTEST_SKIP() << "the temporary folder has less than 1 GB, or lies in memory";
  set_thread_count(1);
  Nodes n;
  const int a =
      n.add("a", {}, [](const stages::StageInputs&) { return std::make_shared<const grid::Field>(large(1)); });
  n.add("b", {}, [](const stages::StageInputs&) { return std::make_shared<const grid::Field>(); });
  std::vector<std::size_t> voxels;
  const auto look = [&](const stages::StageInputs& in) {
    const auto& field = *in.get<grid::Field>("p0");
    EXPECT_EQ(static_cast<const grid::Lattice&>(field), static_cast<const grid::Lattice&>(large(1)));
    voxels.push_back(field.voxels.size());
    return std::make_shared<const grid::Field>();
  };
  n.add("c", {a}, look);
  n.types.back()->ports[0].lattice_does = [](const AnyParams&) { return true; };
  n.add("d", {a}, look);
  pipeline::ExecuteOptions options;
  options.spill = scratch.path();
  Silent silent;
  pipeline::execute(n.graph, {}, options, silent);
  EXPECT_EQ(voxels, (std::vector<std::size_t>{0, large(1).count()}));
  set_thread_count(0);
}

TEST(Spill, ManyReadersAtOnceReadTheSame) {
  const ScratchFolder scratch;
  const grid::Field truth = large(3);
  set_thread_count(8);
  Nodes n;
  const int a = n.add("a", {}, [&](const stages::StageInputs&) { return std::make_shared<const grid::Field>(truth); });
  std::atomic<int> wrong{0};
  std::vector<int> layer{a};
  for (int depth = 0; depth < 4; ++depth) {
    std::vector<int> next;
    for (int i = 0; i < 4; ++i)
      next.push_back(n.add("n" + std::to_string(depth) + std::to_string(i), {a, layer[std::size_t(i) % layer.size()]},
                           [&](const stages::StageInputs& in) {
                             wrong += in.get<grid::Field>("p0")->voxels != truth.voxels;
                             wrong += in.get<grid::Field>("p1")->voxels != truth.voxels;
                             return std::make_shared<const grid::Field>(truth);
                           }));
    layer = next;
  }
  pipeline::ExecuteOptions options;
  options.spill = scratch.path();
  Silent silent;
  pipeline::execute(n.graph, layer, options, silent);
  EXPECT_EQ(wrong, 0);
  set_thread_count(0);
}

TEST(Spill, ADiskThatTakesNothingKeepsAllInMemory) {
  const ScratchFolder scratch;
  const stages::StageData data = std::make_shared<const grid::Field>(large(4));
  EXPECT_EQ(pipeline::SpilledData::write(data, "/nowhere/at/all"), nullptr);
  EXPECT_THROW(ScratchFile("/nowhere/at/all"), Error);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit less{1 << 20, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &less);
  const auto too_large = pipeline::SpilledData::write(data, scratch.path());
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(too_large, nullptr);
  const stages::StageData small = std::make_shared<const grid::Field>(grid::Field());
  EXPECT_EQ(pipeline::SpilledData::write(small, scratch.path()), nullptr);
}

TEST(Spill, WhatTheDiskNoLongerHoldsIsAnErrorOfItsOwn) {
  const ScratchFolder scratch;
  ScratchFile file(scratch.path());
  const std::string text = "twelve bytes";
  file.append(text.data(), text.size());
  std::string back(text.size(), ' ');
  file.read(0, back.data(), back.size());
  EXPECT_EQ(back, text);
  try {
    file.read(6, back.data(), back.size());
    FAIL() << "six bytes were there";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::io);
  }
}

TEST(Spill, VolumesOfWholeHuAndOfFractionsComeBackAlike) {
  const ScratchFolder scratch;
  if (takes_nothing(scratch.path())) GTEST_SKIP() << "the temporary folder has less than 1 GB, or lies in memory";
  const grid::Field fractions = large(0.25f);
  grid::Lattice lattice = fractions;
  lattice.size[2] *= 2;  // 20 MB of 16 bits
  grid::Grid<std::int16_t> whole(lattice);
  for (std::size_t i = 0; i < whole.voxels.size(); ++i) whole.voxels[i] = std::int16_t(int(i % 4001) - 1000);
  for (const grid::HuVolume& volume : {grid::HuVolume(fractions), grid::HuVolume(whole)}) {
    const stages::StageData data = std::make_shared<const grid::HuVolume>(volume);
    const auto spilled = pipeline::SpilledData::write(data, scratch.path());
    ASSERT_TRUE(spilled);
    EXPECT_TRUE(*std::get<std::shared_ptr<const grid::HuVolume>>(spilled->read()) == volume);
  }
}

// SPDX-License-Identifier: GPL-3.0-or-later
// What is expected of how long a run takes.
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "pipeline/expected_time.h"
#include "pipeline/schedule.h"

namespace trephine {
namespace {

using Plan = std::vector<std::pair<std::string, double>>;

TEST(Schedule, TimesInWhichSeveralRunAreShared) {
  // 0 (2 s), then 1 (6 s) beside 2 (2 s) and after it 3 (1 s); at last 4 (1 s), which waits for 1 and 3.
  const std::vector<pipeline::ScheduledTask> tasks = {{2, {}}, {6, {0}}, {2, {0}}, {1, {2}}, {1, {1, 3}}};
  const std::vector<double> two = pipeline::wall_shares_s(tasks, 2), expected = {2, 4.5, 1, 0.5, 1};
  ASSERT_EQ(two.size(), expected.size());
  for (std::size_t i = 0; i < two.size(); ++i) EXPECT_NEAR(two[i], expected[i], 1e-12) << i;
  const std::vector<double> one = pipeline::wall_shares_s(tasks, 1);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(one[i], tasks[i].seconds, 1e-12) << i;
  EXPECT_TRUE(pipeline::wall_shares_s({}, 2).empty());
}

// A graph of import, bone.segment, bone.contour, bone.decimate, each of which reads the one before it.
struct Bone {
  stages::StageType import, segment, contour, decimate;
  pipeline::Graph graph;
  Bone() {
    import.typical.base_s = 1;
    segment.typical.base_s = 1;
    segment.typical.per_million_voxels_s = 0.1;
    segment.typical.surface_million = 0.5;
    contour.typical.base_s = 3;
    decimate.typical.base_s = 0;
    decimate.typical.per_million_triangles_s = 20;
    set_thread_count(1);
    add("import", import, stages::DataKind::volume);
    add("bone.segment", segment, stages::DataKind::field);
    add("bone.contour", contour, stages::DataKind::mesh);
    add("bone.decimate", decimate, stages::DataKind::mesh);
  }
  ~Bone() { set_thread_count(0); }
  void add(const char* name, const stages::StageType& type, stages::DataKind output) {
    pipeline::Node node;
    node.name = name;
    node.type = &type;
    node.output = output;
    if (!graph.nodes.empty()) node.sources["in"] = int(graph.nodes.size()) - 1;
    graph.nodes.push_back(node);
  }
};

double second_of(const Plan& plan, const std::string& name) {
  for (const auto& [node, seconds] : plan)
    if (node == name) return seconds;
  return -1;
}

// How long a stage takes hangs on the voxels and the triangles that it reads, which nobody knows before they are made.
TEST(ExpectedTime, FollowsTheVoxelsAndTheTriangles) {
  const Bone bone;
  const std::map<std::string, double> nothing, earlier = {{"bone.decimate", 7}};
  pipeline::ExpectedTime first(bone.graph, nothing), second(bone.graph, earlier);
  // Of a head: 30 million voxels, and of a bone's field half a million triangles.
  EXPECT_EQ(first.plan({1, 1, 1, 1}),
            (Plan{{"import", 1}, {"bone.segment", 4}, {"bone.contour", 3}, {"bone.decimate", 10}}));
  grid::Lattice small;
  small.size = {256, 256, 61};
  first.learn(0, std::make_shared<const grid::HuVolume>(grid::Grid<std::int16_t>(small)));
  EXPECT_NEAR(second_of(first.plan({0, 1, 1, 1}), "bone.segment"), 1.4, 0.001);
  EXPECT_NEAR(second_of(first.plan({0, 1, 1, 1}), "bone.decimate"), 2.5, 0.001) << "a quarter of the pixels";
  surface::TriMesh mesh;
  mesh.triangles.resize(2'000'000);
  const auto contour = std::make_shared<const surface::TriMesh>(mesh);
  first.learn(2, contour);
  EXPECT_EQ(first.plan({0, 0, 0, 1}), (Plan{{"bone.decimate", 40}}));
  second.learn(2, contour);
  EXPECT_EQ(second.plan({0, 0, 0, 1}), (Plan{{"bone.decimate", 7}})) << "an earlier run says it better";
}

// A slow machine, or a stage that finds a scan hard: what has run tells it of what is to come.
TEST(ExpectedTime, FollowsWhatTheNodesTook) {
  Bone bone;
  bone.add("skin.contour", bone.contour, stages::DataKind::mesh);
  const std::map<std::string, double> nothing, earlier = {{"import", 1}, {"bone.decimate", 7}};
  pipeline::ExpectedTime first(bone.graph, nothing), second(bone.graph, earlier);
  const stages::StageData none;
  first.learn(0, none, 11);  // in place of 1 s: 3 s by a slow machine, and 4 s more count as foreseen
  EXPECT_NEAR(second_of(first.plan({0, 1, 1, 1, 1}), "bone.contour"), 3 * 1.4, 1e-9);
  first.learn(2, none, 3);  // the contour as foreseen, the machine as a whole (3 + 3 + 4) / (1 + 3 + 4)
  EXPECT_NEAR(second_of(first.plan({0, 0, 0, 1, 1}), "skin.contour"), 3 * (3 + 0.1 * 1.25) / 3.1, 1e-9);
  second.learn(0, none, 6);
  EXPECT_NEAR(second_of(second.plan({0, 1, 1, 1, 1}), "bone.decimate"), 14, 1e-9);
  EXPECT_NEAR(second_of(second.plan({0, 1, 1, 1, 1}), "bone.contour"), 3, 1e-9) << "which no earlier run has told";
}

}  // namespace
}  // namespace trephine

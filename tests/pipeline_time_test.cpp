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

// How long a stage takes that reads a surface hangs on its triangles, which nobody knows before it is made.
TEST(ExpectedTime, FollowsTheTrianglesOfASurface) {
  set_thread_count(1);
  stages::StageType import, segment, decimate;
  import.typical_s = 1;
  segment.typical_s = 3;
  decimate.typical_s = 5;
  decimate.typical_s_per_million = 20;
  pipeline::Graph graph;
  const auto add = [&](const char* name, const stages::StageType& type, int source) {
    pipeline::Node node;
    node.name = name;
    node.type = &type;
    if (source >= 0) node.sources["in"] = source;
    graph.nodes.push_back(node);
  };
  add("import", import, -1);
  add("bone.segment", segment, 0);
  add("bone.contour", segment, 1);
  add("bone.decimate", decimate, 2);
  const std::map<std::string, double> nothing, earlier = {{"bone.decimate", 7}};
  pipeline::ExpectedTime first(graph, nothing), second(graph, earlier);
  EXPECT_EQ(first.plan({1, 1, 1, 1}),
            (Plan{{"import", 1}, {"bone.segment", 3}, {"bone.contour", 3}, {"bone.decimate", 5}}));
  EXPECT_FALSE(first.learn(1, std::make_shared<const grid::Field>(grid::Field(grid::Lattice{}))));
  surface::TriMesh mesh;
  mesh.triangles.resize(2'000'000);
  const auto contour = std::make_shared<const surface::TriMesh>(mesh);
  EXPECT_TRUE(first.learn(2, contour));
  EXPECT_EQ(first.plan({0, 0, 0, 1}), (Plan{{"bone.decimate", 40}}));
  second.learn(2, contour);
  EXPECT_EQ(second.plan({0, 0, 0, 1}), (Plan{{"bone.decimate", 7}})) << "an earlier run says it better";
  set_thread_count(0);
}

}  // namespace
}  // namespace trephine

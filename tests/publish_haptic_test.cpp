// SPDX-License-Identifier: GPL-3.0-or-later
// What scenes and cases say of burr holes and of the haptic volume, and what is computed for it.
#include <gtest/gtest.h>

#include "base/error.h"
#include "config/config.h"
#include "pipeline/graph.h"
#include "publish/haptic_content.h"
#include "report_of.h"
#include "scratch_folder.h"
#include "voxel/cut.h"
#include "voxel/shape_field.h"
#include "voxel/voxelize.h"

using namespace trephine;

namespace {

const char* const recipe = R"(trephine: 1
anatomies:
  skin: {shows_face: true, stages: [segment, contour, decimate]}
  skull: {shows_face: false, stages: [segment, contour, decimate]}
  brain: {shows_face: false, stages: [brain: {skull: skull.segment}, contour]}
burr_holes: {bone: skull, over: skin}
)";
const char* const materials = R"(trephine: 1
materials:
  bone: {front: {stiffness_n_per_mm: 1}, back: {touchable: false}}
  skin: {front: {stiffness_n_per_mm: 0.3}, back: {touchable: false}}
)";
const char* const live = R"(trephine: 1
anatomies: {skin: {max_triangles: 90000}}
materials: materials.yaml
haptic:
  spacing_mm: [0.5, 0.5, 1]
  region_of: brain
  shapes:
    skull: {material: bone, cuttable: true}
    skin: {material: skin, clear_of: brain, clear_mm: 5}
)";
const char* const drilled = R"(trephine: 1
anatomies: {skin: {max_triangles: 90000}, skull: {max_triangles: 80000}}
burr_holes: {skull: , skin: {widen_mm: 6}}
materials: materials.yaml
haptic: {shapes: {skull: {material: bone}}}
)";
const std::string beginning = "trephine: 1\npipeline: recipe.yaml\nscene: scene.yaml\n";
const std::string one_hole =
    "landmarks: {nasion: [0, -90, 30], inion: [0, 90, 0], monro: [0, 0, 0]}\nburr_holes: [{side: left}]\n";

struct Files {
  ScratchFolder folder;
  std::filesystem::path config;
  Files(const std::string& case_yaml, const std::string& scene_yaml, const std::string& materials_yaml = materials) {
    folder.write("recipe.yaml", recipe);
    folder.write("scene.yaml", scene_yaml);
    folder.write("materials.yaml", materials_yaml);
    config = folder.write("case.yaml", case_yaml);
  }
};

config::CaseConfig read(const std::string& case_yaml, const std::string& scene_yaml) {
  return config::read_case_config(Files(case_yaml, scene_yaml).config);
}

// The one fault that there must be, as the user sees it.
std::string fault(const std::string& case_yaml, const std::string& scene_yaml,
                  const std::string& materials_yaml = materials) {
  const Files files(case_yaml, scene_yaml, materials_yaml);
  try {
    config::read_case_config(files.config);
  } catch (const ErrorList& e) {
    EXPECT_EQ(e.all().size(), 1u) << e.all().back().line("");
    EXPECT_EQ(e.code(), ExitCode::bad_config);
    return e.all()[0].line("");
  }
  return "";
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const stages::VoxelizeStageParams& stage_of(const config::CaseConfig& c) {
  return c.haptic.params.as<stages::VoxelizeStageParams>();
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace

TEST(HapticScene, SaysWhatIsFelt) {
  const config::CaseConfig c = read(beginning + "set: {haptic.margin_mm: 7}\n", live);
  ASSERT_TRUE(c.haptic.wanted);
  const auto& params = c.haptic.params.as<voxel::VoxelizeParams>();
  EXPECT_EQ(params.spacing_mm, (std::array<double, 3>{0.5, 0.5, 1}));
  EXPECT_EQ(params.margin_mm, 7);
  ASSERT_EQ(c.haptic.shapes.size(), 2u);
  EXPECT_EQ(c.haptic.shapes[0].material.name, "bone");
  EXPECT_EQ(c.haptic.shapes[0].material.front.stiffness_n_per_mm, 1);
  EXPECT_TRUE(c.haptic.shapes[0].cuttable);
  EXPECT_FALSE(c.haptic.shapes[1].material.back.touchable);
  EXPECT_EQ(stage_of(c).shapes[1].second.clear_of, "brain");
  EXPECT_TRUE(stage_of(c).drill.empty());
}

TEST(HapticScene, FaultsHaveTheirPlace) {
  EXPECT_TRUE(has(fault(beginning, with(live, "material: bone", "material: bon")),
                  "scene.yaml:8:23: haptic.shapes.skull.material: bon, no such material, did you mean bone?"));
  EXPECT_TRUE(has(fault(beginning, with(live, "    skull:", "    skul:")), "did you mean skull?"));
  EXPECT_TRUE(
      has(fault(beginning, with(live, ", clear_mm: 5", "")), "haptic.shapes.skin.clear_of: and clear_mm go together"));
  EXPECT_TRUE(has(fault(beginning, with(live, "materials: materials.yaml\n", "")), "needs materials: FILE"));
  EXPECT_TRUE(has(fault(beginning, with(live, "cuttable: true", "cuttable: yes")), "must be true or false"));
  EXPECT_TRUE(has(fault(beginning, with(live, "[0.5, 0.5, 1]", "[0.5, 0.5, 0]")), "haptic.spacing_mm"));
  EXPECT_TRUE(has(fault(beginning, live, with(materials, "stiffness_n_per_mm: 1", "stiffness_n_per_mm: -1")),
                  "materials.yaml:3:38: materials.bone.front.stiffness_n_per_mm"));
  EXPECT_TRUE(has(fault(beginning, live, with(materials, ", back: {touchable: false}", "")),
                  "materials.bone.back: is missing"));
}

TEST(HapticScene, WindowsOfRawHu) {
  const std::string hu =
      with(with(live, "  region_of: brain\n", "  encoding: hu\n"),
           "skin: {material: skin, clear_of: brain, clear_mm: 5}", "tooth: {material: bone, window_hu: [1500, 3000]}");
  EXPECT_TRUE(has(fault(beginning, hu), "haptic.shapes.skull.window_hu: is missing"));
  const config::CaseConfig c = read(beginning, with(hu, "cuttable: true", "window_hu: [300, 1499]"));
  EXPECT_EQ(stage_of(c).shapes[1].first, "tooth");
  EXPECT_EQ(stage_of(c).shapes[0].second.window_hu[1], 1499);
  const pipeline::Graph g = pipeline::make_graph(c, "input");
  // Raw HU need no surfaces of the shapes.
  EXPECT_EQ(g.nodes[g.result(stages::DataKind::haptic)].sources, (std::map<std::string, int>{{"volume", 0}}));
}

// As the editor of the window writes it, and as a person does.
TEST(HapticScene, AFunctionMayBeInAFileOfItsOwn) {
  const std::string hu =
      with(with(live, "  region_of: brain\n", "  encoding: hu\n"),
           "skin: {material: skin, clear_of: brain, clear_mm: 5}", "tooth: {material: bone, window_hu: [1500, 3000]}");
  const std::string scene = with(hu, "cuttable: true", "cuttable: true, transfer_file: bone.yaml");
  const char* const written = R"({
  "points": [
    {"hu":100.0,"opacity":0.0,"colour_rgb":[1.0,1.0,1.0]},
    {"hu":300.0,"opacity":1.0,"colour_rgb":[1.0,0.25,1.0]},
    {"hu":1400.0,"opacity":1.0,"colour_rgb":[1.0,1.0,1.0]},
    {"hu":1500.0,"opacity":0.0,"colour_rgb":[1.0,1.0,1.0]}
  ],
  "touched_from_opacity": 0.75
}
)";
  const char* const by_hand = R"(touched_from_opacity: 0.75
points:
  - {hu: 100, opacity: 0, colour_rgb: [1, 1, 1]}
  - {hu: 300, opacity: 1, colour_rgb: [1, 0.25, 1]}
  - {hu: 1400, opacity: 1, colour_rgb: [1, 1, 1]}
  - {hu: 1500, opacity: 0, colour_rgb: [1, 1, 1]}
)";
  for (const char* text : {written, by_hand}) {
    const Files files(beginning, scene);
    files.folder.write("bone.yaml", text);
    const config::CaseConfig c = config::read_case_config(files.config, {});
    EXPECT_EQ(stage_of(c).shapes[0].second.window_hu, (std::array<double, 2>{250, 1425}));
    ASSERT_TRUE(c.haptic.shapes[0].transfer);
    EXPECT_EQ(c.haptic.shapes[0].transfer->points[1].colour_rgb[1], 0.25);
  }
  const auto fault_with = [&](const std::string& said, const std::string& text) -> std::string {
    const Files files(beginning, said);
    if (!text.empty()) files.folder.write("bone.yaml", text);
    try {
      config::read_case_config(files.config, {});
    } catch (const ErrorList& e) {
      return e.all().front().line("");
    } catch (const Error& e) {
      return e.line("");
    }
    return "";
  };
  EXPECT_TRUE(has(fault_with(scene, ""), "bone.yaml"));
  EXPECT_TRUE(has(fault_with(scene, "points: []\n"), "bone.yaml"));
  EXPECT_TRUE(has(fault_with(scene, "preset: bones\n"), "bone.yaml:1:9: preset"));
  EXPECT_TRUE(has(fault_with(with(scene, "bone.yaml", "../../bone.yaml"), written), "transfer_file"));
  EXPECT_TRUE(has(fault_with(with(scene, "transfer_file:", "transfer: {preset: bone}, transfer_file:"), written),
                  "skull.transfer_file: is there beside transfer"));
  EXPECT_TRUE(has(fault_with(with(scene, "transfer_file:", "window_hu: [300, 400], transfer_file:"), written),
                  "skull.window_hu: is there beside transfer"));
  EXPECT_TRUE(has(fault_with(with(live, "cuttable: true", "transfer_file: bone.yaml"), written), "needs encoding: hu"));
}

TEST(HapticScene, OneFunctionSaysWhatIsSeenAndTouched) {
  const std::string hu =
      with(with(live, "  region_of: brain\n", "  encoding: hu\n"),
           "skin: {material: skin, clear_of: brain, clear_mm: 5}", "tooth: {material: bone, window_hu: [1500, 3000]}");
  const std::string ramp =
      "{points: [{hu: 100, opacity: 0, colour_rgb: [1, 1, 1]}, {hu: 300, opacity: 1, colour_rgb: [1, 1, 1]}, "
      "{hu: 1400, opacity: 1, colour_rgb: [1, 1, 1]}, {hu: 1500, opacity: 0, colour_rgb: [1, 1, 1]}], "
      "touched_from_opacity: 0.75}";
  const config::CaseConfig c = read(beginning, with(hu, "cuttable: true", "cuttable: true, transfer: " + ramp));
  EXPECT_EQ(stage_of(c).shapes[0].second.window_hu, (std::array<double, 2>{250, 1425}));
  ASSERT_TRUE(c.haptic.shapes[0].transfer);
  EXPECT_EQ(c.haptic.shapes[0].transfer->points.size(), 4u);
  EXPECT_EQ(c.haptic.shapes[0].transfer->touched_from_opacity, 0.75);
  EXPECT_FALSE(c.haptic.shapes[1].transfer);

  const std::string at = "haptic.shapes.skull.";
  EXPECT_TRUE(has(fault(beginning, with(hu, "cuttable: true", "transfer: {preset: bone}")),
                  "tooth.window_hu: 1500 to 3000 HU are touched, and skull is touched from 228 to 32767 HU"));
  EXPECT_TRUE(has(fault(beginning, with(hu, "cuttable: true", "transfer: {preset: bones}")), "preset"));
  EXPECT_TRUE(has(fault(beginning, with(hu, "cuttable: true", "window_hu: [300, 400], transfer: {preset: bone}")),
                  "skull.window_hu: is there beside transfer"));
  EXPECT_TRUE(has(fault(beginning, with(live, "cuttable: true", "transfer: {preset: bone}")),
                  "skull.transfer: is of HU, and needs encoding: hu"));
  EXPECT_TRUE(has(fault(beginning, with(hu, "cuttable: true",
                                        "transfer: {points: [{hu: 10, opacity: 0.2, colour_rgb: [1, 1, 1]}, {hu: 300, "
                                        "opacity: 1, colour_rgb: [1, 1, 1]}]}")),
                  at + "transfer.points[0].opacity: 0.2, must be 0"));
  EXPECT_TRUE(has(fault(beginning, with(hu, "cuttable: true", "transfer: {points: [{hu: 10, opacity: 0}]}")),
                  "colour_rgb: is missing"));
}

// A surface beside the volume that is touched as a mesh.
TEST(HapticScene, ASurfaceIsTouchedAsAMesh) {
  const auto skin = [](const std::string& more) {
    return with(live, "anatomies: {skin: {max_triangles: 90000}}",
                "anatomies: {skin: {max_triangles: 90000" + more + "}}");
  };
  const config::CaseConfig c = read(beginning, skin(", touched_as: bone"));
  ASSERT_EQ(c.scene.size(), 1u);
  EXPECT_EQ(c.scene[0].material.name, "bone");
  EXPECT_EQ(c.scene[0].material.front.stiffness_n_per_mm, 1);
  EXPECT_TRUE(read(beginning, live).scene[0].material.name.empty());
  const std::string at = "anatomies.skin.touched_as: ";
  EXPECT_TRUE(has(fault(beginning, skin(", touched_as: bon")), at + "bon, no such material, did you mean bone?"));
  EXPECT_TRUE(has(fault(beginning, skin(", touched_as: bone"),
                        with(materials, "stiffness_n_per_mm: 1", "stiffness_n_per_mm: 1, pop_through_n: 2")),
                  at + "bone: its front pops (pop_through_n)"));
  const std::string volume = skin(", touched_as: bone");
  EXPECT_TRUE(has(fault(beginning, volume.substr(0, volume.find("haptic:"))), at + "needs haptic: beside it"));
}

TEST(Scene, DoesWithoutWhatMayBeMissing) {
  const std::string scene =
      with(live, "anatomies: {skin: {max_triangles: 90000}}",
           "anatomies: {skin: {max_triangles: 90000}, skull: {max_triangles: 80000, may_be_missing: true}}");
  config::CaseConfig c = read(beginning, scene);
  const pipeline::Graph whole = pipeline::make_graph(c, "input");
  EXPECT_TRUE(whole.nodes[std::size_t(whole.find("skull.contour"))].may_be_missing);
  EXPECT_FALSE(whole.nodes[std::size_t(whole.find("skin.contour"))].may_be_missing);
  c.leave_out("skull");
  EXPECT_FALSE(c.is_shown("skull"));
  const pipeline::Graph rest = pipeline::make_graph(c, "input");
  EXPECT_LT(rest.find("skull.contour"), 0);
  EXPECT_GE(rest.find("skull.segment"), 0) << "the brain is made from it";
  EXPECT_FALSE(rest.nodes[std::size_t(rest.find("skull.segment"))].may_be_missing) << "and cannot do without";
  ASSERT_EQ(stage_of(c).shapes.size(), 1u);
  EXPECT_EQ(stage_of(c).shapes[0].first, "skin");
  EXPECT_EQ(rest.nodes[std::size_t(rest.result(stages::DataKind::haptic))].sources.count("shape.skull"), 0u);
}

TEST(BurrHoles, AreTheScenesAndTheCases) {
  EXPECT_TRUE(has(fault(beginning, drilled), "burr_holes: is missing: the scene cuts them"));
  const config::CaseConfig none = read(beginning + std::string("burr_holes: []\n"), drilled);
  EXPECT_TRUE(none.burr_holes.empty() && !none.drilled.empty()) << "where none is said to be meant, none is cut";
  EXPECT_LT(pipeline::make_graph(none, "input").find("skull.boolean"), 0);
  EXPECT_TRUE(has(fault(beginning + with(one_hole, "side: left", "side: up"), drilled), "burr_holes[0].side: up"));
  EXPECT_TRUE(has(fault(beginning + with(one_hole, "side: left", "toward: monr"), drilled), "no such landmark"));
  EXPECT_TRUE(has(fault(beginning + with(one_hole, "side: left", "toward: monro, direction: [0, 0, -1]"), drilled),
                  "contradict each other"));
  EXPECT_TRUE(has(fault(beginning + with(one_hole, "side: left", "toward: monro, target_mm: [0, 0, 1]"), drilled),
                  "target_mm: and toward contradict each other"));
  const config::CaseConfig c = read(beginning + one_hole, drilled);
  ASSERT_EQ(c.burr_holes.size(), 1u);
  EXPECT_EQ(c.burr_holes[0].name, "burr_hole_1");
  EXPECT_NE(find_item(stage_of(c).drill, "skull"), nullptr);
  // The wall of the hole is triangles too.
  EXPECT_EQ(
      to_text(c.find_anatomy("skull")
                  ->find_step("decimate")
                  ->params.get(*stages::find_stage("decimate")->make_params().set->find("target_triangles_count"))),
      "76000");
  // A scene that cuts none does not want them.
  EXPECT_TRUE(read(beginning + one_hole, live).burr_holes.empty());
}

TEST(HapticGraph, HoldsWhatIsFeltAndNoMore) {
  const pipeline::Graph g = pipeline::make_graph(read(beginning, live), "input");
  for (const char* needed : {"skin.decimate", "brain.contour", "haptic.voxelize", "haptic.mismatch"})
    EXPECT_GE(g.find(needed), 0) << needed;
  // The skull is displayed from the volume, and felt by its field: it needs no triangle.
  EXPECT_LT(g.find("skull.contour"), 0);
  EXPECT_EQ(g.nodes[g.find("haptic.voxelize")].sources.at("shape.skull"), g.find("skull.segment"));
  EXPECT_EQ(g.nodes[g.find("haptic.voxelize")].sources.at("shape.skin"), g.find("skin.contour"));
  // A contour that is told to leave something of the field is not the field's solid.
  config::ConfigOverrides overrides;
  overrides.set = {"skull.contour.keep_cavities=true"};
  const Files files(beginning, live);
  const pipeline::Graph own = pipeline::make_graph(config::read_case_config(files.config, overrides), "input");
  EXPECT_EQ(own.nodes[own.find("haptic.voxelize")].sources.at("shape.skull"), own.find("skull.contour"));
  EXPECT_EQ(g.nodes[g.find("haptic.mismatch")].sources.count("surface.skin"), 1u);
  EXPECT_EQ(g.nodes[g.find("haptic.mismatch")].sources.count("surface.skull"), 0u);
}

TEST(HapticGraph, OneBurrHoleCutsMeshAndVolume) {
  const config::CaseConfig c = read(beginning + one_hole, drilled);
  const pipeline::Graph g = pipeline::make_graph(c, "input");
  ASSERT_EQ(g.results(stages::DataKind::cutters).size(), 1u);
  for (const char* cut : {"skull.boolean", "skin.boolean", "haptic.voxelize"})
    EXPECT_EQ(g.nodes[g.find(cut)].sources.at("cutters.burr_hole_1"), g.result(stages::DataKind::cutters)) << cut;
  EXPECT_EQ(g.anatomies[1].surface, g.find("skull.boolean"));
  // A hole is no deviation: what is measured is the surface before it.
  EXPECT_EQ(g.nodes[g.find("skull.measure")].sources.at("surface"), g.find("skull.decimate"));
  // Another landmark is another hole; another width of the skin's share is another skin, and the same skull.
  const pipeline::Graph moved =
      pipeline::make_graph(read(beginning + with(one_hole, "[0, -90, 30]", "[0, -91, 30]"), drilled), "input");
  EXPECT_NE(moved.nodes[moved.find("skull.boolean")].key, g.nodes[g.find("skull.boolean")].key);
  const pipeline::Graph wider =
      pipeline::make_graph(read(beginning + one_hole, with(drilled, "widen_mm: 6", "widen_mm: 7")), "input");
  EXPECT_NE(wider.nodes[wider.find("skin.boolean")].key, g.nodes[g.find("skin.boolean")].key);
  EXPECT_EQ(wider.nodes[wider.find("skull.boolean")].key, g.nodes[g.find("skull.boolean")].key);
}

static voxel::Bore bore(const boolean::Cutter& c) {
  return {c.position_mm, c.direction, c.radius_mm, c.above_mm, c.depth_mm};
}

TEST(HapticHole, IsFreeOnlyWhereItWasDrilled) {
  // A plate of bone from z = -4 to 4.
  surface::TriMesh plate;
  for (int i = 0; i < 8; ++i) plate.points_mm.push_back({i & 1 ? 20. : -20., i & 2 ? 20. : -20., i & 4 ? 4. : -4.});
  plate.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  voxel::VoxelizeParams params;
  Report report;
  const grid::Lattice lattice = voxel::haptic_lattice({{-25, -25, -10}, {25, 25, 10}}, Mat3{}, {}, params);
  voxel::HapticVolume volume = value_of(report, voxel::voxelize(lattice, {{"skull", &plate, nullptr, 0}}));
  boolean::Cutter hole;
  hole.position_mm = {0.3, -0.2, 5};
  hole.direction = {0, 0, -1};
  hole.radius_mm = 6;
  hole.above_mm = 5;
  hole.depth_mm = 12;
  EXPECT_FALSE(voxel::hole_is_free(volume, "skull", bore(hole)));
  value_of(report, voxel::cut_volume(volume, boolean::distance_to(hole), boolean::bounds_of(hole), {1}));
  EXPECT_TRUE(voxel::hole_is_free(volume, "skull", bore(hole)));
  // The same hole a millimetre aside is not.
  hole.position_mm.x += 1.2;
  EXPECT_FALSE(voxel::hole_is_free(volume, "skull", bore(hole)));
}

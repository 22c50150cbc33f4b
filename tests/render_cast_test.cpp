// SPDX-License-Identifier: GPL-3.0-or-later
// Volumes in the renderer's pictures are those of the reference ray caster, before and behind surfaces, and follow
// cuts.
#include <algorithm>
#include <random>

#include "cast/transfer_edit.h"
#include "cast_phantoms.h"
#include "render_cast_scene.h"
#include "scratch_folder.h"

namespace trephine::drawing {
namespace {

using casting::ramp;

// A sheet through the middle of a volume, and the volume.
struct Phantom {
  grid::Grid<std::int16_t> voxels;
  std::vector<voxel::TransferFunction> functions;
  Vec3 sheet{0.2, 0.9, -0.4};
};

Phantom hard() { return {casting::ball(casting::lattice(44, 0.8), 14, 100), {ramp(0, 60)}}; }
Phantom veil() {
  Phantom p{casting::ball(casting::lattice(44, 0.8), 14, 100), {ramp(0, 400, 0.15), ramp(800, 900)}};
  p.functions[0].points[0].colour_rgb = p.functions[0].points[1].colour_rgb = {0.9, 0.5, 0.4};
  return p;
}
// Lumps of every size, as bone has.
Phantom lumps() {
  std::mt19937_64 rng(3);
  std::vector<std::pair<Vec3, double>> balls;
  const grid::Lattice l = casting::lattice(48, 0.7);
  const auto some = [&] { return double(rng() >> 11) * 0x1p-53; };
  for (int n = 0; n < 60; ++n)
    balls.emplace_back(l.to_world_mm({4 + 40 * some(), 4 + 42 * some(), 4 + 38 * some()}), 1 + 4 * some());
  return {casting::filled(l,
                          [&](Vec3 p) {
                            double hu = -900;
                            for (const auto& [at, r] : balls) hu = std::max(hu, 400 * (r - norm(p - at)));
                            return hu;
                          }),
          {ramp(150, 300, 0.8)}};
}

scene::SceneData scene_of(const Phantom& p) {
  scene::SceneData s;
  s.centre_mm = casting::middle_of(p.voxels);
  s.bounds = {s.centre_mm - Vec3{30, 30, 30}, s.centre_mm + Vec3{30, 30, 30}};
  const Vec3 n = normalized(p.sheet), a = normalized(cross(n, {0, 0, 1})), b = cross(n, a);
  surface::TriMesh m;
  m.origin_mm = s.centre_mm;
  for (const auto& [x, y] : {std::pair{-11, -11}, {11, -11}, {11, 11}, {-11, 11}}) {
    m.points_mm.push_back(a * x + b * y);
    m.normals.push_back(n);
  }
  m.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 2, 1}, {0, 3, 2}};  // seen from both sides
  scene::SceneSurface sheet = surface_of(m, "sheet", {0.3, 0.8, 0.4});
  for (scene::SceneVertex& v : sheet.vertices)
    for (int c = 0; c < 3; ++c) v.position_mm[c] -= float(s.centre_mm[c]);
  s.surfaces = {sheet};
  return s;
}

class RenderCast : public Picture {
 protected:
  // How far the renderer's picture is from the reference, with the sheet before and behind parts of the volume.
  static Difference difference(const Phantom& p, const scene::EyeView& eye, bool sheet,
                               const cast::CastParams& params = {}) {
    render::RenderQuality quality;
    quality.samples = 1;
    quality.occlusion = quality.grain = false;
    render::Renderer renderer(scene_of(p), quality);
    scene::SceneState state;
    state.opacity = {sheet ? 1.0 : 0.0};
    const trephine::scene::Picture behind = drawn(renderer, eye, state);
    state.cut = params.cut;
    state.cast_box = params.box;
    const cast::CastTable table(p.functions);
    renderer.rays().show(&p.voxels, table);
    const trephine::scene::Picture is = drawn(renderer, eye, state);
    cast::CastParams with = params;
    if (sheet) with.surface_mm = sheet_mm(p, eye);
    return compare(is, cast::cast_rays(p.voxels, table, cast::CastBricks(p.voxels, table), eye, width, height, with),
                   behind);
  }

  static std::vector<float> sheet_mm(const Phantom& p, const scene::EyeView& eye) {
    const Vec3 n = normalized(p.sheet), a = normalized(cross(n, {0, 0, 1})), b = cross(n, a),
               middle = casting::middle_of(p.voxels);
    std::vector<float> all(std::size_t(width * height), std::numeric_limits<float>::infinity());
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const Vec3 d = eye.ray(x + 0.5, y + 0.5, width, height);
        const double t = dot(n, middle - eye.eye_mm) / dot(n, d);
        const Vec3 at = eye.eye_mm + d * t - middle;
        if (std::abs(dot(at, a)) <= 11 && std::abs(dot(at, b)) <= 11)
          all[std::size_t(y * width + x)] = float(-t * dot(d, eye.toward));
      }
    return all;
  }
};

const Vec3 sides[] = {{0.3, -0.5, 0.8}, {1, 0.05, 0.02}, {-0.6, -0.7, -0.3}};

TEST_F(RenderCast, IsThePictureOfTheReference) {
  const Phantom phantoms[] = {hard(), veil(), lumps()};
  for (int n = 0; n < 3; ++n) {
    const Difference d = difference(phantoms[n], eye_of_picture(phantoms[n].voxels, sides[n]), false);
    EXPECT_GT(d.covered, 15000);
    EXPECT_LE(d.median, median_most);
    EXPECT_LE(d.p95, p95_most);
  }
}

TEST_F(RenderCast, IsBeforeAndBehindSurfaces) {
  for (const Phantom& p : {hard(), veil(), lumps()}) {
    const scene::EyeView eye = eye_of_picture(p.voxels, sides[0]);
    const Difference d = difference(p, eye, true);
    EXPECT_GT(d.covered, 15000);
    EXPECT_LE(d.median, median_most);
    EXPECT_LE(d.p95, p95_most);
  }
}

TEST_F(RenderCast, EndsAtThePlaneAndTheBox) {
  for (const Phantom& p : {hard(), lumps()}) {
    const Vec3 middle = casting::middle_of(p.voxels);
    cast::CastParams params;
    params.cut = scene::CutPlane{middle, {0.2, -0.3, 1}};
    const Difference cut = difference(p, eye_of_picture(p.voxels, sides[0]), false, params);
    EXPECT_GT(cut.covered, 8000);
    EXPECT_LE(cut.median, median_most);
    EXPECT_LE(cut.p95, p95_most);
    params.cut.reset();
    params.box = surface::Bounds{middle - Vec3{8, 20, 9}, middle + Vec3{7, 5, 10}};
    const Difference box = difference(p, eye_of_picture(p.voxels, sides[0]), false, params);
    EXPECT_GT(box.covered, 3000);
    EXPECT_LT(box.covered, cut.covered);
    EXPECT_LE(box.median, median_most);
    EXPECT_LE(box.p95, p95_most);
  }
}

// What is cut is seen at once, brick by brick: the picture is that of the volume as it is.
TEST_F(RenderCast, FollowsCuts) {
  Phantom p = hard();
  render::RenderQuality quality;
  quality.samples = 1;
  const scene::EyeView eye = eye_of_picture(p.voxels, sides[0]);
  scene::SceneState state;
  state.opacity = {0};
  const cast::CastTable table(p.functions);
  render::Renderer renderer(scene_of(p), quality);
  renderer.rays().show(&p.voxels, table);
  const trephine::scene::Picture before = drawn(renderer, eye, state);
  const grid::Box box{{14, 16, 18}, {33, 31, 42}};
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i) p.voxels.at(i, j, k) = -1024;
  EXPECT_EQ(drawn(renderer, eye, state).rgb, before.rgb);
  renderer.rays().follow(box);
  const trephine::scene::Picture after = drawn(renderer, eye, state);
  EXPECT_NE(after.rgb, before.rgb);
  render::Renderer anew(scene_of(p), quality);
  anew.rays().show(&p.voxels, table);
  EXPECT_EQ(drawn(anew, eye, state).rgb, after.rgb);
  // And filling it again puts it back; what of a box lies beyond the volume is left out.
  p.voxels = hard().voxels;
  renderer.rays().follow({{-30, 16, 18}, {33, 90, 4000}});
  EXPECT_EQ(drawn(renderer, eye, state).rgb, before.rgb);
}

// While the view moves there are fewer rays than pixels; when it stands still the whole picture comes.
TEST_F(RenderCast, RefinesWhenTheViewStandsStill) {
  const Phantom p = lumps();
  render::RenderQuality quality;
  quality.samples = 1;
  scene::SceneState state;
  state.opacity = {0};
  const cast::CastTable table(p.functions);
  render::Renderer whole(scene_of(p), quality), renderer(scene_of(p), quality);
  whole.rays().show(&p.voxels, table);
  renderer.rays().show(&p.voxels, table);
  quality.cast_ms = 1;  // nothing is so quick
  renderer.set_quality(quality);
  scene::EyeView eye = eye_of_picture(p.voxels, sides[0]);
  for (int n = 0; n < 8; ++n) {
    eye = eye_of_picture(p.voxels, sides[0] + Vec3{0.02 * n, 0, 0});
    drawn(renderer, eye, state);
  }
  const trephine::scene::Picture moving = drawn(renderer, eye_of_picture(p.voxels, sides[0]), state);
  EXPECT_LT(renderer.rays().scale(), 0.5);
  trephine::scene::Picture still = moving;
  for (int n = 0; n < 6; ++n) still = drawn(renderer, eye_of_picture(p.voxels, sides[0]), state);
  EXPECT_EQ(renderer.rays().scale(), 1);
  EXPECT_NE(still.rgb, moving.rgb);
  EXPECT_EQ(still.rgb, drawn(whole, eye_of_picture(p.voxels, sides[0]), state).rgb);
}

// However slowly a tool goes, rays are cast anew when it has left where it was when they were.
TEST_F(RenderCast, SeesAToolThatCreeps) {
  const Phantom p = hard();
  render::RenderQuality quality;
  quality.samples = 1;
  quality.cast_ms = 1;
  scene::SceneState state;
  state.opacity = {0};
  state.tool_shown = true;
  state.axis = {0, 0, 1};
  state.tip_mm = casting::middle_of(p.voxels);
  render::Renderer renderer(scene_of(p), quality);
  renderer.rays().show(&p.voxels, cast::CastTable(p.functions));
  const scene::EyeView eye = eye_of_picture(p.voxels, sides[0]);
  for (int n = 0; n < 8; ++n) drawn(renderer, eye, state);
  ASSERT_EQ(renderer.rays().scale(), 1);
  int moved = 0;
  for (int n = 0; n < 9; ++n) {
    state.tip_mm.x += 0.02;
    drawn(renderer, eye, state);
    moved += renderer.rays().scale() < 1;
  }
  EXPECT_GE(moved, 3);  // each 0.06 mm
}

// The case of a window's tests, with a CT in which all that is felt is bone.
class RenderCastStage : public PlayCase {
 protected:
  void SetUp() override {
    PlayCase::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    loaded_.ct = grid::Grid<std::int16_t>(loaded_.haptic.voxels, -1000);
    for (std::size_t n = 0; n < loaded_.ct.voxels.size(); ++n)
      if (loaded_.haptic.voxels.voxels[n] != voxel::haptic_empty) loaded_.ct.voxels[n] = 500;
    view_.occlusion = false;
    view_.view = scene::ViewPreset::front;
    view_.cast = scene::ViewParams::Cast::ct;
  }
};

// What a tool takes from the haptic volume is gone from the CT, and an undo puts it back.
TEST_F(RenderCastStage, TheCtFollowsWhatIsCut) {
  const grid::Grid<std::int16_t> uncut = loaded_.haptic.voxels;
  render::Stage stage(loaded_, view_);
  const scene::OrbitCamera camera = scene::camera_of(view_, loaded_.manifest, stage.scene());
  const trephine::scene::Picture before = shot(stage, camera);
  drill::DirtyBricks marks(loaded_.haptic.voxels);
  const auto cut = [&](bool empty) {
    for (int k = 30; k < 44; ++k)
      for (int j = 0; j < 30; ++j)
        for (int i = 28; i < 46; ++i) {
          loaded_.haptic.voxels.at(i, j, k) = empty ? voxel::haptic_empty : uncut.at(i, j, k);
          marks.mark_voxel(i, j, k);
        }
    stage.follow(marks);
  };
  cut(true);
  const trephine::scene::Picture after = shot(stage, camera);
  int changed = 0;
  for (std::size_t n = 0; n < after.rgb.size(); n += 3) changed += after.rgb[n] != before.rgb[n];
  EXPECT_GT(changed, 200);
  render::Stage later(loaded_, view_, &uncut);  // as a recording's pictures begin
  EXPECT_EQ(shot(later, camera).rgb, after.rgb);
  cut(false);
  EXPECT_EQ(shot(stage, camera).rgb, before.rgb);
}

// What is refused leaves the rays as they were, and they follow cuts as before.
TEST_F(RenderCastStage, FollowsCutsAfterARefusal) {
  render::Stage stage(loaded_, view_);
  const scene::OrbitCamera camera = scene::camera_of(view_, loaded_.manifest, stage.scene());
  const trephine::scene::Picture before = shot(stage, camera);
  for (const auto& [what, transfer] :
       {std::pair(scene::ViewParams::Cast::haptic, "bone"), std::pair(scene::ViewParams::Cast::none, "bones")})
    EXPECT_THROW(stage.cast(what, transfer), Error);
  EXPECT_EQ(shot(stage, camera).rgb, before.rgb);
  drill::DirtyBricks marks(loaded_.haptic.voxels);
  for (int k = 30; k < 44; ++k)
    for (int j = 0; j < 30; ++j)
      for (int i = 28; i < 46; ++i) {
        loaded_.haptic.voxels.at(i, j, k) = voxel::haptic_empty;
        marks.mark_voxel(i, j, k);
      }
  stage.follow(marks);
  const trephine::scene::Picture after = shot(stage, camera);
  EXPECT_NE(after.rgb, before.rgb);
  // Nor is what is no longer cast followed, and it is as it was cut where it is cast again.
  stage.cast(scene::ViewParams::Cast::none, "");
  stage.cast(scene::ViewParams::Cast::ct, "");
  EXPECT_EQ(shot(stage, camera).rgb, after.rgb);
}

TEST_F(RenderCastStage, OnlyNamedAnatomiesAreDrawnBesideIt) {
  view_.opacity = "brain=0.5";
  render::Stage stage(loaded_, view_);
  EXPECT_EQ(stage.state.opacity, (std::vector<double>{0, 0, 0.5}));
  stage.cast(scene::ViewParams::Cast::none, "");
  EXPECT_EQ(stage.state.opacity[2], 0.5);
  EXPECT_GT(stage.state.opacity[0], 0);
  EXPECT_EQ(stage.renderer().rays().scale(), 0);
}

// What an editor changes is seen at once, and what it wrote gives the same picture again.
TEST_F(RenderCastStage, AnEditedFunctionComesBackFromItsFile) {
  for (std::size_t n = 0; n < loaded_.ct.voxels.size(); ++n)
    if (loaded_.ct.voxels[n] == 500) loaded_.ct.voxels[n] = std::int16_t(200 + n % 7 * 60);
  render::Stage stage(loaded_, view_);
  const scene::OrbitCamera camera = scene::camera_of(view_, loaded_.manifest, stage.scene());
  const trephine::scene::Picture bone = shot(stage, camera);
  ASSERT_EQ(stage.cast_source().functions().size(), 1u);
  ASSERT_EQ(stage.cast_source().voxels()->count(), loaded_.ct.count());
  voxel::TransferFunction f = stage.cast_source().functions()[0];
  f = cast::with_colour(cast::with_moved(f, 1, 431, 0.317), 1, {0.9, 0.3, 1.0 / 3});
  f = cast::with_added(f, 350, 0.2).value().function;
  stage.cast(f);
  const trephine::scene::Picture edited = shot(stage, camera);
  EXPECT_NE(edited.rgb, bone.rgb);
  ScratchFolder folder;
  const std::string file =
      folder.write("f.yaml", cast::transfer_file_text(stage.cast_source().functions()[0])).string();
  stage.cast(scene::ViewParams::Cast::ct, "bone");
  EXPECT_EQ(shot(stage, camera).rgb, bone.rgb);
  stage.cast(scene::ViewParams::Cast::ct, file);
  EXPECT_EQ(shot(stage, camera).rgb, edited.rgb);
  view_.transfer = file;
  render::Stage later(loaded_, view_);
  EXPECT_EQ(shot(later, camera).rgb, edited.rgb);
}

TEST_F(RenderCastStage, SaysWhatTheCaseHasNot) {
  const auto refused = [&](scene::ViewParams::Cast what, const std::string& transfer) -> std::string {
    try {
      render::Stage stage(loaded_, view_);
      stage.cast(what, transfer);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::usage);
      return e.field() + " " + e.what();
    }
    return "";
  };
  EXPECT_EQ(
      refused(scene::ViewParams::Cast::haptic, "bone"),
      "--transfer is of HU, and the case's haptic volume holds shapes; --opacity says how opaque each of them is");
  EXPECT_EQ(refused(scene::ViewParams::Cast::ct, "bones").substr(0, 17), "--transfer bones:");
  loaded_.ct = {};
  view_.cast = scene::ViewParams::Cast::none;
  EXPECT_EQ(refused(scene::ViewParams::Cast::ct, ""),
            "--cast ct: the case has no CT; a scene asks for it with `ct: {}`");
}

// What OpenGL keeps from before a volume was cast is not what it needs after: pictures without one are as they were.
TEST_F(RenderCastStage, LeavesOtherPicturesAsTheyAre) {
  view_.cast = scene::ViewParams::Cast::none;
  view_.occlusion = true;
  view_.opacity = "scalp=0.4";
  render::Stage stage(loaded_, view_);
  const scene::OrbitCamera camera = scene::camera_of(view_, loaded_.manifest, stage.scene());
  const trephine::scene::Picture before = shot(stage, camera);
  stage.cast(scene::ViewParams::Cast::ct, "skin");
  EXPECT_NE(shot(stage, camera).rgb, before.rgb);
  stage.cast(scene::ViewParams::Cast::none, "");
  EXPECT_EQ(shot(stage, camera).rgb, before.rgb);
}

}  // namespace
}  // namespace trephine::drawing

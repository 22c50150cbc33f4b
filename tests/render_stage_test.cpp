// SPDX-License-Identifier: GPL-3.0-or-later
// A case on stage: what is cut is seen to be cut, and a recording shows each of its times.
#include "render/stage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/png.h"
#include "device/hand_path.h"
#include "picture/image.h"
#include "render_scene.h"
#include "scratch_folder.h"

namespace trephine::drawing {
namespace {

class RenderStage : public Picture {
 protected:
  void SetUp() override {
    Picture::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    case_samples::play_case().write(folder_ / "case");
  }

  session::SessionOptions hole() const {
    session::SessionOptions o;
    o.case_folder = folder_ / "case";
    o.servo.paced = false;
    o.tool.tool = "ball";
    o.drilling.drill = true;
    o.drilling.incision_radius_mm = 15;
    o.seconds = 12;
    device::HandPathParams path;
    path.hole_diameter_mm = 8;
    path.approach_mm = 7;  // above the scalp, which its incision removes
    AnyParams params = AnyParams::make<device::HandPathParams>();
    params.as<device::HandPathParams>() = path;
    o.device.params = {params};
    o.record = folder_ / "hole.servo";
    return o;
  }
  void record() const {
    std::atomic<bool> stop{false};
    session::Session session(hole(), stop, [](const texts::Note&) {});
    session.start();
    const session::SessionResult r = session.finish();
    ASSERT_TRUE(r.outcome);
    ASSERT_GT(r.outcome->removed_mm3.at("skull"), 20);
    ASSERT_GT(r.outcome->removed_mm3.at("scalp"), 20);
  }
  ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path();
};

trephine::scene::Picture shot(render::Stage& stage, const scene::OrbitCamera& camera) {
  render::OffscreenPicture out(width, height);
  stage.draw(camera, width, height, [&](render::Eye) { out.bind(); });
  return out.read();
}

int different(const trephine::scene::Picture& a, const trephine::scene::Picture& b, int by = 0) {
  int n = 0;
  for (std::size_t p = 0; p < a.rgb.size(); p += 3) {
    int most = 0;
    for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(int(a.rgb[p + c]) - int(b.rgb[p + c])));
    n += most > by;
  }
  return n;
}

scene::ViewParams plain_view() {
  scene::ViewParams v;
  v.samples = 1;
  v.places = false;
  return v;
}

// After each step the picture of the bricks that followed is that of a stage made anew, whoever made them.
TEST_F(RenderStage, WhatFollowsTheDrillIsWhatIsMadeAnew) {
  record();
  for (const auto by : {scene::ViewParams::SurfaceBy::processor, scene::ViewParams::SurfaceBy::graphics}) {
    session::Playback playback(folder_ / "case", folder_ / "hole.servo", {}, {});
    scene::ViewParams view = plain_view();
    view.surface_by = by;
    render::Stage stage(playback.loaded(), view);
    EXPECT_EQ(stage.surfaces_by(),
              by == scene::ViewParams::SurfaceBy::graphics ? "the graphics card" : "the processor");
    const scene::OrbitCamera camera = scene::camera_of(plain_view(), playback.loaded().manifest, stage.scene());
    stage.state.opacity = scene::opacities_of(stage.scene(), "scalp=0");
    const trephine::scene::Picture whole = shot(stage, camera);
    std::size_t made = 0;
    for (const double t : {3.0, 6.0, 9.0, 12.0, 5.0}) {
      playback.go_to(t);
      made += stage.follow(playback.marks());
      const trephine::scene::Picture now = shot(stage, camera);
      render::Stage anew(playback.loaded(), plain_view());
      anew.state.opacity = stage.state.opacity;
      EXPECT_EQ(different(now, shot(anew, camera), 1), 0) << t;
    }
    EXPECT_GT(made, 10u);
    EXPECT_GT(different(shot(stage, camera), whole), 300);  // there is a hole
    playback.go_to(0);
    stage.follow(playback.marks());
    EXPECT_EQ(different(shot(stage, camera), whole, 1), 0);  // and at the beginning there is none
  }
}

// The voxels at a time are those of a replay up to it, whichever way one came there.
TEST_F(RenderStage, ARecordingHasTheVoxelsOfEachOfItsTimes) {
  record();
  session::Playback playback(folder_ / "case", folder_ / "hole.servo", {}, {});
  const auto at = [&](double t) {
    playback.go_to(t);
    return haptics::volume_digest(playback.loaded().haptic);
  };
  const std::string begin = at(0), middle = at(6), end = at(1e9);
  EXPECT_EQ(end, playback.header().outcome->volume_sha256);
  EXPECT_NE(begin, middle);
  EXPECT_NE(middle, end);
  EXPECT_EQ(at(6), middle);
  EXPECT_EQ(at(0), begin);
  EXPECT_EQ(at(6), middle);

  // Against a replay of the frames up to the last step of voxels before that time.
  const haptics::Recording recording = haptics::read_recording(folder_ / "hole.servo");
  const haptics::RecordingHeader& h = recording.header;
  session::FeltCase felt = session::felt_again(folder_ / "case", "", h);
  contact::ContactVolume contact(felt.loaded.haptic, h.contact);
  haptics::Proxy proxy(contact, felt.feels, h.force, h.shaft, session::tool_again("", h.tool));
  const auto drilling = felt.drilling_of(h, contact);
  bool met = false;
  for (const haptics::ServoFrame& f : recording.frames) {
    if (f.time_s > 6) break;
    haptics::replay_frames({f}, h.rate_hz, proxy, drilling.get());
    met = met || (f.time_s > 6 - 0.02 && haptics::volume_digest(felt.loaded.haptic) == middle);
  }
  EXPECT_TRUE(met);
}

// What an incision took away shows what lies behind it, with the scalp's wall around.
TEST_F(RenderStage, AnIncisionOpensTheSurfaceAndShowsItsWall) {
  const cases::LoadedCase loaded = cases::load_case(folder_ / "case");
  render::Stage stage(loaded, plain_view());
  scene::OrbitCamera camera = scene::camera_of(plain_view(), loaded.manifest, stage.scene());
  const Vec3 site{1, -20, 340.5};
  const scene::EyeView eye = camera.eye(width, height, stage.scene().bounds);
  const auto colour = [&](const trephine::scene::Picture& p, Vec3 place) {
    const Vec3 px = eye.project(place, width, height);
    const std::size_t n = std::size_t(int(px.y) * width + int(px.x)) * 3;
    return Vec3{double(p.rgb[n]), double(p.rgb[n + 1]), double(p.rgb[n + 2])};
  };
  const Vec3 before = colour(shot(stage, camera), site);
  EXPECT_GT(before.x - before.z, 40);  // scalp
  stage.show_incisions({{0, site, 10}}, 1);
  const trephine::scene::Picture cut = shot(stage, camera);
  const Vec3 bone = colour(cut, site - Vec3{0, 0, 5});
  EXPECT_LT(bone.x - bone.z, 60);
  EXPECT_GT(bone.z, before.z);  // paler than scalp
  int wall = 0;                 // redder than any scalp
  for (std::size_t p = 0; p < cut.rgb.size(); p += 3) wall += cut.rgb[p] > 1.7 * cut.rgb[p + 1] && cut.rgb[p] > 60;
  EXPECT_GT(wall, 60);
  stage.show_incisions({}, 0);
  EXPECT_EQ(different(shot(stage, camera), cut) > 100, true);
}

// What an earlier recording cut is there from the begin, as it was felt then, and its incisions have their walls.
TEST_F(RenderStage, EarlierRecordingsAreRunAsTheyWereFelt) {
  session::SessionOptions o = hole();
  o.tool.tool = "burr";
  o.tool.tool_diameter_mm = 5;
  o.contact.surface = contact::ContactParams::Surface::nearest;
  o.drilling.stall_force_n = 0.8;  // what is cut depends on the force
  o.seconds = 6;
  const std::atomic<bool> stop{false};
  const auto run = [&](const session::SessionOptions& options, std::shared_ptr<session::Patient> patient) {
    session::Session session(
        options, stop, [](const texts::Note&) {}, std::move(patient));
    session.start();
    return session.finish();
  };
  const session::SessionResult first = run(o, nullptr);
  const haptics::Recording recording = haptics::read_recording(o.record);
  const auto after = [&](const contact::ContactParams& felt) {
    haptics::RecordingHeader h = recording.header;
    h.contact = felt;
    session::FeltCase again = session::felt_again(folder_ / "case", "", h);
    contact::ContactVolume contact(again.loaded.haptic, felt);
    session::Rerun(again, contact, "", h).run(recording.frames);
    return haptics::volume_digest(again.loaded.haptic);
  };
  ASSERT_EQ(after(recording.header.contact), first.outcome->volume_sha256);
  ASSERT_NE(after({}), first.outcome->volume_sha256) << "how it is felt matters";

  session::SessionOptions next = hole();
  next.tool.tool = "point";
  next.drilling.drill = false;
  next.seconds = 0.3;
  next.record = folder_ / "next.servo";
  const auto patient = session::patient_again(folder_ / "case", "", recording.header, next.contact, {o.record});
  EXPECT_EQ(haptics::volume_digest(patient->felt.loaded.haptic), first.outcome->volume_sha256);
  next.begins_sha256 = first.outcome->volume_sha256;
  run(next, patient);

  session::Playback playback(folder_ / "case", next.record, {o.record}, {});
  ASSERT_EQ(playback.incisions().size(), 1u);
  const auto reddish = [&](const grid::Grid<std::int16_t>* uncut) {
    render::Stage stage(playback.loaded(), plain_view(), uncut);
    stage.show_incisions(playback.incisions(), 1);
    const trephine::scene::Picture p =
        shot(stage, scene::camera_of(plain_view(), playback.loaded().manifest, stage.scene()));
    int wall = 0;
    for (std::size_t n = 0; n < p.rgb.size(); n += 3) wall += p.rgb[n] > 1.7 * p.rgb[n + 1] && p.rgb[n] > 60;
    return wall;
  };
  ASSERT_TRUE(playback.patient()->uncut);
  // In what is cut there is no wall; what else is as red is the same.
  EXPECT_GT(reddish(playback.patient()->uncut.get()), reddish(nullptr) + 60);
}

// Asking what is hidden saves triangles and changes no pixel.
TEST_F(RenderStage, WhatIsNotDrawnCouldNotBeSeen) {
  const cases::LoadedCase loaded = cases::load_case(folder_ / "case");
  scene::ViewParams view = plain_view();
  for (const scene::ViewPreset preset :
       {scene::ViewPreset::surgeon, scene::ViewPreset::left, scene::ViewPreset::oblique}) {
    view.view = preset;
    render::Stage stage(loaded, view);
    scene::OrbitCamera camera = scene::camera_of(view, loaded.manifest, stage.scene());
    camera.zoom(preset == scene::ViewPreset::left ? 0.3 : 1);
    stage.show_incisions({{0, {1, -20, 340.5}, 10}}, 1);
    render::RenderQuality quality{1, true, 9, true, true};
    stage.renderer().set_quality(quality);
    const trephine::scene::Picture asked = shot(stage, camera);
    const std::size_t few = stage.renderer().drawn_triangles();
    quality.ask_hidden = false;
    stage.renderer().set_quality(quality);
    EXPECT_EQ(different(shot(stage, camera), asked), 0);
    EXPECT_LT(few, stage.renderer().drawn_triangles());
  }
}

TEST_F(RenderStage, PicturesAreReadByAnotherProgramsReader) {
  const cases::LoadedCase loaded = cases::load_case(folder_ / "case");
  render::Stage stage(loaded, plain_view());
  const trephine::scene::Picture p = shot(stage, scene::camera_of(plain_view(), loaded.manifest, stage.scene()));
  const picture::Image read = picture::decode_png(png_of(p.width, p.height, 3, p.rgb));
  EXPECT_EQ(read.width, width);
  EXPECT_EQ(read.rgb, p.rgb);
}

TEST_F(RenderStage, WrongOpacitiesAreRefused) {
  const cases::LoadedCase loaded = cases::load_case(folder_ / "case");
  const scene::SceneData scene = scene::scene_of(loaded);
  EXPECT_EQ(scene::opacities_of(scene, "scalp=0.25,brain=0"), (std::vector<double>{0.25, 1, 0}));
  for (const char* text : {"scalp", "scalp=", "scalp=2", "scalp=nan", "hair=1", "scalp=0.5x"})
    EXPECT_THROW(scene::opacities_of(scene, text), Error) << text;
}

}  // namespace
}  // namespace trephine::drawing

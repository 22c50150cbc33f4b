// SPDX-License-Identifier: GPL-3.0-or-later
// A case on stage: what is cut is seen to be cut, and a recording shows each of its times.
#include "render/stage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

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

  SessionOptions hole() const {
    SessionOptions o;
    o.case_folder = folder_ / "case";
    o.servo.paced = false;
    o.tool.tool = "ball";
    o.drilling.drill = true;
    o.drilling.incision_radius_mm = 15;
    o.seconds = 12;
    HandPathParams path;
    path.hole_diameter_mm = 8;
    path.approach_mm = 7;  // above the scalp, which its incision removes
    AnyParams params = AnyParams::make<HandPathParams>();
    params.as<HandPathParams>() = path;
    o.device.params = {params};
    o.record = folder_ / "hole.servo";
    return o;
  }
  void record() const {
    std::atomic<bool> stop{false};
    Session session(hole(), stop, [](const Note&) {});
    session.start();
    const SessionResult r = session.finish();
    ASSERT_TRUE(r.outcome);
    ASSERT_GT(r.outcome->removed_mm3.at("skull"), 20);
    ASSERT_GT(r.outcome->removed_mm3.at("scalp"), 20);
  }
  ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path();
};

trephine::Picture shot(Stage& stage, const OrbitCamera& camera) {
  OffscreenPicture out(width, height);
  stage.draw(camera, width, height, [&](Eye) { out.bind(); });
  return out.read();
}

int different(const trephine::Picture& a, const trephine::Picture& b, int by = 0) {
  int n = 0;
  for (std::size_t p = 0; p < a.rgb.size(); p += 3) {
    int most = 0;
    for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(int(a.rgb[p + c]) - int(b.rgb[p + c])));
    n += most > by;
  }
  return n;
}

ViewParams plain_view() {
  ViewParams v;
  v.samples = 1;
  v.places = false;
  return v;
}

// After each step the picture of the bricks that followed is that of a stage made anew, whoever made them.
TEST_F(RenderStage, WhatFollowsTheDrillIsWhatIsMadeAnew) {
  record();
  for (const auto by : {ViewParams::SurfaceBy::processor, ViewParams::SurfaceBy::graphics}) {
    Playback playback(folder_ / "case", folder_ / "hole.servo", {}, {});
    ViewParams view = plain_view();
    view.surface_by = by;
    Stage stage(playback.loaded(), view);
    EXPECT_EQ(stage.surfaces_by(), by == ViewParams::SurfaceBy::graphics ? "the graphics card" : "the processor");
    const OrbitCamera camera = camera_of(plain_view(), playback.loaded().manifest, stage.scene());
    stage.state.opacity = opacities_of(stage.scene(), "scalp=0");
    const trephine::Picture whole = shot(stage, camera);
    std::size_t made = 0;
    for (const double t : {3.0, 6.0, 9.0, 12.0, 5.0}) {
      playback.go_to(t);
      made += stage.follow(playback.marks());
      const trephine::Picture now = shot(stage, camera);
      Stage anew(playback.loaded(), plain_view());
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
  Playback playback(folder_ / "case", folder_ / "hole.servo", {}, {});
  const auto at = [&](double t) {
    playback.go_to(t);
    return volume_digest(playback.loaded().haptic);
  };
  const std::string begin = at(0), middle = at(6), end = at(1e9);
  EXPECT_EQ(end, playback.header().outcome->volume_sha256);
  EXPECT_NE(begin, middle);
  EXPECT_NE(middle, end);
  EXPECT_EQ(at(6), middle);
  EXPECT_EQ(at(0), begin);
  EXPECT_EQ(at(6), middle);

  // Against a replay of the frames up to the last step of voxels before that time.
  const Recording recording = read_recording(folder_ / "hole.servo");
  const RecordingHeader& h = recording.header;
  FeltCase felt = felt_again(folder_ / "case", "", h);
  ContactVolume contact(felt.loaded.haptic, h.contact);
  Proxy proxy(contact, felt.feels, h.force, h.shaft, tool_again("", h.tool));
  const auto drilling = felt.drilling_of(h, contact);
  bool met = false;
  for (const ServoFrame& f : recording.frames) {
    if (f.time_s > 6) break;
    replay_frames({f}, h.rate_hz, proxy, drilling.get());
    met = met || (f.time_s > 6 - 0.02 && volume_digest(felt.loaded.haptic) == middle);
  }
  EXPECT_TRUE(met);
}

// What an incision took away shows what lies behind it, with the scalp's wall around.
TEST_F(RenderStage, AnIncisionOpensTheSurfaceAndShowsItsWall) {
  const LoadedCase loaded = load_case(folder_ / "case");
  Stage stage(loaded, plain_view());
  OrbitCamera camera = camera_of(plain_view(), loaded.manifest, stage.scene());
  const Vec3 site{1, -20, 340.5};
  const EyeView eye = camera.eye(width, height, stage.scene().bounds);
  const auto colour = [&](const trephine::Picture& p, Vec3 place) {
    const Vec3 px = eye.project(place, width, height);
    const std::size_t n = std::size_t(int(px.y) * width + int(px.x)) * 3;
    return Vec3{double(p.rgb[n]), double(p.rgb[n + 1]), double(p.rgb[n + 2])};
  };
  const Vec3 before = colour(shot(stage, camera), site);
  EXPECT_GT(before.x - before.z, 40);  // scalp
  stage.show_incisions({{0, site, 10}}, 1);
  const trephine::Picture cut = shot(stage, camera);
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
  SessionOptions o = hole();
  o.tool.tool = "burr";
  o.tool.tool_diameter_mm = 5;
  o.contact.surface = ContactParams::Surface::nearest;
  o.drilling.clearance_voxels = 0;
  o.drilling.stall_force_n = 0.8;  // what is cut depends on the force
  o.seconds = 6;
  const std::atomic<bool> stop{false};
  const auto run = [&](const SessionOptions& options, std::shared_ptr<Patient> patient) {
    Session session(
        options, stop, [](const Note&) {}, std::move(patient));
    session.start();
    return session.finish();
  };
  const SessionResult first = run(o, nullptr);
  const Recording recording = read_recording(o.record);
  const auto after = [&](const ContactParams& felt) {
    RecordingHeader h = recording.header;
    h.contact = felt;
    FeltCase again = felt_again(folder_ / "case", "", h);
    ContactVolume contact(again.loaded.haptic, felt);
    Rerun(again, contact, "", h).run(recording.frames);
    return volume_digest(again.loaded.haptic);
  };
  ASSERT_EQ(after(recording.header.contact), first.outcome->volume_sha256);
  ASSERT_NE(after({}), first.outcome->volume_sha256) << "how it is felt matters";

  SessionOptions next = hole();
  next.tool.tool = "point";
  next.drilling.drill = false;
  next.seconds = 0.3;
  next.record = folder_ / "next.servo";
  const auto patient = patient_again(folder_ / "case", "", recording.header, next.contact, {o.record});
  EXPECT_EQ(volume_digest(patient->felt.loaded.haptic), first.outcome->volume_sha256);
  next.begins_sha256 = first.outcome->volume_sha256;
  run(next, patient);

  Playback playback(folder_ / "case", next.record, {o.record}, {});
  ASSERT_EQ(playback.incisions().size(), 1u);
  const auto reddish = [&](const Grid<std::int16_t>* uncut) {
    Stage stage(playback.loaded(), plain_view(), uncut);
    stage.show_incisions(playback.incisions(), 1);
    const trephine::Picture p = shot(stage, camera_of(plain_view(), playback.loaded().manifest, stage.scene()));
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
  const LoadedCase loaded = load_case(folder_ / "case");
  ViewParams view = plain_view();
  for (const ViewPreset preset : {ViewPreset::surgeon, ViewPreset::left, ViewPreset::oblique}) {
    view.view = preset;
    Stage stage(loaded, view);
    OrbitCamera camera = camera_of(view, loaded.manifest, stage.scene());
    camera.zoom(preset == ViewPreset::left ? 0.3 : 1);
    stage.show_incisions({{0, {1, -20, 340.5}, 10}}, 1);
    RenderQuality quality{1, true, 9, true, true};
    stage.renderer().set_quality(quality);
    const trephine::Picture asked = shot(stage, camera);
    const std::size_t few = stage.renderer().drawn_triangles();
    quality.ask_hidden = false;
    stage.renderer().set_quality(quality);
    EXPECT_EQ(different(shot(stage, camera), asked), 0);
    EXPECT_LT(few, stage.renderer().drawn_triangles());
  }
}

TEST_F(RenderStage, PicturesAreReadByAnotherProgramsReader) {
  const LoadedCase loaded = load_case(folder_ / "case");
  Stage stage(loaded, plain_view());
  const trephine::Picture p = shot(stage, camera_of(plain_view(), loaded.manifest, stage.scene()));
  const Image read = decode_png(png_of(p));
  EXPECT_EQ(read.width, width);
  EXPECT_EQ(read.rgb, p.rgb);
}

TEST_F(RenderStage, WrongOpacitiesAreRefused) {
  const LoadedCase loaded = load_case(folder_ / "case");
  const SceneData scene = scene_of(loaded);
  EXPECT_EQ(opacities_of(scene, "scalp=0.25,brain=0"), (std::vector<double>{0.25, 1, 0}));
  for (const char* text : {"scalp", "scalp=", "scalp=2", "scalp=nan", "hair=1", "scalp=0.5x"})
    EXPECT_THROW(opacities_of(scene, text), Error) << text;
}

}  // namespace
}  // namespace trephine::drawing

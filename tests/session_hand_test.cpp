// SPDX-License-Identifier: GPL-3.0-or-later
// What frames say of the hand is what the belt does, tick by tick.
#include "session/hand_watch.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "haptics/burrs.h"
#include "haptics/tool_belt.h"
#include "haptics_tools.h"
#include "session/force_figures.h"
#include "session/playback.h"
#include "session/recording_text.h"

using namespace trephine;
using namespace trephine::tools;
using walls::uniform;

namespace {

namespace to = haptics::belt_command;

haptics::BeltToolParams belt_tool(const char* kind, double mm, bool cuts) {
  haptics::BeltToolParams t;
  static_cast<haptics::ToolParams&>(t) = haptics::own_tool(params_of(kind, mm));
  t.name = kind + std::to_string(int(mm));
  t.blunt = t.cuts = cuts;
  t.marks = !cuts;
  return t;
}

constexpr std::uint32_t command(int number) { return std::uint32_t(number) << haptics::belt_button::command_shift; }
constexpr std::uint32_t asks(std::uint32_t tool) { return tool << haptics::belt_button::tool_shift; }

}  // namespace

// Hands at random above, on and in a block: they ask for tools and give commands wherever they are.
TEST(SessionHand, HoldsWhatTheBeltHolds) {
  int changes = 0, refused = 0, idle = 0, differ = 0, ticks = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    voxel::HapticVolume volume = empty(40, {0.5, 0.5, 0.5});
    fill_wide(volume, 1, [](Vec3 p) { return -p.z; });
    contact::ContactVolume contact(volume);
    drill::DrillShapes shapes;
    shapes[1] = {true, 0.02};
    haptics::RecordingHeader h;
    h.drilling.drill = true;
    h.tools = {belt_tool("ball", 4, true), belt_tool("ball", 6, true), belt_tool("marker", 0, false)};
    std::vector<haptics::Burr> burrs;
    for (const haptics::BeltToolParams& t : h.tools)
      if (t.cuts) burrs.push_back({haptics::cutter_of(h.drilling, t), 8});
    haptics::Drilling drilling(volume, contact, shapes, h.drilling, drill::DrillParams{}, burrs);
    haptics::ToolBelt belt(contact, one_shape(1, face(1, 0.35, 0.3), face(1, 0.35, 0.3)), {}, {}, h.tools, &drilling);
    session::HandWatch watch(h, [&](Vec3 p) { return contact.shape_at(p); });
    std::mt19937_64 rng(seed);
    Vec3 tip{0, 0, 6}, goal = tip;
    std::uint32_t buttons = 0, tool = 0;
    int held = 0;
    for (int n = 0; n < 6000; ++n, ++ticks) {
      if (n % 120 == 0) goal = {uniform(rng, -6, 6), uniform(rng, -6, 6), uniform(rng, -4, 5)};
      if (rng() % 40 == 0) tool = std::uint32_t(rng() % 4);  // the last is no tool
      if (rng() % 60 == 0) buttons ^= haptics::belt_button::pedal;
      if (rng() % 300 == 0) buttons ^= haptics::haptic_button::lifted;
      const int given[] = {to::none, to::none, to::pause, to::resume, to::resume, to::undo, to::reset, to::incise};
      if (n % 25 == 0) buttons = (buttons & ~command(0xff)) | command(given[rng() % 8]);
      tip += (goal - tip) * 0.03;
      haptics::HapticInput in = pose(tip, {0, 0, 1});
      in.buttons = (buttons & ~asks(0xf)) | asks(tool);
      const haptics::HapticState is = belt.update(in);
      // A tick in which voxels are still put back may be one in which the frames' hand waits no longer.
      const bool putting = drilling.putting_back();
      belt.after(in, is);
      haptics::ServoFrame f;
      haptics::put_input(in, f);
      haptics::put_answer(is, f);
      watch.look(f);
      refused += tool < 3 && int(tool) != belt.in_hand();
      changes += belt.in_hand() != held;
      held = belt.in_hand();
      idle += !watch.works();
      differ += !putting && (int(watch.tool()) != belt.in_hand());
      if (::testing::Test::HasFailure()) return;
    }
  }
  std::printf("  %d ticks: %d changes, %d ticks with another tool than was asked for, %d in pauses; %d differ\n", ticks,
              changes, refused, idle, differ);
  EXPECT_GT(changes, 100);
  EXPECT_GT(refused, 1000);
  EXPECT_GT(idle, 1000);
  EXPECT_EQ(differ, 0);
}

// A marker that is asked for while the burr touches marks nothing.
TEST(SessionHand, AnIncisionIsWhereTheMarkerInHandWas) {
  haptics::RecordingHeader h;
  h.drilling.drill = true;
  h.tools = {belt_tool("ball", 4, true), belt_tool("marker", 0, false)};
  const auto marks = [&](int touched_when_asked) {
    session::IncisionWatch watch(h);
    std::vector<session::IncisionMark> out;
    const auto tick = [&](std::uint32_t buttons, int touched) {
      haptics::ServoFrame f;
      f.buttons = buttons;
      f.touched = touched;
      watch.look(f, out);
    };
    tick(0, touched_when_asked);
    tick(asks(1), touched_when_asked);
    tick(asks(1) | haptics::belt_button::pedal, 1);
    tick(asks(1) | command(to::incise), 1);
    return out.size();
  };
  EXPECT_EQ(marks(1), 0u);
  EXPECT_EQ(marks(0), 1u);
}

// Another burr that is asked for while the one in hand touches is taken once it is free; a table and a plot of the
// recording name what was in the hand.
TEST(SessionHand, ExportsNameTheToolInHand) {
  haptics::Recording r;
  r.header.tools = {belt_tool("ball", 4, true), belt_tool("ball", 6, true)};
  const int touched[] = {0, 1, 1, 0, 0, 0}, asked[] = {0, 0, 1, 1, 1, 1};
  const char* in_hand[] = {"ball4", "ball4", "ball4", "ball4", "ball6", "ball6"};
  const auto add = [&](int tool, int touches) {
    haptics::ServoFrame f;
    f.tick = r.frames.size();
    f.dt_s = 0.001;
    f.time_s = 0.001 * double(r.frames.size() + 1);
    f.axis[2] = 1;
    f.buttons = asks(std::uint32_t(tool));
    f.touched = touches;
    r.frames.push_back(f);
  };
  for (int n = 0; n < 6; ++n) add(asked[n], touched[n]);
  const auto file = std::filesystem::temp_directory_path() / ("hand-" + std::to_string(getpid()) + ".csv");
  const auto tools_of = [&](int every) {
    FileWriter out(file);
    session::RecordingTextParams params;
    params.every_count = every;
    session::write_recording_csv(r, params, out);
    out.commit();
    std::ifstream in(file);
    std::vector<std::string> names;
    std::string line, cell;
    std::size_t column = 0;
    const auto columns = session::recording_columns(r.header);
    while (column < columns.size() && columns[column].first != "tool") ++column;
    std::getline(in, line);
    while (std::getline(in, line)) {
      std::istringstream cells(line);
      for (std::size_t n = 0; n <= column; ++n) std::getline(cells, cell, ',');
      names.push_back(cell);
    }
    return names;
  };
  EXPECT_EQ(tools_of(1), std::vector<std::string>(in_hand, in_hand + 6));
  EXPECT_EQ(tools_of(4), (std::vector<std::string>{"ball4", "ball6"}));
  std::filesystem::remove(file);
  EXPECT_NE(session::recording_plot(r).find("ball6"), std::string::npos);
  r.frames.resize(4);
  EXPECT_EQ(session::recording_plot(r).find("ball6"), std::string::npos) << "which was never in the hand";
}

// The two ticks about a jump of the force are anomalies, and the plot has them on the path.
TEST(SessionHand, AnomaliesOfTheForceAreOnThePath) {
  haptics::Recording r;
  for (int n = 0; n < 3000; ++n) {
    haptics::ServoFrame f;
    f.tick = std::uint64_t(n);
    f.time_s = 0.001 * (n + 1);
    f.dt_s = 0.001;
    f.touched = 1;
    f.tip_mm[0] = 0.01 * n;
    f.force_n[2] = 1 + 0.01 * std::sin(0.02 * n) + (n >= 2000 ? 0.5 : 0);
    r.frames.push_back(f);
  }
  EXPECT_EQ(session::force_anomalies(r.frames, session::force_window(r.frames)),
            (std::vector<std::size_t>{1999, 2000}));
  const std::string plot = session::recording_plot(r);
  EXPECT_NE(plot.find("$anomalies << END\n2.000000 19.99 0 0\n"), std::string::npos) << plot.substr(0, 200);
  EXPECT_NE(plot.find("anomaly of the force"), std::string::npos);
  for (haptics::ServoFrame& f : r.frames) f.force_n[2] = 1;
  EXPECT_EQ(session::recording_plot(r).find("anomal"), std::string::npos) << "there are none";
}

// A hand that comes back from a pause within a shape waits there, and its commands do nothing; what was cut before says
// whether it is within.
TEST(SessionHand, WaitsWhereTheVolumeSaysSo) {
  haptics::RecordingHeader h;
  h.drilling.drill = true;
  h.tools = {belt_tool("marker", 0, false)};
  const auto marks = [&](const session::HandWatch::ShapeAt& shape_at) {
    session::IncisionWatch watch(h, shape_at);
    std::vector<session::IncisionMark> out;
    const auto tick = [&](std::uint32_t buttons, double z, int touched = 0) {
      haptics::ServoFrame f;
      f.buttons = buttons;
      f.tip_mm[2] = z;
      f.touched = touched;
      watch.look(f, out);
    };
    tick(0, 1);
    tick(haptics::belt_button::pedal, 0, 1);
    tick(0, 1);
    tick(command(to::pause), 1);
    tick(command(to::resume), -1);
    tick(0, -1);
    tick(command(to::incise), -1);
    return out.size();
  };
  EXPECT_EQ(marks([](Vec3 p) { return p.z < 0 ? 1 : 0; }), 0u);
  EXPECT_EQ(marks([](Vec3) { return 0; }), 1u);
  EXPECT_EQ(marks({}), 1u) << "which frames alone cannot tell";
}

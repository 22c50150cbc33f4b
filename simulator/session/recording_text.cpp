// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/recording_text.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "json/declared_json.h"
#include "session/hand_watch.h"

namespace trephine::session {
namespace {

using haptics::Recording;
using haptics::RecordingHeader;
using haptics::ServoFrame;
namespace belt_button = haptics::belt_button;
namespace belt_command = haptics::belt_command;

double length_of(const double (&v)[3]) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

template <std::size_t N>
std::string names_of(std::uint32_t bits, const char* const (&names)[N]) {
  std::string out;
  for (std::size_t bit = 0; bit < N; ++bit)
    if (bits & 1u << bit) out += (out.empty() ? "" : "+") + std::string(names[bit]);
  return out;
}

// A frame's cells: numbers, and texts, which JSON quotes.
class Cells {
 public:
  Cells(std::string& out, bool json) : out_(out), json_(json) {}
  void number(double v) {
    next();
    out_ += std::isfinite(v) ? to_text(v) : json_ ? "null" : "";
  }
  void whole(long long v) {
    next();
    out_ += std::to_string(v);
  }
  void numbers(const double (&v)[3]) {
    for (const double x : v) number(x);
  }
  void text(const std::string& s) {
    next();
    out_ += json_ ? nlohmann::json(s).dump() : s;
  }

 private:
  void next() {
    if (!first_) out_ += ',';
    first_ = false;
  }
  std::string& out_;
  bool json_, first_ = true;
};

// What the frame and those before it that were passed over say together.
struct Row {
  ServoFrame frame;
  const ServoFrame* second;  // of the other hand; null where there was one
  std::uint32_t command;
  std::size_t tool;  // in hand
};

void add_row(const Row& row, const RecordingHeader& h, Cells cells) {
  const ServoFrame& f = row.frame;
  cells.whole((long long)f.tick);
  cells.number(f.time_s);
  cells.number(f.dt_s);
  cells.numbers(f.tip_mm);
  cells.numbers(f.axis);
  cells.numbers(f.proxy_mm);
  cells.numbers(f.normal);
  cells.numbers(f.force_n);
  cells.number(length_of(f.force_n));
  for (const std::int32_t v : {f.touched, f.face, f.inside, f.held_by}) cells.whole(v);
  cells.whole(f.buttons & belt_button::pedal);
  if (h.tools.empty()) {
    cells.text(h.tool.tool);
    cells.text("");
  } else {
    cells.text(h.tools[row.tool].name);
    const int command = int(row.command);
    cells.text(belt_command::is_answer(command) ? "answer " + std::to_string(belt_command::question_of(command)) + " " +
                                                      std::to_string(belt_command::choice_of(command))
               : command > 0 && command < belt_command::count ? belt_command::names[command]
                                                              : "");
  }
  cells.whole((f.buttons & haptics::haptic_button::lifted) ? 1 : 0);
  cells.whole(f.buttons);
  cells.text(names_of(f.events, haptics::haptic_event::names));
  cells.text(names_of(f.faults, haptics::haptic_fault::names));
  cells.whole(f.late_us);
  if (h.knows_across) cells.numbers(f.across);
  if (!row.second) return;
  const ServoFrame& s = *row.second;
  cells.numbers(s.tip_mm);
  cells.numbers(s.axis);
  cells.numbers(s.proxy_mm);
  cells.numbers(s.normal);
  cells.numbers(s.force_n);
  cells.number(length_of(s.force_n));
  for (const std::int32_t v : {s.touched, s.face, s.inside, s.held_by}) cells.whole(v);
  cells.whole(s.buttons & belt_button::pedal);
  cells.whole(s.buttons);
  cells.text(names_of(s.events, haptics::haptic_event::names));
  cells.text(names_of(s.faults, haptics::haptic_fault::names));
  if (h.knows_across) cells.numbers(s.across);
}

// Calls for each frame that is taken, with what happened in those before it.
template <class F>
void each_frame(const Recording& r, int every, const F& call) {
  std::uint32_t events = 0, faults = 0, command = 0, late = 0, second_events = 0, second_faults = 0;
  HandWatch hand(r.header);
  for (std::size_t n = 0; n < r.frames.size(); ++n) {
    const ServoFrame& f = r.frames[n];
    hand.look(f);
    events |= f.events;
    faults |= f.faults;
    late = std::max(late, f.late_us);
    if (!r.second.empty()) {
      second_events |= r.second[n].events;
      second_faults |= r.second[n].faults;
    }
    if (const int c = belt_button::command(f.buttons); c != 0) command = std::uint32_t(c);
    if ((n + 1) % std::size_t(every) != 0 && n + 1 != r.frames.size()) continue;
    ServoFrame taken = f;
    taken.events = events;
    taken.faults = faults;
    taken.late_us = late;
    ServoFrame second = r.second.empty() ? ServoFrame() : r.second[n];
    second.events = second_events;
    second.faults = second_faults;
    call(Row{taken, r.second.empty() ? nullptr : &second, command, hand.tool()});
    events = faults = command = late = second_events = second_faults = 0;
  }
}

}  // namespace

std::vector<std::pair<std::string, std::string>> recording_columns(const RecordingHeader& header) {
  std::vector<std::pair<std::string, std::string>> c = {
      {"tick", "from 0"}, {"time_s", "at the tick's end"}, {"dt_s", "the tick's step"}};
  const auto three = [&](const std::string& name, const std::string& unit, const std::string& help) {
    for (const char* axis : {"x", "y", "z"}) c.emplace_back(name + "_" + axis + unit, help);
  };
  three("tip", "_mm", "the device");
  three("axis", "", "unit, from the tool's tip to its tail");
  three("proxy", "_mm", "where the tool's tip is shown");
  three("normal", "", "of the surface that presses most; zero without contact");
  three("force", "_n", "on the hand");
  c.insert(c.end(), {{"force_n", "its size"},
                     {"touched", "number of the shape, 0 without contact (case.json lists the shapes)"},
                     {"face", "1 front, 2 back, 0 without contact"},
                     {"inside", "number of the shape that the proxy is in, 0 for none"},
                     {"held_by", "how many surfaces press"},
                     {"pedal", "1 while it is down"},
                     {"tool", "in the hand, which takes another one in the open alone"},
                     {"command", "of a lesson, in the tick that has it"},
                     {"lifted", "1 where the tool was taken away in this tick"},
                     {"buttons", "all bits, as docs/reference/recordings.md has them"},
                     {"events", "with + between them"},
                     {"faults", "with + between them"},
                     {"late_us", "how late the tick woke"}});
  if (header.knows_across) three("across", "", "unit, turns with the tool about its axis");
  if (!header.second) return c;
  three("second_tip", "_mm", "the other hand's device");
  three("second_axis", "", "unit, from its tool's tip to its tail");
  three("second_proxy", "_mm", "where its tool's tip is shown");
  three("second_normal", "", "of the surface that presses most on its tool");
  three("second_force", "_n", "on the other hand");
  c.insert(c.end(), {{"second_force_n", "its size"},
                     {"second_touched", "number of the shape that its tool touches, 0 without contact"},
                     {"second_face", "1 front, 2 back, 0 without contact"},
                     {"second_inside", "number of the shape that its proxy is in, 0 for none"},
                     {"second_held_by", "how many surfaces press on its tool"},
                     {"second_pedal", "1 while its switch is down"},
                     {"second_buttons", "all its bits"},
                     {"second_events", "with + between them"},
                     {"second_faults", "with + between them"}});
  if (header.knows_across) three("second_across", "", "unit, turns with its tool about its axis");
  return c;
}

void write_recording_csv(const Recording& recording, const RecordingTextParams& params, FileWriter& out) {
  std::string text;
  for (const auto& [name, help] : recording_columns(recording.header)) text += (text.empty() ? "" : ",") + name;
  text += '\n';
  each_frame(recording, params.every_count, [&](const Row& row) {
    add_row(row, recording.header, Cells(text, false));
    text += '\n';
    if (text.size() < (1u << 20)) return;
    out.write(text);
    text.clear();
  });
  out.write(text);
}

void write_recording_json(const Recording& recording, const RecordingTextParams& params, FileWriter& out) {
  using Json = nlohmann::ordered_json;
  Json columns = Json::array();
  for (const auto& [name, help] : recording_columns(recording.header))
    columns.push_back({{"name", name}, {"help", help}});
  std::string text = "{\"trephine_recording_text\": 1,\n\"seal\": \"" + std::string(haptics::name_of(recording.seal)) +
                     "\",\n\"frames_missing\": " + std::to_string(haptics::missing_frames(recording.frames)) +
                     ",\n\"header\": ";
  RecordingHeader header = recording.header;
  text += json::declared_json(parameters_of<RecordingHeader>(), &header);
  text += ",\n\"columns\": " + columns.dump(1) + ",\n\"frames\": [\n";
  bool first = true;
  each_frame(recording, params.every_count, [&](const Row& row) {
    text += first ? "[" : ",\n[";
    first = false;
    add_row(row, recording.header, Cells(text, true));
    text += ']';
    if (text.size() < (1u << 20)) return;
    out.write(text);
    text.clear();
  });
  out.write(text + "\n]}\n");
}

}  // namespace trephine::session

// SPDX-License-Identifier: GPL-3.0-or-later
// All that a user can do. An entry here is all that a new action needs.
#include "window/actions.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cmath>
#include <tuple>

#include "base/error.h"
#include "window/action_entries.h"
#include "window/action_replies.h"
#include "window/action_when.h"
#include "window/texts.h"

namespace trephine::window {
namespace {

using How = KeyUse::How;
using Group = Action::Group;

constexpr const char *nearer = "0.9", *farther = "1.1111111111111112";
constexpr double orbit_rad_per_px = 0.006, max_head_mm = 1e5;

double rad(double deg) { return deg * M_PI / 180; }

// The four arrows, with what is held beside them.
void add_arrows(Action& a, KeyUse::With with) {
  for (const auto& [key, x, y] : {std::tuple<int, double, double>{GLFW_KEY_LEFT, -1, 0},
                                  {GLFW_KEY_RIGHT, 1, 0},
                                  {GLFW_KEY_UP, 0, 1},
                                  {GLFW_KEY_DOWN, 0, -1}})
    a.keys.push_back({key, How::held, "", "", x, y, with});
}

// As far as the cursor went, at the tool's depth; or as long as a key is held.
void follow_cursor(Player& p, const Screen& s, const Gesture& g) {
  if (!p.live() || !p.live()->hand.by_screen()) return;
  if (g.seconds > 0) {
    const double mm = s.hand.move_mm_per_s * g.seconds;
    const bool pedal = p.lesson() ? p.lesson()->pedal() : p.live()->hand.pressed(haptics::Drilling::pedal);
    p.live()->hand.move_in_picture(g.x * mm, g.y * mm, s.cursor, pedal && p.live()->draws());
    return;
  }
  const scene::EyeView eye = p.view().eye(s.cursor);
  const double* at = p.view().frame().tip_mm;
  const double depth = -dot(Vec3{at[0], at[1], at[2]} - eye.eye_mm, eye.toward);
  if (depth > 1)
    p.live()->hand.move(eye.right * (g.x * depth * (eye.right_edge - eye.left) / s.cursor.width) -
                        eye.up * (g.y * depth * (eye.top - eye.bottom) / s.cursor.height));
}

void advance(Player& p, const Screen& s, const Gesture& g) {
  if (p.live()) p.live()->hand.advance(g.y * (g.seconds > 0 ? s.hand.advance_mm_per_s * g.seconds : s.hand.wheel_mm));
}

void tilt(Player& p, const Screen& s, const Gesture& g) {
  const double turn = rad(s.hand.turn_deg_per_s) * g.seconds;
  if (p.live()) p.live()->hand.turn(g.x * turn, g.y * turn);
}

// What is done with the hand, where somebody is at work.
std::function<Reply(Player&, Screen&, Words&)> hand_does(texts::Answer (*what)(Hand&, Screen&, Words&)) {
  return [what](Player& p, Screen& s, Words& w) { return p.live() ? Reply(what(p.live()->hand, s, w)) : Reply(); };
}

std::vector<std::string> view_names(const Player&) {
  std::vector<std::string> names;
  for (const auto& [name, value] : scene::view_presets()) names.push_back(name);
  return names;
}

void hand_actions(Entries e) {
  e.add("move", "X Y Z",
        {{"moves the tool in the picture's plane (X Y Z: by that way, in mm)",
          "bewegt das Instrument in der Bildebene"}});
  e->keys = {{mouse::move, How::drag}};
  add_arrows(*e.operator->(), KeyUse::With::shift);
  e->during = follow_cursor;
  e->run =
      hand_does([](Hand& hand, Screen&, Words& w) -> texts::Answer { return hand.move(w.point()), texts::Answer(); });
  e.add("", "", {{"along the tool, forwards and back", "längs des Instruments, vor und zurück"}});
  e->keys = {{mouse::wheel, How::drag}, {GLFW_KEY_W, How::held, "", "", 0, 1}, {GLFW_KEY_S, How::held, "", "", 0, -1}};
  e->during = advance;
  e.add("pedal", "on|off",
        {{"the drill's pedal; X-rays, where there is a C-arm",
          "Pedal des Bohrers; Strahlung, wo es einen C-Bogen gibt"}});
  e->keys = {{mouse::left, How::press, "on", "off"}, {GLFW_KEY_SPACE, How::press, "on", "off"}};
  e->run = does([](Player& p, Words& w) {
    const bool down = w.on(false);
    if (p.live()) p.live()->set_pedal(down);
  });
  e.add("", "", {{"with the marker: draws on what is under the cursor", "mit dem Stift: zeichnet unter dem Zeiger"}},
        with_marker);
  e->keys = {{mouse::left, How::held}};
  e->during = [](Player& p, const Screen& s, const Gesture&) { p.live()->hand.draw_at(s.cursor); };
  e.add("orbit", "RIGHT UP", {{"turns the view (RIGHT UP: by so many degrees)", "dreht die Ansicht"}});
  e->keys = {{mouse::right, How::drag}};
  add_arrows(*e.operator->(), KeyUse::With::control);
  e->during = [](Player& p, const Screen& s, const Gesture& g) {
    const double each = g.seconds > 0 ? rad(s.hand.turn_deg_per_s) * g.seconds : orbit_rad_per_px;
    p.view().camera.orbit(g.x * each, (g.seconds > 0 ? -g.y : g.y) * each);
  };
  e->run = does([](Player& p, Words& w) {
    const double right = w.number(), up = w.number();
    p.view().camera.orbit(rad(right), rad(up));
  });
  e.add("", "", {{"shifts the view", "verschiebt die Ansicht"}});
  e->keys = {{mouse::middle, How::drag}};
  e->during = [](Player& p, const Screen& s, const Gesture& g) {
    p.view().camera.pan(-g.x / s.cursor.height, g.y / s.cursor.height);
  };
  e.add("zoom", "FACTOR", {{"nearer, farther (a FACTOR below 1 is nearer)", "näher, weiter"}});
  e->keys = {{mouse::control_wheel, How::drag},
             {GLFW_KEY_EQUAL, How::press, nearer},
             {GLFW_KEY_KP_ADD, How::press, nearer},
             {GLFW_KEY_MINUS, How::press, farther},
             {GLFW_KEY_KP_SUBTRACT, How::press, farther}};
  e->during = [](Player& p, const Screen&, const Gesture& g) { p.view().camera.zoom(std::pow(0.9, g.y)); };
  e->run = does(zoom);
  e.add("", "", {{"tilt the tool", "kippen das Instrument"}});
  add_arrows(*e.operator->(), KeyUse::With::nothing);
  e->during = tilt;
  e.add("ahead", "", {{"points the tool away from you", "richtet das Instrument vom Betrachter weg"}});
  e->keys = {{GLFW_KEY_HOME}};
  e->run =
      hand_does([](Hand& hand, Screen&, Words&) -> texts::Answer { return hand.aim_at_viewer(), texts::Answer(); });
  e.add("aim", "", {{"aims the tool at the nearest target", "richtet das Instrument auf das nächste Ziel"}},
        outside_lesson);
  e->keys = {{GLFW_KEY_T}};
  e->run = hand_does([](Hand& hand, Screen&, Words&) { return hand.aim_at_target(); });
  e.add("surface", "",
        {{"puts the tool to the surface under the cursor", "setzt das Instrument an die Fläche unter dem Zeiger"}});
  e->keys = {{GLFW_KEY_G}};
  e->run = hand_does([](Hand& hand, Screen& s, Words&) { return hand.to_surface(s.cursor); });
  e.add(
      "incise", "",
      {{"marks an incision at the tip (with a tool that drills, or the scalpel, whose pedal does it too); in a lesson "
        "at the marker's last point",
        "Inzision an der Spitze; in einer Lektion am letzten Punkt des Stifts"}});
  e->label = {{"Incise", "Schnitt"}};
  e->keys = {{GLFW_KEY_M}};
  e->run = does([](Player& p, Words&) {
    return p.live() ? p.live()->incise() : p.lesson() ? of_lesson(p) : texts::Answer();
  });
  e.add("undo", "",
        {{"takes back the last stroke of the drill or the last incision, while the pedal is up",
          "nimmt den letzten Bohrgang oder Schnitt zurück, wenn das Pedal oben ist"}},
        with_drill);
  e->label = {{"Undo", "Rückgängig"}};
  e->keys = {{GLFW_KEY_Z}};
  e->run = does([](Player& p, Words&) { return p.live()->command("undo"); });
  e.add("reset", "",
        {{"takes back all that this session cut", "nimmt alles zurück, was in dieser Sitzung geschnitten wurde"}},
        with_drill);
  e->label = {{"Reset", "Alles zurück"}};
  e->keys = {{GLFW_KEY_R, How::twice}};
  e->run = does([](Player& p, Words&) { return p.live()->command("reset"); });
}

void view_actions(Entries e) {
  e.add("cut", "none|tool|axial|coronal|sagittal|toggle",
        {{"cuts away what lies before the tip (the key: across the tool, or no more)",
          "Schnitt am Instrument, quer zu ihm"}},
        outside_lesson);
  e->keys = {{GLFW_KEY_X, How::press, "toggle"}};
  e->choices = [](const Player&) { return std::vector<std::string>{"none", "tool", "axial", "coronal", "sagittal"}; };
  e->run = does([](Player& p, Words& w) {
    const std::string how = w.word();
    return p.view().cut(how != "toggle" ? how : p.view().stage().state.cut ? "none" : "tool");
  });
  e.add("move_cut", "MM", {{"moves the cut (the keys: by 1 mm)", "verschieben den Schnitt um 1 mm"}});
  e->keys = {{GLFW_KEY_LEFT_BRACKET, How::press, "-1"}, {GLFW_KEY_RIGHT_BRACKET, How::press, "1"}};
  e->run = does([](Player& p, Words& w) { p.view().move_cut(w.number()); });
  e.add("tool", "NAME", {{"tools, in the order of the panel", "Instrumente, wie die Tafel sie aufführt"}},
        without_recording);
  e->keys = {{GLFW_KEY_1, How::numbered}};
  e->choices = [](const Player& p) { return p.tools(); };
  e->run = does([](Player& p, Words& w) { return p.live()->take_tool(w.word()); });
  e.add("burr", "smaller|larger|kind",
        {{"another burr in the hand: smaller, larger, of the next kind",
          "ein anderer Bohrer: kleiner, größer, der nächsten Art"}},
        with_burr);
  e->keys = {{GLFW_KEY_V, How::press, "smaller"}, {GLFW_KEY_B, How::press, "larger"}, {GLFW_KEY_J, How::press, "kind"}};
  e->run = does([](Player& p, Words& w) { return p.live()->change_burr(w.word()); });
  e.add("view", "NAME",
        {{"views: surgeon, front, back, left, right, top, bottom, oblique", "Ansichten, wie die Tafel sie aufführt"}});
  e->keys = {{GLFW_KEY_F1, How::numbered}};
  e->choices = view_names;
  e->run = does([](Player& p, Words& w) { return p.view().set_view(w.word()); });
  e.add("slices", "on|off|toggle",
        {{"CT slices through the tip in the scene", "CT-Schichten durch die Spitze in der Szene"}}, outside_lesson);
  e->label = {{"CT slices at the tip", "CT-Schichten an der Spitze"}};
  e->keys = {{GLFW_KEY_C, How::press, "toggle"}};
  e->run = does([](Player& p, Words& w) { p.view().show_slices(w.on(!p.view().stage().state.ct_planes.empty())); });
  e.add("insets", "on|off|toggle", {{"three CT slices in a corner", "drei CT-Schichten in einer Ecke"}},
        outside_lesson);
  e->keys = {{GLFW_KEY_I, How::press, "toggle"}};
  e->run = does([](Player& p, Words& w) {
    bool& shown = p.view().stage().state.insets;
    shown = w.on(shown);
  });
  e.add(
      "cast", "none|ct|haptic [TRANSFER]",
      {{"rays through the CT or the haptic volume, in place of surfaces; TRANSFER, where these hold HU, is bone, skin, "
        "vessels, or points as of `--transfer`",
        "Strahlen durch das CT oder das haptische Volumen, an Stelle von Flächen"}},
      outside_lesson);
  e->choices = cast_choices;
  e->run = does(cast_volume);
  transfer_actions(e);
  e.add("places", "on|off|toggle", {{"landmarks, burr holes and targets", "Landmarken, Bohrlöcher und Ziele"}},
        outside_lesson);
  e->label = {{"Landmarks and targets", "Landmarken und Ziele"}};
  e->run = does([](Player& p, Words& w) { p.view().show_places(w.on(!p.view().stage().state.markers.empty())); });
  e.add("dust", "on|off|toggle",
        {{"bone dust, blood, and the saline that washes them away",
          "Knochenstaub, Blut, und die Spülung, die sie abwäscht"}});
  e->label = {{"Bone dust", "Knochenstaub"}};
  e->keys = {{GLFW_KEY_D, How::press, "toggle"}};
  e->run = does([](Player& p, Words& w) {
    render::Stage& stage = p.view().stage();
    scene::ViewParams view = stage.view();
    view.dust = w.on(view.dust);
    stage.set_dust(view.dust);
  });
  e.add("trace", "on|off|toggle", {{"a trace of the tip, with its length", "eine Spur der Spitze, mit ihrer Länge"}});
  e->keys = {{GLFW_KEY_K, How::press, "toggle"}};
  e->run = does([](Player& p, Words& w) { p.view().trace(w.on(p.view().traces())); });
  e.add("pause", "on|off|toggle",
        {{"pauses and resumes a recording, or a lesson with the tool in the open",
          "hält eine Aufnahme an, oder eine Lektion mit dem Instrument im Freien"}});
  e->label = {{"Pause", "Pause"}};
  e->keys = {{GLFW_KEY_P, How::press, "toggle"}};
  e->run = does(pause);
  e.add("panels", "on|off|toggle", {{"hides the panels, and shows them", "blendet die Tafeln aus und ein"}});
  e->keys = {{GLFW_KEY_H, How::press, "toggle"}};
  e->run = [](Player&, Screen& s, Words& w) { return s.panels_shown = w.on(s.panels_shown), Reply(); };
  e.add("shot", "",
        {{"a picture into the folder of `--shots`, and the fluoroscopic one, as `picture-001-xray.png`",
          "ein Bild in den Ordner --shots"}});
  e->keys = {{GLFW_KEY_F12}};
  e->run = does([](Player& p, Words&) { p.ask_shot(); });
  e.add("quit", "", {{"ends", "beendet"}});
  e->keys = {{GLFW_KEY_ESCAPE}};
  e->run = does([](Player& p, Words&) { p.quit(); });
}

void lesson_actions(Entries e) {
  e.add("erase", "", {{"erases the traces", "löscht die Spuren"}}, of_lesson);
  e->label = {{"Erase", "Löschen"}};
  e->keys = {{GLFW_KEY_E}};
  e->run = does(command);
  e.add("aspirate", "", {{"draws on the needle's syringe", "aspiriert mit der Spritze"}}, of_lesson);
  e->label = {{"Aspirate", "Aspirieren"}};
  e->keys = {{GLFW_KEY_A}};
  e->run = does(command);
  e.add("next", "", {{"the next step", "der nächste Schritt"}}, of_lesson);
  e->label = {{"Next", "Weiter"}};
  e->keys = {{GLFW_KEY_N}};
  e->run = does([](Player& p, Words&) { return p.lesson()->next(); });
  e.add("back", "",
        {{"back to the tool of the step before; what was cut stays cut",
          "zurück zum Instrument des Schritts davor; was geschnitten ist, bleibt es"}},
        of_lesson);
  e->label = {{"Back", "Zurück"}};
  e->keys = {{GLFW_KEY_BACKSPACE}};
  e->run = does([](Player& p, Words&) { return p.lesson()->back(); });
  e.add("answer", "CHOICE", {{"answers the question that is asked", "beantwortet die Frage"}}, with_question);
  e->keys = {{GLFW_KEY_1, How::numbered}};
  e->first = true;
  e->choices = [](const Player& p) {
    return p.lesson() ? p.lesson()->questions().choices(p.lesson()->facts()) : std::vector<std::string>();
  };
  e->run = does([](Player& p, Words& w) { return p.lesson()->answer(w.word()); });
  e.add("finish", "", {{"ends the lesson", "beendet die Lektion"}}, of_lesson);
  e->label = {{"Finish", "Beenden"}};
  e->keys = {{GLFW_KEY_ENTER, How::twice}, {GLFW_KEY_KP_ENTER, How::twice}};
  e->run = does(command);
  e.add("lesson", "", {{"answers how the lesson stands, and its points", nullptr}});
  e->run = does([](Player& p, Words&) { return lesson_text(p); });
}

void arm_actions(Entries e) {
  e.add("arm", "ap|lateral|oblique|orbit_more|orbit_less|tilt_more|tilt_less",
        {{"moves the C-arm to AP (frontal), lateral, oblique; by 5 degrees", "C-Bogen: a.-p., seitlich, schräg"}},
        of_arm);
  e->keys = {{GLFW_KEY_F, How::press, "ap"}, {GLFW_KEY_L, How::press, "lateral"}, {GLFW_KEY_O, How::press, "oblique"}};
  e->choices = [](const Player&) { return std::vector<std::string>{"ap", "lateral", "oblique"}; };
  e->run = does(move_arm);
  e.add("", "", {{"turn it about the patient's length by 5 degrees", "drehen ihn um 5 Grad um die Längsachse"}},
        of_arm);
  e->keys = {{GLFW_KEY_COMMA, How::again, "orbit_less"}, {GLFW_KEY_PERIOD, How::again, "orbit_more"}};
  e->run = does(move_arm);
  e.add("", "", {{"tilt it by 5 degrees", "kippen ihn um 5 Grad"}}, of_arm);
  e->keys = {{GLFW_KEY_PAGE_UP, How::again, "tilt_more"}, {GLFW_KEY_PAGE_DOWN, How::again, "tilt_less"}};
  e->run = does(move_arm);
  e.add("flip", "on|off|toggle",
        {{"exchanges left and right of its picture", "vertauschen links und rechts des Bildes"}}, of_arm);
  e->label = {{"Flip", "Spiegeln"}};
  e->keys = {{GLFW_KEY_Q, How::press, "toggle"}};
  e->run = does([](Player& p, Words& w) { p.xrays()->flipped = w.on(p.xrays()->flipped); });
  e.add(
      "xray", "",
      {{"answers how the C-arm stands, and of the picture: size, where the needle's tip is in it, how long it took; in "
        "a review which shot is shown",
        nullptr}});
  e->run = does([](Player& p, Words&) { return xray_text(p); });
}

void program_actions(Entries e) {
  e.add("place", "X Y Z [AX AY AZ]", {{"takes the tool away and to that place, with that axis", nullptr}});
  e->run = hand_does([](Hand& hand, Screen&, Words& w) -> texts::Answer {
    const Vec3 tip = w.point();
    return hand.place(tip, w.more() ? std::optional<Vec3>(w.point()) : std::nullopt), texts::Answer();
  });
  for (const char* name : {"opacity", "show", "hide"}) {
    e.add(name, name == std::string("opacity") ? "ANATOMY VALUE" : "ANATOMY",
          {{"how opaque an anatomy is, from 0 (hidden) to 1", nullptr}}, outside_lesson);
    e->run = does(opacity);
  }
  e.add("go_to", "SECONDS", {{"shows that time of a recording", nullptr}});
  e->run = does([](Player& p, Words& w) {
    const double time_s = w.number();
    if (p.shown()) p.shown()->go_to(time_s);
  });
  e.add("head", "RIGHT UP TOWARDS", {{"where the user's head is, mm beside the middle of the window", nullptr}});
  e->run = does([](Player& p, Words& w) {
    if (const Vec3 head = w.point(); norm(head) <= max_head_mm) p.head_mm = head;
  });
  e.add("notes", "[en|de]",
        {{"answers the last eight notes, the newest first: `0:12 TEXT | 0:03 TEXT`, in the panels' language or in that "
          "one",
          nullptr}});
  e->run = notes;
  e.add(
      "state", "",
      {{"answers time, tool, tip, shapes, force, depth, faults, incisions and the servo's rate, and how far the tip is "
        "behind a target that runs; in a lesson shapes and depth are `hidden` without --remote-tells-all",
        nullptr}});
  e->run = does([](Player& p, Words&) { return state_text(p); });
}

std::vector<Action> declared() {
  std::vector<Action> all;
  hand_actions({all, Group::work});
  view_actions({all, Group::work});
  lesson_actions({all, Group::lesson});
  arm_actions({all, Group::arm});
  program_actions({all, Group::work});
  return all;
}

}  // namespace

const std::vector<Action>& all_actions() {
  static const std::vector<Action> all = declared();
  return all;
}

}  // namespace trephine::window

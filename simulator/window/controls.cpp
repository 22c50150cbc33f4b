// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/controls.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cmath>

namespace trephine {
namespace {

constexpr double orbit_rad_per_px = 0.006, zoom_step = 0.9;
constexpr double cut_step_mm = 1;
constexpr double ask_again_s = 4;  // within which a lesson's end is asked for twice
constexpr int left = 0, right = 1, middle = 2;
constexpr double arm_first_s = 0.5, arm_again_s = 0.15;  // until a key that is held turns the C-arm further

struct ArmKey {
  int key;
  const char* how;
  bool again;
};
constexpr ArmKey arm_keys[] = {{GLFW_KEY_F, "ap", false},
                               {GLFW_KEY_L, "lateral", false},
                               {GLFW_KEY_O, "oblique", false},
                               {GLFW_KEY_PERIOD, "orbit_more", true},
                               {GLFW_KEY_COMMA, "orbit_less", true},
                               {GLFW_KEY_PAGE_UP, "tilt_more", true},
                               {GLFW_KEY_PAGE_DOWN, "tilt_less", true}};

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

}  // namespace

void Controls::apply(const std::vector<InputEvent>& events, Player& player, int width, int height, bool panel_has_mouse,
                     bool panel_has_keys) {
  for (const InputEvent& e : events) switch (e.kind) {
      case InputEvent::Kind::key:
        if (!e.down)
          keys_.erase(e.code);
        else if (!panel_has_keys) {
          keys_.insert(e.code);
          press(e.code, e.mods, player, width, height);
        }
        if (e.code == GLFW_KEY_SPACE && (!e.down || !panel_has_keys)) player.set_pedal(e.down);
        break;
      case InputEvent::Kind::button:
        if (!e.down)
          buttons_.erase(e.code);
        else if (!panel_has_mouse)
          buttons_.insert(e.code);
        if (e.code == left && (!e.down || !panel_has_mouse)) player.set_pedal(e.down);
        break;
      case InputEvent::Kind::move:
        move(e.x, e.y, player, width, height);
        break;
      case InputEvent::Kind::wheel:
        if (panel_has_mouse) break;
        if (e.mods & GLFW_MOD_CONTROL)
          player.camera.zoom(std::pow(zoom_step, e.y));
        else
          player.advance_tool(e.y * params_.wheel_mm);
        break;
      case InputEvent::Kind::dropped:
        keys_.clear();
        buttons_.clear();
        player.set_pedal(false);
        break;
    }
}

void Controls::move(double x, double y, Player& player, int width, int height) {
  const double dx = cursor_known_ ? x - cursor_x : 0, dy = cursor_known_ ? y - cursor_y : 0;
  cursor_x = x;
  cursor_y = y;
  cursor_known_ = true;
  if (buttons_.count(right)) {
    player.camera.orbit(dx * orbit_rad_per_px, dy * orbit_rad_per_px);
  } else if (buttons_.count(middle)) {
    player.camera.pan(-dx / height, dy / height);
  } else if (player.by_screen() && !(buttons_.count(left) && player.draws())) {
    // As far as the cursor went, at the tool's depth.
    const EyeView eye = player.camera.eye(width, height, player.stage().scene().bounds);
    const double depth = -dot(vec(player.frame().tip_mm) - eye.eye_mm, eye.toward);
    if (depth > 1)
      player.move_tool(eye.right * (dx * depth * (eye.right_edge - eye.left) / width) -
                       eye.up * (dy * depth * (eye.top - eye.bottom) / height));
  }
}

void Controls::press(int key, int, Player& player, int width, int height) {
  const std::vector<std::string> tools = player.tools();
  const auto& views = view_presets();
  said.clear();
  if (key >= GLFW_KEY_1 && key < GLFW_KEY_1 + int(tools.size()) && key <= GLFW_KEY_9) {
    said = player.take_tool(tools[std::size_t(key - GLFW_KEY_1)]);
    return;
  }
  if (key >= GLFW_KEY_F1 && key < GLFW_KEY_F1 + int(views.size()) && key <= GLFW_KEY_F8) {
    said = player.set_view(views[std::size_t(key - GLFW_KEY_F1)].first);
    return;
  }
  for (const ArmKey& a : arm_keys)
    if (key == a.key) {
      said = player.move_arm(a.how);
      arm_again_s_ = held_s_ + arm_first_s;
      return;
    }
  switch (key) {
    case GLFW_KEY_ESCAPE:
      player.quit();
      break;
    case GLFW_KEY_M:
      said = player.incise();
      break;
    case GLFW_KEY_E:
      said = player.lesson_command("erase");
      break;
    case GLFW_KEY_A:
      said = player.lesson_command("aspirate");
      break;
    case GLFW_KEY_N:
      said = player.lesson_command("next");
      break;
    case GLFW_KEY_BACKSPACE:
      said = player.lesson_command("back");
      break;
    case GLFW_KEY_ENTER:
    case GLFW_KEY_KP_ENTER:
      if (player.desk() && finish_asked_s_ >= 0 && held_s_ - finish_asked_s_ < ask_again_s) {
        said = player.lesson_command("finish");
      } else {
        finish_asked_s_ = held_s_;
        said = player.desk() ? "Enter again: the lesson ends" : "this is no lesson";
      }
      break;
    case GLFW_KEY_X:
      said = player.cut(player.stage().state.cut ? "none" : "tool");
      break;
    case GLFW_KEY_LEFT_BRACKET:
      player.move_cut(-cut_step_mm);
      break;
    case GLFW_KEY_RIGHT_BRACKET:
      player.move_cut(cut_step_mm);
      break;
    case GLFW_KEY_G:
      said = player.to_surface(cursor_x, cursor_y, width, height);
      break;
    case GLFW_KEY_T:
      said = player.aim_at_target();
      break;
    case GLFW_KEY_HOME:
      player.aim_at_viewer();
      break;
    case GLFW_KEY_C:
      said = player.set_ct_slices(player.stage().state.ct_planes.empty());
      break;
    case GLFW_KEY_I:
      said = player.set_insets(!player.stage().state.insets);
      break;
    case GLFW_KEY_K:
      player.set_trace(!player.trace_on());
      break;
    case GLFW_KEY_P:
      player.pause(player.desk() && player.live() ? !player.desk()->paused() : !player.paused());
      break;
    case GLFW_KEY_EQUAL:
    case GLFW_KEY_KP_ADD:
      player.camera.zoom(zoom_step);
      break;
    case GLFW_KEY_MINUS:
    case GLFW_KEY_KP_SUBTRACT:
      player.camera.zoom(1 / zoom_step);
      break;
    case GLFW_KEY_H:
      panels_shown = !panels_shown;
      break;
    case GLFW_KEY_F12:
      player.ask_shot();
      break;
    default:
      break;
  }
}

void Controls::hold(double wall_s, Player& player, int width, int height) {
  held_s_ += wall_s;
  if (buttons_.count(left) && player.draws()) player.draw_at(cursor_x, cursor_y, width, height);
  const auto down = [&](int key) { return keys_.count(key) ? 1.0 : 0.0; };
  for (const ArmKey& a : arm_keys)
    if (a.again && keys_.count(a.key) && player.has_xray() && !player.commanding() && held_s_ >= arm_again_s_) {
      player.move_arm(a.how);
      arm_again_s_ = held_s_ + arm_again_s;
    }
  const double ahead = down(GLFW_KEY_W) - down(GLFW_KEY_S);
  if (ahead != 0) player.advance_tool(ahead * params_.advance_mm_per_s * wall_s);
  const double turn = params_.turn_deg_per_s * M_PI / 180 * wall_s;
  const double across = down(GLFW_KEY_RIGHT) - down(GLFW_KEY_LEFT), up = down(GLFW_KEY_UP) - down(GLFW_KEY_DOWN);
  if (across != 0 || up != 0) player.turn_tool(across * turn, up * turn);
}

}  // namespace trephine

// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/glfw_window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

namespace trephine::window {
namespace {

std::string last_fault() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text ? text : "";
}

}  // namespace

struct GlfwWindow::Library {
  Library() {
    if (!glfwInit())
      throw Error(ExitCode::io, "", "display",
                  "no window can be opened (" + last_fault() + "); `trephine-sim render` needs no display");
  }
  ~Library() { glfwTerminate(); }
};

GlfwWindow::GlfwWindow(const std::string& title, int width, int height, bool visible, bool quad_buffers, int screen)
    : library_(new Library) {
  GLFWmonitor* filled = nullptr;
  if (screen > 0) {
    int count = 0;
    GLFWmonitor** all = glfwGetMonitors(&count);
    if (screen > count)
      throw Error(ExitCode::usage, "", "--screen-number",
                  fmt::format("screen {} is not there; this display has {}", screen, count));
    filled = all[screen - 1];
    const GLFWvidmode* mode = glfwGetVideoMode(filled);
    width = mode->width;
    height = mode->height;
    glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);  // it stays when somebody works on another screen
  }
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
  glfwWindowHint(GLFW_VISIBLE, visible ? GLFW_TRUE : GLFW_FALSE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  if (quad_buffers) {
    glfwWindowHint(GLFW_STEREO, GLFW_TRUE);
    window_ = glfwCreateWindow(width, height, title.c_str(), filled, nullptr);
    glfwWindowHint(GLFW_STEREO, GLFW_FALSE);
    quad_buffers_ = window_ != nullptr;
  }
  if (!window_) window_ = glfwCreateWindow(width, height, title.c_str(), filled, nullptr);
  if (!window_) {
    const std::string first = last_fault();
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_NO_ROBUSTNESS);
    window_ = glfwCreateWindow(width, height, title.c_str(), filled, nullptr);
    if (!window_) throw Error(ExitCode::io, "", "OpenGL", "the display has none of version 4.3 (core): " + first);
  }
  glfwMakeContextCurrent(window_);
  has_khr_robustness_ = epoxy_has_gl_extension("GL_KHR_robustness");
  has_arb_robustness_ = epoxy_has_gl_extension("GL_ARB_robustness");
  glfwSwapInterval(0);  // the loop keeps its own time, and reads the hand as late as it can
  glfwSetWindowUserPointer(window_, this);
  static const auto keep = [](GLFWwindow* w, const InputEvent& e) {
    static_cast<GlfwWindow*>(glfwGetWindowUserPointer(w))->waiting_.push_back(e);
  };
  glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int mods) {
    if (action != GLFW_REPEAT) keep(w, {InputEvent::Kind::key, key, action == GLFW_PRESS, mods, 0, 0});
  });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int mods) {
    keep(w, {InputEvent::Kind::button, button, action == GLFW_PRESS, mods, 0, 0});
  });
  static const auto moved = [](GLFWwindow* w, double x, double y) {
    int ww = 1, wh = 1, fw = 1, fh = 1;
    glfwGetWindowSize(w, &ww, &wh);
    glfwGetFramebufferSize(w, &fw, &fh);
    if (ww > 0 && wh > 0) keep(w, {InputEvent::Kind::move, 0, false, 0, x * fw / ww, y * fh / wh});
  };
  glfwSetCursorPosCallback(window_, moved);
  double x = 0, y = 0;
  glfwGetCursorPos(window_, &x, &y);  // no event tells where the cursor is before it moves
  moved(window_, x, y);
  glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double y) {
    const bool control =
        glfwGetKey(w, GLFW_KEY_LEFT_CONTROL) == GLFW_PRESS || glfwGetKey(w, GLFW_KEY_RIGHT_CONTROL) == GLFW_PRESS;
    keep(w, {InputEvent::Kind::wheel, 0, false, control ? GLFW_MOD_CONTROL : 0, 0, y});
  });
  glfwSetWindowFocusCallback(window_, [](GLFWwindow* w, int focused) {
    if (!focused) keep(w, {InputEvent::Kind::dropped, 0, false, 0, 0, 0});  // all keys count as released
  });
}

GlfwWindow::~GlfwWindow() {
  if (window_) glfwDestroyWindow(window_);
}

const std::vector<InputEvent>& GlfwWindow::events(double wait_s) {
  if (wait_s > 0)
    glfwWaitEventsTimeout(wait_s);
  else
    glfwPollEvents();
  given_.swap(waiting_);
  waiting_.clear();
  int width = 0, height = 0;
  width_height(width, height);
  for (InputEvent& e : given_)
    if (e.kind == InputEvent::Kind::move) render::mirror_place(mirror_, width, height, e.x, e.y);
  return given_;
}

bool GlfwWindow::closed() const { return glfwWindowShouldClose(window_); }
void GlfwWindow::width_height(int& width, int& height) const { glfwGetFramebufferSize(window_, &width, &height); }

std::optional<device::WindowPlace> GlfwWindow::place() const {
  int x = 0, y = 0, width = 0, height = 0, count = 0;
  glfwGetError(nullptr);
  glfwGetWindowPos(window_, &x, &y);
  if (glfwGetError(nullptr) != GLFW_NO_ERROR) return {};  // under Wayland no window knows where it lies
  glfwGetWindowSize(window_, &width, &height);
  if (width <= 0 || height <= 0) return {};
  std::optional<device::WindowPlace> best;
  double most = 0;
  GLFWmonitor** all = glfwGetMonitors(&count);
  for (int n = 0; n < count; ++n) {
    int left = 0, top = 0;
    glfwGetMonitorPos(all[n], &left, &top);
    const GLFWvidmode* mode = glfwGetVideoMode(all[n]);
    if (!mode) continue;
    const double across = std::min(x + width, left + mode->width) - std::max(x, left);
    const double down = std::min(y + height, top + mode->height) - std::max(y, top);
    if (!(across > 0 && down > 0 && across * down > most)) continue;
    most = across * down;
    const double right = left + 0.5 * mode->width - (x + 0.5 * width);
    const double up = y + 0.5 * height - (top + 0.5 * mode->height);
    // The mirror turns the screen over, and the picture within the window was turned over for it.
    best = {(mirror_ == render::Mirror::left_right ? -right : right) / height,
            (mirror_ == render::Mirror::up_down ? -up : up) / height, double(mode->height) / height};
  }
  return best;
}

void GlfwWindow::swap() { glfwSwapBuffers(window_); }

bool GlfwWindow::reset() const {
  // On a desktop the extension of KHR has names without a suffix.
  if (epoxy_gl_version() >= 45 || has_khr_robustness_) return glGetGraphicsResetStatus() != GL_NO_ERROR;
  return has_arb_robustness_ && glGetGraphicsResetStatusARB() != GL_NO_ERROR;
}

}  // namespace trephine::window

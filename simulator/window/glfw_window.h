// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "device/screen_registration.h"
#include "render/mirror.h"

struct GLFWwindow;

namespace trephine::window {

/// What a user did, in the order in which it was done: also what was pressed and released while a picture was drawn.
struct InputEvent {
  enum class Kind { key, button, move, wheel, dropped };
  Kind kind = Kind::key;
  int code = 0;         ///< GLFW's key, or mouse button (0 left, 1 right, 2 middle)
  bool down = false;    ///< of a key or button
  int mods = 0;         ///< GLFW's shift (1), control (2), alt (4)
  double x = 0, y = 0;  ///< of the cursor, in pixels of the framebuffer from the upper left corner; of the wheel: steps
};

/// A window with a current context of OpenGL 4.3 core.
class GlfwWindow {
 public:
  /// Throws Error 74 where there is no display, or no such context. `quad_buffers`: a buffer for each eye is asked for;
  /// a driver without them gives a window without. `screen`: it fills that screen, from 1 as the system counts them,
  /// and width and height are those of the screen; 0: it is a window. Throws Error 64 where there are fewer screens.
  GlfwWindow(const std::string& title, int width, int height, bool visible = true, bool quad_buffers = false,
             int screen = 0);
  ~GlfwWindow();
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;

  /// Waits for events, at most that long, and returns those that came; valid until the next call.
  const std::vector<InputEvent>& events(double wait_s);
  bool closed() const;
  void width_height(int& width, int& height) const;  ///< of the framebuffer
  /// Where it lies now on the screen that it covers most, as that is seen; nothing where the system does not tell.
  std::optional<device::WindowPlace> place() const;
  void swap();
  bool reset() const;  ///< the driver lost the context
  /// What is seen is mirrored, so places of the cursor are.
  void set_mirror(render::Mirror mirror) { mirror_ = mirror; }
  bool has_quad_buffers() const { return quad_buffers_; }
  GLFWwindow* handle() const { return window_; }

 private:
  struct Library;
  std::unique_ptr<Library> library_;
  GLFWwindow* window_ = nullptr;
  render::Mirror mirror_ = render::Mirror::none;
  bool quad_buffers_ = false, has_khr_robustness_ = false, has_arb_robustness_ = false;
  std::vector<InputEvent> waiting_, given_;
};

}  // namespace trephine::window

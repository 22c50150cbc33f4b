// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <string>

namespace trephine::render {

/// An OpenGL context without a window or display (EGL's surfaceless platform), current in the thread that made it.
class OffscreenContext {
 public:
  /// Throws Error 74 where the system has no EGL, no such platform, or no OpenGL 4.3.
  OffscreenContext();
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// What draws, of the current context.
struct DriverFacts {
  std::string renderer, version;
  bool software = false;  ///< on the processor: llvmpipe, softpipe, SwiftShader
  int max_samples = 1;
};
/// Throws Error 74, naming both versions, where the current context is older than OpenGL 4.3.
DriverFacts driver_facts();
/// Until all that was asked of the driver is done: for measuring.
void wait_for_driver();

}  // namespace trephine::render

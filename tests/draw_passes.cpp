// SPDX-License-Identifier: GPL-3.0-or-later
// draw_passes bare|kept: draws small passes by twos, with KeptFences or without, and pauses between them, so that some
// begin just when the driver's thread ends one. For program.fences, which loads fence_stub.so before it.
#include <epoxy/gl.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <thread>

#include "base/splitmix64.h"
#include "render/context.h"
#include "render/kept_fences.h"

int main(int argc, char** argv) {
  using namespace trephine;
  const bool kept = argc == 2 && std::strcmp(argv[1], "kept") == 0;
  const render::OffscreenContext context;
  const render::DriverFacts driver = render::driver_facts();
  std::printf("%s\n", driver.renderer.c_str());
  render::KeptFences fences(kept && driver.software);
  render::GlObject textures[4], frames[4];
  for (int n = 0; n < 4; ++n) {
    textures[n] = render::make_texture();
    frames[n] = render::make_framebuffer();
    glBindTexture(GL_TEXTURE_2D, textures[n]);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 64, 64, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    glBindFramebuffer(GL_FRAMEBUFFER, frames[n]);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, textures[n], 0);
  }
  for (int pass = 0; pass < 500; ++pass) {
    if (pass % 40 == 0) {
      glFinish();
      fences.new_picture();
    }
    glBindFramebuffer(GL_FRAMEBUFFER, frames[pass % 4]);
    glClearColor(float(pass % 7) / 7, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glFlush();
    fences.after_pass();
    if (pass % 2 == 1)
      std::this_thread::sleep_for(std::chrono::microseconds(splitmix64_mixed(std::uint64_t(pass)) % 20000));
  }
  glFinish();
  render::check_gl("passes");
  return 0;
}

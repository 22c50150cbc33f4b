// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/context.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include "base/error.h"

namespace trephine::render {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw Error(ExitCode::io, "", "OpenGL", what); }

// epoxy ends the process where a library that it needs is not there.
void need_library(const char* name) {
  void* handle = ::dlopen(name, RTLD_LAZY | RTLD_LOCAL);
  if (!handle) refuse(std::string(name) + " is not installed: no picture can be drawn");
  ::dlclose(handle);
}

}  // namespace

struct OffscreenContext::Impl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  ~Impl() {
    if (display == EGL_NO_DISPLAY) return;
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
    eglTerminate(display);
  }
};

OffscreenContext::OffscreenContext() : impl_(new Impl) {
  need_library("libEGL.so.1");
  // Asked for by name, because epoxy's own wrapper looks at a display's extensions, and there is no display yet.
  const auto get = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (!get) refuse("EGL has no platform without a display");
  impl_->display = get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (impl_->display == EGL_NO_DISPLAY) {
    const auto devices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
    EGLDeviceEXT device = nullptr;
    EGLint count = 0;
    if (devices && devices(1, &device, &count) && count > 0)
      impl_->display = get(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
  }
  EGLint major = 0, minor = 0;
  if (impl_->display == EGL_NO_DISPLAY || !eglInitialize(impl_->display, &major, &minor))
    refuse("EGL gives no picture without a display here");
  eglBindAPI(EGL_OPENGL_API);
  const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(impl_->display, wanted, &config, 1, &count) || count < 1) config = nullptr;
  const EGLint version[] = {
      EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  impl_->context = eglCreateContext(impl_->display, config, EGL_NO_CONTEXT, version);
  if (impl_->context == EGL_NO_CONTEXT) refuse("this system has none of version 4.3 (core)");
  if (!eglMakeCurrent(impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, impl_->context))
    refuse("the context cannot be used without a surface");
}

OffscreenContext::~OffscreenContext() = default;

DriverFacts driver_facts() {
  const auto text = [](GLenum what) {
    const auto* s = reinterpret_cast<const char*>(glGetString(what));
    return std::string(s ? s : "");
  };
  DriverFacts f{text(GL_RENDERER), text(GL_VERSION), false, 1};
  if (const int version = epoxy_gl_version(); version < 43)
    refuse("version 4.3 is needed; this is " + std::to_string(version / 10) + "." + std::to_string(version % 10) +
           " (" + f.renderer + ")");
  for (const char* name : {"llvmpipe", "softpipe", "SwiftShader"})
    f.software = f.software || f.renderer.find(name) != std::string::npos;
  GLint samples = 1;
  glGetIntegerv(GL_MAX_SAMPLES, &samples);
  f.max_samples = samples;
  return f;
}

void wait_for_driver() { glFinish(); }

}  // namespace trephine::render

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <epoxy/gl.h>

#include <initializer_list>
#include <string>
#include <utility>

#include "scene/mat4.h"

namespace trephine::render {

// Objects of OpenGL that end with their owner, in the thread whose context made them. Only sources of this folder
// include this header.

class GlObject {
 public:
  using Delete = void (*)(GLuint);
  GlObject() = default;
  GlObject(GLuint id, Delete end) : id_(id), end_(end) {}
  GlObject(GlObject&& other) noexcept : id_(std::exchange(other.id_, 0)), end_(other.end_) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(end_, other.end_);
    return *this;
  }
  ~GlObject() {
    if (id_ != 0) end_(id_);
  }
  operator GLuint() const { return id_; }

 private:
  GLuint id_ = 0;
  Delete end_ = nullptr;
};

GlObject make_buffer();
GlObject make_vertex_array();
GlObject make_texture();
GlObject make_framebuffer();
GlObject make_renderbuffer();

/// A vertex and a fragment shader, or a compute shader. Throws Error 74 with the driver's first line where they do not
/// compile.
class GlProgram {
 public:
  GlProgram() = default;
  GlProgram(const char* vertex, const char* fragment);
  explicit GlProgram(const char* compute);
  void use() const { glUseProgram(id_); }
  void set(const char* name, const scene::Mat4& m) const { glUniformMatrix4fv(at(name), 1, GL_FALSE, m.m.data()); }
  void set(const char* name, float x) const { glUniform1f(at(name), x); }
  void set(const char* name, int n) const { glUniform1i(at(name), n); }
  void set_whole(const char* name, int x, int y, int z) const { glUniform3i(at(name), x, y, z); }
  void set(const char* name, float x, float y) const { glUniform2f(at(name), x, y); }
  void set(const char* name, float x, float y, float z) const { glUniform3f(at(name), x, y, z); }
  void set(const char* name, float x, float y, float z, float w) const { glUniform4f(at(name), x, y, z, w); }
  void set(const char* name, Vec3 v) const { set(name, float(v.x), float(v.y), float(v.z)); }
  GLint at(const char* name) const { return glGetUniformLocation(id_, name); }

 private:
  void link();
  GlObject id_;
};

/// How the texture that is bound is read between texels and beyond its border.
void set_filter(GLenum target, GLint how, GLint wrap);
/// Throws Error 74 where the framebuffer that is bound cannot be drawn into.
void check_framebuffer();

/// Throws Error 74 where OpenGL has noted an error since the last call; `what` says at what.
void check_gl(const char* what);

}  // namespace trephine::render

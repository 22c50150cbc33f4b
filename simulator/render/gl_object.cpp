// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/gl_object.h"

#include "base/error.h"

namespace trephine::render {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw Error(ExitCode::io, "", "OpenGL", what); }

GlObject shader_of(GLenum kind, const char* source) {
  GlObject shader(glCreateShader(kind), [](GLuint id) { glDeleteShader(id); });
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good) return shader;
  char text[512] = "";
  glGetShaderInfoLog(shader, sizeof text, nullptr, text);
  refuse("a shader does not compile: " + std::string(text).substr(0, std::string(text).find('\n')));
}

}  // namespace

GlObject make_buffer() {
  GLuint id = 0;
  glGenBuffers(1, &id);
  return {id, [](GLuint n) { glDeleteBuffers(1, &n); }};
}
GlObject make_vertex_array() {
  GLuint id = 0;
  glGenVertexArrays(1, &id);
  return {id, [](GLuint n) { glDeleteVertexArrays(1, &n); }};
}
GlObject make_texture() {
  GLuint id = 0;
  glGenTextures(1, &id);
  return {id, [](GLuint n) { glDeleteTextures(1, &n); }};
}
GlObject make_framebuffer() {
  GLuint id = 0;
  glGenFramebuffers(1, &id);
  return {id, [](GLuint n) { glDeleteFramebuffers(1, &n); }};
}
GlObject make_renderbuffer() {
  GLuint id = 0;
  glGenRenderbuffers(1, &id);
  return {id, [](GLuint n) { glDeleteRenderbuffers(1, &n); }};
}

GlProgram::GlProgram(const char* vertex, const char* fragment) {
  const GlObject v = shader_of(GL_VERTEX_SHADER, vertex), f = shader_of(GL_FRAGMENT_SHADER, fragment);
  id_ = GlObject(glCreateProgram(), [](GLuint id) { glDeleteProgram(id); });
  glAttachShader(id_, v);
  glAttachShader(id_, f);
  link();
}

GlProgram::GlProgram(const char* compute) {
  const GlObject c = shader_of(GL_COMPUTE_SHADER, compute);
  id_ = GlObject(glCreateProgram(), [](GLuint id) { glDeleteProgram(id); });
  glAttachShader(id_, c);
  link();
}

void GlProgram::link() {
  glLinkProgram(id_);
  GLint good = 0;
  glGetProgramiv(id_, GL_LINK_STATUS, &good);
  if (!good) refuse("a program does not link");
}

void set_filter(GLenum target, GLint how, GLint wrap) {
  glTexParameteri(target, GL_TEXTURE_MIN_FILTER, how);
  glTexParameteri(target, GL_TEXTURE_MAG_FILTER, how);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTexParameteri(target, axis, wrap);
}

void check_framebuffer() {
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error(ExitCode::io, "", "OpenGL", "the driver refuses a picture of this size");
}

void check_gl(const char* what) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  while (glGetError() != GL_NO_ERROR) {
  }
  if (error == GL_OUT_OF_MEMORY) refuse(std::string(what) + ": the graphics memory is full");
  refuse(std::string(what) + ": error " + std::to_string(error));
}

}  // namespace trephine::render

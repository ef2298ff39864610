// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/gl/shader_program.h"

#include <epoxy/gl.h>

#include <array>
#include <stdexcept>

namespace dubsar::ui {

namespace {

constexpr int kLogLength = 2000;

void attach(GLuint program, GLenum stage, const char* source) {
  const GLuint shader = glCreateShader(stage);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint good = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good == GL_FALSE) {
    std::array<char, kLogLength> log{};
    glGetShaderInfoLog(shader, kLogLength, nullptr, log.data());
    throw std::runtime_error(std::string("a shader does not compile here: ") + log.data());
  }
  glAttachShader(program, shader);
  glDeleteShader(shader);
}

}  // namespace

ShaderProgram::ShaderProgram(const char* vertex, const char* fragment)
    : ShaderProgram(vertex, fragment, {}) {}

ShaderProgram::ShaderProgram(const char* vertex, const char* fragment,
                             const std::vector<const char*>& feedback)
    : id_(glCreateProgram()) {
  attach(id_, GL_VERTEX_SHADER, vertex);
  if (fragment != nullptr) {
    attach(id_, GL_FRAGMENT_SHADER, fragment);
  }
  if (!feedback.empty()) {
    glTransformFeedbackVaryings(id_, static_cast<GLsizei>(feedback.size()), feedback.data(),
                                GL_INTERLEAVED_ATTRIBS);
  }
  glLinkProgram(id_);
  GLint good = GL_FALSE;
  glGetProgramiv(id_, GL_LINK_STATUS, &good);
  if (good == GL_FALSE) {
    std::array<char, kLogLength> log{};
    glGetProgramInfoLog(id_, kLogLength, nullptr, log.data());
    throw std::runtime_error(std::string("a shader program does not link here: ") + log.data());
  }
}

ShaderProgram::~ShaderProgram() {
  glDeleteProgram(id_);
}

void ShaderProgram::use() const {
  glUseProgram(id_);
}

int ShaderProgram::location(const char* name) {
  const auto known = locations_.find(name);
  if (known != locations_.end()) {
    return known->second;
  }
  return locations_[name] = glGetUniformLocation(id_, name);
}

void ShaderProgram::set(const char* name, int value) {
  glUniform1i(location(name), value);
}
void ShaderProgram::set(const char* name, float value) {
  glUniform1f(location(name), value);
}
void ShaderProgram::set(const char* name, const Eigen::Vector2f& value) {
  glUniform2fv(location(name), 1, value.data());
}
void ShaderProgram::set(const char* name, const Eigen::Vector3f& value) {
  glUniform3fv(location(name), 1, value.data());
}
void ShaderProgram::set(const char* name, const Eigen::Vector4f& value) {
  glUniform4fv(location(name), 1, value.data());
}
void ShaderProgram::set(const char* name, const Eigen::Matrix3f& value) {
  glUniformMatrix3fv(location(name), 1, GL_FALSE, value.data());
}
void ShaderProgram::set(const char* name, const Eigen::Matrix4f& value) {
  glUniformMatrix4fv(location(name), 1, GL_FALSE, value.data());
}

}  // namespace dubsar::ui

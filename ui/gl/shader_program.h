// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

namespace dubsar::ui {

/// A linked GLSL 4.10 program. The sources are the program's own: one that does not compile is a defect, and
/// ends it with what the compiler says. Main thread.
class ShaderProgram {
 public:
  ShaderProgram(const char* vertex, const char* fragment);
  /// `fragment` may be null. `feedback`: what transform feedback records, interleaved.
  ShaderProgram(const char* vertex, const char* fragment, const std::vector<const char*>& feedback);
  ~ShaderProgram();
  ShaderProgram(const ShaderProgram&) = delete;
  ShaderProgram& operator=(const ShaderProgram&) = delete;

  void use() const;
  // Of the program in use; names that the compiler has left out are skipped.
  void set(const char* name, int value);
  void set(const char* name, float value);
  void set(const char* name, const Eigen::Vector2f& value);
  void set(const char* name, const Eigen::Vector3f& value);
  void set(const char* name, const Eigen::Vector4f& value);
  void set(const char* name, const Eigen::Matrix3f& value);
  void set(const char* name, const Eigen::Matrix4f& value);

 private:
  [[nodiscard]] int location(const char* name);
  unsigned id_ = 0;
  std::map<std::string, int> locations_;
};

}  // namespace dubsar::ui

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "tests/station/support/command.h"
#include "tests/ui/support/on_a_display.h"

namespace dubsar::test {

/// A test that looks at a mesh through the real window.
class OnAMesh : public OnADisplay {
 protected:
  Outcome look_at(const std::string& name, const std::string& bytes, const std::string& script) {
    const auto mesh = folder_.path() / name;
    std::ofstream(mesh) << bytes;
    const auto file = folder_.path() / "look.script";
    std::ofstream(file) << script;
    return run_command({"station", "--mesh", mesh.string(), "--script", file.string(), "--width", "1024",
                        "--height", "640"});
  }
};

/// A plate of 10 x 6 mm with a groove, 1 mm deep, across its middle.
inline std::string grooved_plate(int rows = 6, int cols = 40) {
  std::string out;
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= cols; ++c) {
      const double x = -5 + 10.0 * c / cols;
      out += "v " + std::to_string(x) + " " + std::to_string(6.0 * r / rows - 3) + " " +
             std::to_string(-std::max(0.0, 1 - std::abs(x))) + "\n";
    }
  }
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const auto at = [&](int row, int col) { return std::to_string(1 + row * (cols + 1) + col); };
      out += "f " + at(r, c) + " " + at(r, c + 1) + " " + at(r + 1, c + 1) + "\nf " + at(r, c) + " " +
             at(r + 1, c + 1) + " " + at(r + 1, c) + "\n";
    }
  }
  return out;
}

}  // namespace dubsar::test

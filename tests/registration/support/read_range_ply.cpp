// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/registration/support/read_range_ply.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace dubsar::testing {

std::optional<RangeGrid> read_range_ply(const std::filesystem::path& path, double mm_per_unit) {
  std::ifstream in(path);
  std::string line;
  int cols = 0;
  int rows = 0;
  std::size_t vertices = 0;
  while (std::getline(in, line) && line.rfind("end_header", 0) != 0) {
    std::istringstream words(line);
    std::string a;
    std::string b;
    words >> a >> b;
    if (b == "num_cols") {
      words >> cols;
    } else if (b == "num_rows") {
      words >> rows;
    } else if (a == "element" && b == "vertex") {
      words >> vertices;
    }
  }
  if (cols <= 0 || rows <= 0) {
    return std::nullopt;
  }
  std::vector<Eigen::Vector3f> points(vertices);
  const auto scale = static_cast<float>(mm_per_unit);
  for (auto& p : points) {
    std::getline(in, line);
    char* at = line.data();
    p.x() = std::strtof(at, &at) * scale;
    p.y() = std::strtof(at, &at) * scale;
    p.z() = std::strtof(at, &at) * scale;
  }
  RangeGrid grid;
  grid.allocate(rows, cols);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    std::getline(in, line);
    char* at = line.data();
    if (std::strtol(at, &at, 10) == 1) {
      const auto k = static_cast<std::size_t>(std::strtol(at, &at, 10));
      if (k < points.size()) {
        grid.x[i] = points[k].x();
        grid.y[i] = points[k].y();
        grid.z[i] = points[k].z();
        grid.valid[i] = 1;
      }
    }
  }
  grid.source = path.filename().string();
  grid.spacing_mm = estimate_spacing_mm(grid);
  return grid;
}

std::map<std::string, RigidTransform> read_conf(const std::filesystem::path& path, double mm_per_unit) {
  std::map<std::string, RigidTransform> out;
  std::ifstream in(path);
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string kind;
    std::string name;
    Eigen::Vector3d t;
    double x = 0;
    double y = 0;
    double z = 0;
    double w = 1;
    if (words >> kind >> name >> t.x() >> t.y() >> t.z() >> x >> y >> z >> w && kind == "bmesh") {
      out[name] = {Eigen::Quaterniond(w, -x, -y, -z).normalized().toRotationMatrix(), t * mm_per_unit};
    }
  }
  return out;
}

std::optional<std::filesystem::path> data_folder() {
  const char* set = std::getenv("DUBSAR_DATA");
  const std::filesystem::path folder =
      set != nullptr ? std::filesystem::path(set)
                     : std::filesystem::path(DUBSAR_SOURCE_DIR) / ".." / "shared" / "data";
  return std::filesystem::is_directory(folder) ? std::optional(folder) : std::nullopt;
}

std::vector<RangeGrid> read_folder(const std::filesystem::path& folder, double mm_per_unit) {
  std::vector<std::filesystem::path> paths;
  if (std::filesystem::is_directory(folder)) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == ".ply") {
        paths.push_back(entry.path());
      }
    }
  }
  std::sort(paths.begin(), paths.end());
  std::vector<RangeGrid> out;
  for (const auto& path : paths) {
    if (auto grid = read_range_ply(path, mm_per_unit)) {
      out.push_back(std::move(*grid));
    }
  }
  return out;
}

}  // namespace dubsar::testing

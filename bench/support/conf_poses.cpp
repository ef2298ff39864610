// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/conf_poses.h"

#include <fstream>
#include <sstream>

namespace dubsar::bench {

std::map<std::string, RigidTransform> read_conf_poses(const std::filesystem::path& path,
                                                      double mm_per_file_unit) {
  std::ifstream in(path);
  std::map<std::string, RigidTransform> poses;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string key;
    std::string file;
    Eigen::Vector3d t;
    Eigen::Quaterniond q;
    if (words >> key && key == "bmesh" &&
        words >> file >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w()) {
      poses[file] = {q.normalized().conjugate().toRotationMatrix(), t * mm_per_file_unit};
    }
  }
  return poses;
}

}  // namespace dubsar::bench

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// consumer SCANS MESH: a folder of range grids to a mesh, with the installed libraries alone.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <variant>
#include <vector>

#include "formats/grid_reader.h"
#include "formats/mesh_io.h"
#include "planning/sparse_flags.h"
#include "registration/registrar.h"
#include "triangulation/mesh_check.h"
#include "triangulation/stitcher.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    return 2;
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
    if (dubsar::looks_like_scan(entry.path())) {
      files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  dubsar::JobContext job;
  dubsar::Registrar registrar;
  std::vector<std::shared_ptr<const dubsar::RangeGrid>> grids;
  std::vector<dubsar::SampleFlags> flags;
  for (const auto& file : files) {
    const auto scans = dubsar::read_scan_file(file);
    if (!scans) {
      std::fprintf(stderr, "%s\n", scans.error().line().c_str());
      return 2;
    }
    for (const dubsar::ScanData& scan : *scans) {
      if (const auto* grid = std::get_if<dubsar::RangeGrid>(&scan)) {
        grids.push_back(std::make_shared<const dubsar::RangeGrid>(*grid));
        flags.push_back(dubsar::flag_sparse(*grid));
        registrar.add(static_cast<int>(grids.size()) - 1, grids.back(), nullptr, job);
      }
    }
  }
  if (!registrar.finalize(job)) {
    return 4;
  }
  dubsar::Stitcher stitcher;
  int registered = 0;
  for (const dubsar::ScanPose& pose : registrar.poses()) {
    if (pose.status == dubsar::PoseStatus::kRegistered) {
      const auto id = static_cast<std::size_t>(pose.id);
      if (!stitcher.add({pose.id, grids[id].get(), &flags[id], pose.model_from_scanner, pose.sigma_mm},
                        job)) {
        return 4;
      }
      ++registered;
    }
  }
  const auto mesh = stitcher.mesh(job);
  if (!mesh || !dubsar::write_mesh(argv[2], *mesh)) {
    return 4;
  }
  const dubsar::MeshReport report = dubsar::check_mesh(*mesh);
  std::printf("%d of %zu scans, %zu faces, %s\n", registered, grids.size(), report.faces,
              report.is_manifold() ? "manifold" : "not manifold");
  return registered > 0 && report.is_manifold() ? 0 : 1;
}

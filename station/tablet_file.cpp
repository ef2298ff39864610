// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/tablet_file.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "formats/mesh_io.h"
#include "station/outward_faces.h"
#include "station/tablet_label.h"

namespace dubsar {

namespace {

constexpr float kPlainClayAlbedo = 0.6F;

}  // namespace

Status write_tablet_file(const std::filesystem::path& path, const sim::SimTablet& tablet) {
  Mesh mesh = tablet.mesh;
  mesh.colours.resize(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.colours.size(); ++i) {
    const auto grey =
        static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(tablet.albedo[i], 0.0F, 1.0F)));
    mesh.colours[i] = {grey, grey, grey};
  }
  // The truth is known everywhere; no scan is behind it.
  mesh.reliability.assign(mesh.positions.size(), 1.0F);
  mesh.scans.assign(mesh.positions.size(), 0);
  mesh.flags.assign(mesh.positions.size(), 0);
  return write_mesh(path, mesh, made_up_label());
}

Result<sim::SimTablet> read_tablet_file(const std::filesystem::path& path, const MeshReadOptions& options) {
  Result<Mesh> mesh = read_mesh(path, options);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  face_outwards(&*mesh, path.string());
  sim::SimTablet tablet;
  tablet.albedo.assign(mesh->positions.size(), kPlainClayAlbedo);
  for (std::size_t i = 0; i < mesh->colours.size(); ++i) {
    const auto& c = mesh->colours[i];
    tablet.albedo[i] = static_cast<float>(c[0] + c[1] + c[2]) / 765.0F;
  }
  tablet.kinds.assign(mesh->positions.size(), sim::SurfaceKind::kBody);
  tablet.wedge_of.assign(mesh->positions.size(), -1);
  if (mesh->normals.size() != mesh->positions.size()) {
    mesh->normals = vertex_normals(*mesh);
  }
  tablet.mesh = std::move(*mesh);
  return tablet;
}

sim::ScannerOptions fitted_to(sim::ScannerOptions scanner, const sim::SimTablet& tablet) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : tablet.mesh.positions) {
    box.extend(p);
  }
  const double across_mm = box.isEmpty() ? 0.0 : static_cast<double>(box.diagonal().norm()) + 20.0;
  scanner.field_x_mm = std::max(scanner.field_x_mm, across_mm);
  scanner.field_y_mm = std::max(scanner.field_y_mm, across_mm);
  scanner.depth_range_mm = std::max(scanner.depth_range_mm, across_mm);
  scanner.standoff_mm = std::max(scanner.standoff_mm, 2.5 * across_mm);
  return scanner;
}

}  // namespace dubsar

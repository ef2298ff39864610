// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "analysis/integral_invariants.h"
#include "analysis/surface_fields.h"
#include "core/job.h"
#include "core/mesh.h"
#include "core/result.h"
#include "core/rigid_transform.h"
#include "formats/file_label.h"

namespace dubsar {

/// What a mesh that is a picture says of itself: what that of which it is one says, and that it is coloured.
[[nodiscard]] FileLabel coloured_label(const FileLabel& label);

/// Draws six views, to scale on one sheet, of a mesh with its colours as they are, into a PNG that says what
/// the label does. A mesh without colours is drawn as clay.
[[nodiscard]] Status write_six_view_picture(const std::filesystem::path& png, const Mesh& mesh,
                                            const RigidTransform& tablet_from_model, const FileLabel& label,
                                            const JobContext& job);

/// Writes one coloured PLY and one PNG of six views for each surface field into a folder, which is made:
/// height.ply, height.png and so on (field_name()), and the surface that heights are taken from, coloured by
/// its curvature, as surface.ply and surface.png (seed 000, Fig. 5). All say what the label does.
[[nodiscard]] Status write_field_pictures(const std::filesystem::path& folder, const Mesh& mesh,
                                          const RigidTransform& tablet_from_model,
                                          const SurfaceFields& fields, const FileLabel& label,
                                          const JobContext& job);

/// Multi-scale integral invariants of every vertex, into GigaMesh's .mat; with a folder also
/// invariants.ply and invariants.png there, valleys red and ridges blue by the strongest response. vertex_of:
/// of which vertex of the mesh each line is (FiledMesh::vertex_of); empty: of each, in their order. All say
/// what the label does.
[[nodiscard]] Status write_invariants(const std::filesystem::path& mat,
                                      const std::filesystem::path& picture_folder, const Mesh& mesh,
                                      const RigidTransform& tablet_from_model, const SurfaceFields& fields,
                                      const IntegralInvariantOptions& options,
                                      const std::vector<std::uint32_t>& vertex_of, const FileLabel& label,
                                      const JobContext& job);

}  // namespace dubsar

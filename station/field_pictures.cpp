// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/field_pictures.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "analysis/body_fields.h"
#include "analysis/curvature.h"
#include "analysis/field_colours.h"
#include "archive/picture_words.h"
#include "archive/png.h"
#include "archive/six_views.h"
#include "formats/atomic_file.h"
#include "formats/feature_mat.h"
#include "formats/make_folder.h"
#include "formats/mesh_io.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
constexpr int kLongestPx = 700;

constexpr float kStrongResponse = 0.5F;
constexpr float kSurfaceCurvaturePerMm = 0.3F;

/// NAME.ply and NAME.png
Status write_coloured(const fs::path& folder, const std::string& name, const Mesh& coloured,
                      const RigidTransform& tablet_from_model, const FileLabel& label,
                      const JobContext& job) {
  if (const Status written = write_mesh(folder / (name + ".ply"), coloured, coloured_label(label));
      !written) {
    return written;
  }
  return write_six_view_picture(folder / (name + ".png"), coloured, tablet_from_model, label, job);
}

/// [lines × per_vertex], of the vertex that each line is of.
std::vector<float> by_line(const std::vector<float>& value, std::size_t per_vertex,
                           const std::vector<std::uint32_t>& vertex_of) {
  std::vector<float> out;
  out.reserve(vertex_of.size() * per_vertex);
  for (const std::uint32_t v : vertex_of) {
    const auto first = value.begin() + static_cast<std::ptrdiff_t>(v * per_vertex);
    out.insert(out.end(), first, first + static_cast<std::ptrdiff_t>(per_vertex));
  }
  return out;
}

/// Both have normals and nothing else beside.
void add_mesh(const Mesh& more, Mesh* mesh) {
  const auto first = static_cast<std::uint32_t>(mesh->positions.size());
  mesh->positions.insert(mesh->positions.end(), more.positions.begin(), more.positions.end());
  mesh->normals.insert(mesh->normals.end(), more.normals.begin(), more.normals.end());
  for (const auto& [a, b, c] : more.faces) {
    mesh->faces.push_back({a + first, b + first, c + first});
  }
}

}  // namespace

FileLabel coloured_label(const FileLabel& label) {
  FileLabel out = label;
  out.origin = kColouredByDubsar;
  return out;
}

Status write_six_view_picture(const fs::path& png, const Mesh& mesh, const RigidTransform& tablet_from_model,
                              const FileLabel& label, const JobContext& job) {
  SixViewOptions options;
  options.render.style = mesh.colours.empty() ? RenderStyle::kClay : RenderStyle::kColours;
  options.render.longest_px = kLongestPx;
  options.tablet_from_model = tablet_from_model;
  const auto sheet = render_six_view_sheet(RenderScene(mesh), options, job);
  if (!sheet) {
    return std::unexpected(sheet.error());
  }
  const auto bytes = encode_png(*sheet, picture_words(label, png.stem().string()));
  if (!bytes) {
    return std::unexpected(bytes.error());
  }
  return write_file_atomically(png, std::string(bytes->begin(), bytes->end()));
}

Status write_field_pictures(const fs::path& folder, const Mesh& mesh, const RigidTransform& tablet_from_model,
                            const SurfaceFields& fields, const FileLabel& label, const JobContext& job) {
  if (const Status made = make_folder(folder); !made) {
    return made;
  }
  Mesh coloured = mesh;
  coloured.normals = fields.normal;
  for (const SurfaceField field : kSurfaceFields) {
    coloured.colours = field_colours(fields, field);
    if (const Status written =
            write_coloured(folder, std::string(field_name(field)), coloured, tablet_from_model, label, job);
        !written) {
      return written;
    }
  }
  Mesh surface = fields.surface.mesh();
  for (const HeightSurface& further : fields.further_surfaces) {
    add_mesh(further.mesh(), &surface);
  }
  const VertexGraph graph = make_vertex_graph(surface);
  const Curvature curvature = vertex_curvature(surface, graph, make_vertex_geometry(surface, graph));
  surface.colours = diverging_colours(curvature.mean_per_mm, 0, kSurfaceCurvaturePerMm);
  return write_coloured(folder, "surface", surface, tablet_from_model, label, job);
}

Status write_invariants(const fs::path& mat, const fs::path& picture_folder, const Mesh& mesh,
                        const RigidTransform& tablet_from_model, const SurfaceFields& fields,
                        const IntegralInvariantOptions& options, const std::vector<std::uint32_t>& vertex_of,
                        const FileLabel& label, const JobContext& job) {
  const IntegralInvariants invariants =
      invariants_of_bodies(mesh, fields.body_of, outlook_of(mesh, fields), fields.mean_edge_mm, options, job);
  if (job.cancelled()) {
    return fail(ErrorKind::kCancelled, "the analysis was stopped");
  }
  std::string comment =
      "multi-scale integral invariants: vertex, then f = 2 V_below / V_sphere - 1 by radius\nradii mm:";
  for (const float r : invariants.radii_mm) {
    comment += fmt::format(" {:g}", r);
  }
  const std::size_t per_vertex = invariants.radii_mm.size();
  std::vector<float> lines;
  if (!vertex_of.empty()) {
    lines = by_line(invariants.value, per_vertex, vertex_of);
    comment += fmt::format("\nvertices: the {} of the mesh's file, which are {} places", vertex_of.size(),
                           mesh.positions.size());
  }
  comment.append("\n").append(label_lines(label, ""));
  if (const Status written =
          write_feature_mat(mat, vertex_of.empty() ? invariants.value : lines, per_vertex, comment);
      !written || picture_folder.empty()) {
    return written;
  }
  if (const Status made = make_folder(picture_folder); !made) {
    return made;
  }
  Mesh coloured = mesh;
  coloured.normals = fields.normal;
  coloured.colours = diverging_colours(strongest_response(invariants), 0, kStrongResponse);
  return write_coloured(picture_folder, "invariants", coloured, tablet_from_model, label, job);
}

}  // namespace dubsar

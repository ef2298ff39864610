// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/field_pictures.h"

#include <string>

#include "analysis/field_colours.h"
#include "archive/png.h"
#include "archive/six_views.h"
#include "core/tablet_frame.h"
#include "formats/atomic_file.h"
#include "formats/mesh_io.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
constexpr int kLongestPx = 1000;

}  // namespace

Status write_six_view_picture(const fs::path& png, const Mesh& mesh, const JobContext& job) {
  SixViewOptions options;
  options.render.style = mesh.colours.empty() ? RenderStyle::kClay : RenderStyle::kColours;
  options.render.longest_px = kLongestPx;
  options.tablet_from_model = tablet_frame(mesh);
  const auto sheet = render_six_view_sheet(RenderScene(mesh), options, job);
  if (!sheet) {
    return std::unexpected(sheet.error());
  }
  const auto bytes = encode_png(*sheet, png.stem().string());
  if (!bytes) {
    return std::unexpected(bytes.error());
  }
  return write_file_atomically(png, std::string(bytes->begin(), bytes->end()));
}

Status write_field_pictures(const fs::path& folder, const Mesh& mesh, const SurfaceFields& fields,
                            const JobContext& job) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    return fail(ErrorKind::kStorage, error.message(), folder.string(), "choose a folder that can be written");
  }
  Mesh coloured = mesh;
  coloured.normals = fields.normal;
  for (const SurfaceField field : kSurfaceFields) {
    coloured.colours = field_colours(fields, field);
    const std::string name(field_name(field));
    if (const Status written = write_mesh(folder / (name + ".ply"), coloured); !written) {
      return written;
    }
    if (const Status drawn = write_six_view_picture(folder / (name + ".png"), coloured, job); !drawn) {
      return drawn;
    }
  }
  return {};
}

}  // namespace dubsar

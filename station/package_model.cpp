// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The mesh of a package, once for keeping, once for looking at and once for printing; where it is
// asked for, once compressed for sending.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>

#include "core/parallel.h"
#include "formats/draco_mesh.h"
#include "formats/mesh_io.h"
#include "station/package_content.h"

namespace dubsar {

namespace {

/// The compressed form, beside the plain one: what is to be opened in fifty years needs no decompressor. By
/// itself behind the others, since it takes much memory.
Status add_compressed_model(PackageContent& content) {
  const std::string path = "model/" + content.stem + ".draco.glb";
  content.job.progress("compressing the model", 0);
  if (const Status written = write_mesh(content.root / path, content.mesh(), content.label, &content.job);
      !written) {
    if (written.error().kind != ErrorKind::kUsage) {
      return written;
    }
    content.lacking.push_back(path + ": " + written.error().what + ".");
    return {};
  }
  constexpr double kMicrometresPerMm = 1000;
  content.list(
      path, fmt::format("the same surface, compressed for sending (glTF 2.0, metres, for programs that know "
                        "KHR_draco_mesh_compression): no position is moved by as much as {:.4f} micrometres "
                        "on any axis, no normal turned by more than {} degrees; vertices and faces stand in "
                        "another order",
                        kMicrometresPerMm * draco_step_mm(content.mesh()), kDracoNormalError_deg));
  return {};
}

}  // namespace

Status add_model(PackageContent& content) {
  if (content.mesh().faces.empty()) {
    content.lacking.emplace_back(
        std::ranges::any_of(content.results().poses,
                            [](const ScanPose& pose) { return pose.status == PoseStatus::kRegistered; })
            ? "There is no model: the registered scans have no surface."
            : "There is no model, nor what is made of one: no scan is registered that stands and can be "
              "read.");
    return {};
  }
  struct Form {
    const char* extension;
    const char* what;
  };
  // The slowest to write first: two of the three are then written side by side.
  constexpr std::array<Form, 3> kForms = {
      {{".ply",
        "the model, for keeping: millimetres, with normals, reliability, number of scans, standard "
        "deviation and flags of every vertex: formats/mesh.txt"},
       {".stl", "the same surface for printing in 1:1 (binary STL, millimetres)"},
       {".glb", "the same surface for looking at (glTF 2.0, metres)"}}};
  if (const auto made = content.place("model/x"); !made) {
    return std::unexpected(made.error());
  }
  std::array<std::optional<Error>, kForms.size()> failed;
  std::atomic<int> done{0};
  parallel_for_each_index(
      kForms.size(),
      [&](std::size_t k) {
        if (content.job.cancelled()) {
          return;
        }
        if (const Status written = write_mesh(content.root / "model" / (content.stem + kForms[k].extension),
                                              content.mesh(), content.label);
            !written) {
          failed[k] = written.error();
        }
        content.job.progress("packing the model", (done.fetch_add(1) + 1.0) / kForms.size());
      },
      1);
  if (content.job.cancelled()) {
    return fail(ErrorKind::kCancelled, "stopped");
  }
  for (std::size_t k = 0; k < kForms.size(); ++k) {
    if (failed[k] && failed[k]->kind == ErrorKind::kUsage) {
      content.lacking.push_back("model/" + content.stem + kForms[k].extension + ": " + failed[k]->what + ".");
      continue;  // larger than that format can hold: the PLY has everything
    }
    if (failed[k]) {
      return std::unexpected(*failed[k]);
    }
    content.list("model/" + content.stem + kForms[k].extension, kForms[k].what);
  }
  return content.options.draco ? add_compressed_model(content) : Status();
}

}  // namespace dubsar

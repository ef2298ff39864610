// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/mat_lines.h"

#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <string>

#include "core/log.h"
#include "core/result.h"

namespace dubsar {

std::vector<std::uint32_t> lines_of_mat(const AnalyzeArguments& arguments, const MeshInItsUnit& read) {
  const std::size_t of_mesh = read.mesh.positions.size();
  if (arguments.invariants.empty() || read.file_vertices == of_mesh) {
    return {};
  }
  const std::string file = std::filesystem::path(arguments.in).filename().string();
  const auto warn = [&](std::size_t lines, const std::string& of, std::size_t others,
                        const std::string& not_of, const std::string& mend) {
    log_warning(Error{
        ErrorKind::kBadInput,
        fmt::format("its lines are of the {} vertices of {}, not of the {} of {}", lines, of, others, not_of),
        arguments.invariants, mend}
                    .line());
  };
  if (read.vertex_of.empty()) {
    warn(of_mesh, "the measured mesh", read.file_vertices, file, "use the vertices of --mesh-out");
  } else if (!arguments.mesh_out.empty()) {
    warn(read.file_vertices, file, of_mesh, arguments.mesh_out, "load it with " + file);
  }
  return read.vertex_of;
}

}  // namespace dubsar

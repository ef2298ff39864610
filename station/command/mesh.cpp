// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar mesh check | convert.

#include <cstdio>
#include <memory>

#include "core/units.h"
#include "formats/mesh_io.h"
#include "station/command/command.h"
#include "station/mesh_json.h"
#include "triangulation/mesh_check.h"

namespace dubsar {

namespace {

struct MeshOptions {
  std::string in;
  std::string out;
  std::string unit;
};

Result<Mesh> read(const MeshOptions& options) {
  return read_mesh(options.in,
                   {.mm_per_unit = options.unit.empty() ? std::nullopt : mm_per_unit(options.unit)});
}

Result<int> check(const MeshOptions& options, CommandContext& context) {
  const Result<Mesh> mesh = read(options);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  const MeshReport report = check_mesh(*mesh);
  const nlohmann::ordered_json json = mesh_report_json(report);
  if (context.json) {
    CommandContext::print(json);
  } else {
    for (const auto& [key, value] : json.items()) {
      std::printf("%-24s %s\n", key.c_str(), value.dump().c_str());
    }
  }
  return report.is_manifold() ? 0 : 1;
}

Result<int> convert(const MeshOptions& options, CommandContext& context) {
  const Result<Mesh> mesh = read(options);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  if (const Status written = write_mesh(options.out, *mesh); !written) {
    return std::unexpected(written.error());
  }
  if (context.json) {
    CommandContext::print(
        {{"mesh", options.out}, {"vertices", mesh->positions.size()}, {"faces", mesh->faces.size()}});
  } else {
    std::printf("%s: %zu vertices, %zu faces\n", options.out.c_str(), mesh->positions.size(),
                mesh->faces.size());
  }
  return 0;
}

}  // namespace

void add_mesh(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("mesh", "Topology and size of a mesh; formats");
  verb->require_subcommand(1);
  verb->fallthrough();
  const auto options = std::make_shared<MeshOptions>();
  CLI::App* check_verb =
      verb->add_subcommand("check", "Topology and size of a mesh; status 1 when it is no 2-manifold");
  check_verb->add_option("mesh", options->in, "PLY, OBJ, STL or GLB")->required();
  check_verb->fallthrough();
  check_verb->callback(
      [&chosen, options] { chosen = [options](CommandContext& c) { return check(*options, c); }; });
  CLI::App* convert_verb =
      verb->add_subcommand("convert", "From one format to another, by the names' endings");
  convert_verb->add_option("in", options->in)->required();
  convert_verb->add_option("out", options->out)->required();
  convert_verb->fallthrough();
  convert_verb->callback(
      [&chosen, options] { chosen = [options](CommandContext& c) { return convert(*options, c); }; });
  for (CLI::App* sub : {check_verb, convert_verb}) {
    sub->add_option("--unit", options->unit, "what the file's numbers are")
        ->check(CLI::IsMember({"m", "mm", "um"}));
  }
}

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar mesh check | convert | section | part.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "analysis/cross_section.h"
#include "archive/wedge_table.h"
#include "core/inside_out.h"
#include "core/log.h"
#include "core/units.h"
#include "formats/atomic_file.h"
#include "formats/file_label_reader.h"
#include "formats/mesh_formats.h"
#include "formats/mesh_io.h"
#include "formats/mesh_losses.h"
#include "formats/ply_of_unknown_unit.h"
#include "formats/wedges_json.h"
#include "station/command/command.h"
#include "station/command/outputs.h"
#include "station/command/place_option.h"
#include "station/mesh_json.h"
#include "station/mesh_unit_doubt.h"
#include "station/outward_faces.h"
#include "station/section_file.h"
#include "station/selection_store.h"
#include "station/wedges_beside.h"
#include "triangulation/mesh_check.h"

namespace dubsar {

namespace {

struct MeshOptions {
  std::string in;
  std::string out;
  std::string unit;
  std::string from, to, towards;              ///< of a section
  std::string selection, selections, wedges;  ///< of a part
  bool turn_over = false;
};

/// `passed_over`: where it is given, MeshReadOptions::passed_over.
Result<Mesh> read(const MeshOptions& options, const CommandContext& context,
                  std::vector<std::string>* passed_over = nullptr) {
  return read_mesh(options.in,
                   {.mm_per_unit = options.unit.empty() ? std::nullopt : mm_per_unit(options.unit),
                    .passed_over = passed_over,
                    .job = &context.job});
}

/// What a unit that nobody said makes doubtful; said in the log.
std::optional<Error> doubt_unit(const MeshOptions& options, const Mesh& mesh) {
  std::optional<Error> doubt = options.unit.empty() ? unit_doubt(mesh, options.in, options.in) : std::nullopt;
  if (doubt) {
    log_warning(doubt->line());
  }
  return doubt;
}

nlohmann::ordered_json words_of(const std::optional<Error>& doubt) {
  return doubt ? nlohmann::ordered_json(doubt->what) : nlohmann::ordered_json(nullptr);
}

/// As the viewer has it, in which selections are made: where nobody said the unit, in the one that its size
/// tells. `unit_known`: whether it tells one.
Result<Mesh> read_as_viewed(const MeshOptions& options, const CommandContext& context,
                            std::vector<std::string>* passed_over, bool* unit_known) {
  Result<Mesh> mesh = read(options, context, passed_over);
  if (!mesh || !doubt_unit(options, *mesh)) {
    return mesh;
  }
  const Result<UnitBySize> told = unit_by_size(*mesh, options.in);
  *unit_known = told.has_value();
  if (!told || told->taken_for.empty()) {
    return mesh;
  }
  MeshOptions taken = options;
  taken.unit = told->taken_for;
  passed_over->clear();
  return read(taken, context, passed_over);
}

/// With what the file that was read says of itself, and a word on what the new one cannot hold. Where nobody
/// knows the unit a PLY does not say that it is one of millimetres.
Status write(const MeshOptions& options, const CommandContext& context, const Mesh& mesh,
             const std::vector<std::string>& passed_over, bool unit_known) {
  const FileLabel label = read_mesh_label(options.in);
  const Status written = unit_known || format_of(options.out) != MeshFormat::kPly
                             ? write_mesh(options.out, mesh, label, &context.job)
                             : write_ply_of_unknown_unit(options.out, mesh, label);
  if (!written) {
    return written;
  }
  if (const std::optional<Error> lost = mesh_losses(mesh, options.out, "keep " + options.in, passed_over)) {
    log_warning(lost->line());
  }
  return {};
}

Result<int> check(const MeshOptions& options, CommandContext& context) {
  const Result<Mesh> mesh = read(options, context);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  const MeshReport report = check_mesh(*mesh, context.job);
  if (context.job.cancelled()) {
    return fail(ErrorKind::kCancelled, "the check was stopped", options.in);
  }
  nlohmann::ordered_json json = mesh_report_json(report);
  const std::optional<Error> fault = inside_out(*mesh, options.in);
  json["inside_out"] = fault.has_value();
  json["unit_doubt"] = words_of(doubt_unit(options, *mesh));
  if (context.json) {
    CommandContext::print(json);
  } else {
    for (const auto& [key, value] : json.items()) {
      std::printf("%-24s %s\n", key.c_str(), value.dump().c_str());
    }
  }
  if (fault) {
    log_warning(fault->line());
  }
  return report.is_manifold() ? 0 : 1;
}

Result<int> convert(const MeshOptions& options, CommandContext& context) {
  std::vector<std::string> passed_over;
  Result<Mesh> mesh = read(options, context, &passed_over);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  if (options.turn_over) {
    turn_over(&*mesh);
  }
  if (std::optional<Error> fault = inside_out(*mesh, options.turn_over ? options.out : options.in)) {
    if (options.turn_over) {
      fault->what = "its faces looked outwards, and look inwards now";
      fault->mend = "convert it again without --turn-over";
    }
    log_warning(fault->line());
  }
  const bool unit_known = !doubt_unit(options, *mesh);
  if (const Status written = write(options, context, *mesh, passed_over, unit_known); !written) {
    return std::unexpected(written.error());
  }
  const LeftOut out = left_out_of(*mesh, options.out);
  const std::size_t vertices = mesh->positions.size() - out.vertices;
  const std::size_t faces = mesh->faces.size() - out.faces;
  if (context.json) {
    CommandContext::print({{"mesh", options.out}, {"vertices", vertices}, {"faces", faces}});
  } else {
    std::printf("%s: %zu vertices, %zu faces\n", options.out.c_str(), vertices, faces);
  }
  return 0;
}

/// It ran, but there is nothing to draw: one line, and no file.
int nothing_cut(const MeshOptions& options, const CommandContext& context) {
  const Error nothing{ErrorKind::kBadInput, "nothing is cut between the two places, and nothing is written",
                      options.in, "say two places of its surface, and --towards out of it there"};
  log_warning(nothing.line());
  if (context.json) {
    CommandContext::print({{"file", nullptr}, {"pieces", 0}});
  }
  return 1;
}

/// Heights are over the line between the two places: off the surface it is a line of their own choice.
void warn_of_place_off(const CrossSection& cut, const Eigen::Vector3d& place_mm, const char* option,
                       const std::string& mesh) {
  constexpr double kTypedMm = 0.1;  ///< so far a place may be rounded
  double off_mm = std::numeric_limits<double>::infinity();
  for (const auto& piece : cut.lines) {
    for (const CrossSection::Point& point : piece) {
      off_mm = std::min(off_mm, (point.place_mm - place_mm).norm());
    }
  }
  if (off_mm > kTypedMm) {
    log_warning(Error{ErrorKind::kUsage,
                      fmt::format("the place of {} lies {:.2f} mm from the surface that is cut, and heights "
                                  "are over the line through it",
                                  option, off_mm),
                      mesh, "say a place of the surface where heights are to be over it"}
                    .line());
  }
}

Result<int> section(const MeshOptions& options, CommandContext& context) {
  const Result<Eigen::Vector3d> from = place_of(options.from, "--from");
  const Result<Eigen::Vector3d> to = place_of(options.to, "--to");
  const Result<Eigen::Vector3d> towards = place_of(options.towards, "--towards");
  for (const auto* place : {&from, &to, &towards}) {
    if (!*place) {
      return std::unexpected(place->error());
    }
  }
  Result<Mesh> mesh = read(options, context);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  const std::optional<Error> doubt = doubt_unit(options, *mesh);
  face_outwards(&*mesh, options.in);
  const Result<CrossSection> cut = cross_section(*mesh, *from, *to, *towards);
  if (!cut) {
    return std::unexpected(cut.error());
  }
  if (cut->lines.empty()) {
    return nothing_cut(options, context);
  }
  if (const Status written = write_section(*cut, options.out, read_file_label(options.in)); !written) {
    return std::unexpected(written.error());
  }
  warn_of_place_off(*cut, *from, "--from", options.in);
  warn_of_place_off(*cut, *to, "--to", options.in);
  if (context.json) {
    CommandContext::print({{"file", options.out},
                           {"pieces", cut->lines.size()},
                           {"length_mm", cut->length_mm},
                           {"lowest_mm", cut->lowest_mm},
                           {"lowest_along_mm", cut->lowest_along_mm},
                           {"highest_mm", cut->highest_mm},
                           {"unit_doubt", words_of(doubt)}});
  } else {
    std::printf("%s: %.3f mm long, %.3f mm below the line at %.3f mm\n", options.out.c_str(), cut->length_mm,
                -cut->lowest_mm, cut->lowest_along_mm);
  }
  return 0;
}

/// The file that the selection is in.
std::string selections_of(const MeshOptions& options) {
  return !options.selections.empty() ? options.selections
         : options.in.empty()        ? std::string()
                                     : selections_file_of(options.in).string();
}

/// What a selection of the viewer holds: a mesh, or a table of its wedges.
Result<int> part(const MeshOptions& options, CommandContext& context) {
  std::vector<std::string> passed_over;
  bool unit_known = true;
  const Result<Mesh> mesh = read_as_viewed(options, context, &passed_over, &unit_known);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  const Result<MeshSelection> selection = kept_selection(selections_of(options), *mesh, options.selection);
  if (!selection) {
    return std::unexpected(selection.error());
  }
  if (!options.wedges.empty()) {
    const Result<WedgeFile> all = read_wedges(options.wedges);
    if (!all) {
      return std::unexpected(all.error());
    }
    if (!all->mesh.empty() && !are_of(*all, options.in)) {
      log_warning(Error{ErrorKind::kBadInput,
                        "these wedges are of " + std::filesystem::path(all->mesh).filename().string() +
                            ", not of " + std::filesystem::path(options.in).filename().string(),
                        options.wedges,
                        "name the wedges of this mesh, unless it is the same under another name"}
                      .line());
    }
    const std::vector<Wedge> wedges = selected_wedges(all->wedges, *mesh, *selection);
    if (const Status written =
            write_file_atomically(options.out, wedge_table(wedges, read_file_label(options.in)));
        !written) {
      return std::unexpected(written.error());
    }
    if (context.json) {
      CommandContext::print({{"file", options.out}, {"wedges", wedges.size()}});
    } else {
      std::printf("%s: %zu of %zu wedges\n", options.out.c_str(), wedges.size(), all->wedges.size());
    }
    return wedges.empty() ? 1 : 0;
  }
  const Mesh out = part_of(*mesh, *selection);
  if (const Status written = write(options, context, out, passed_over, unit_known); !written) {
    return std::unexpected(written.error());
  }
  if (context.json) {
    CommandContext::print(
        {{"file", options.out}, {"vertices", out.positions.size()}, {"faces", out.faces.size()}});
  } else {
    std::printf("%s: %zu vertices, %zu faces\n", options.out.c_str(), out.positions.size(), out.faces.size());
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
  CLI::App* convert_verb = verb->add_subcommand(
      "convert", "From one format to another, by the names' endings; says what the new one cannot hold");
  convert_verb->add_option("in", options->in, "PLY, OBJ, STL or GLB")->required();
  convert_verb->add_option("out", options->out, "the same: .ply, .obj, .stl or .glb; .draco.glb compresses")
      ->required();
  convert_verb->add_flag("--turn-over", options->turn_over,
                         "the faces look the other way: for one inside out");
  convert_verb->fallthrough();
  convert_verb->callback([&chosen, options] {
    chosen = with_safe_outputs({options->out}, [options](CommandContext& c) { return convert(*options, c); },
                               {options->in});
  });
  CLI::App* section_verb = verb->add_subcommand(
      "section", "The profile of a cut between two places of the surface; status 1 when nothing is cut");
  section_verb->add_option("mesh", options->in, "PLY, OBJ, STL or GLB")->required();
  section_verb->add_option("--from", options->from, "x,y,z in mm")->required();
  section_verb->add_option("--to", options->to, "x,y,z in mm")->required();
  section_verb->add_option("--towards", options->towards, "out of the surface, against the cut")
      ->default_val("0,0,1");
  section_verb->add_option("-o,--out", options->out, "profile.csv or profile.svg, in mm, 1:1")->required();
  section_verb->fallthrough();
  section_verb->callback([&chosen, options] {
    chosen = with_safe_outputs({options->out}, [options](CommandContext& c) { return section(*options, c); },
                               {options->in});
  });
  CLI::App* part_verb = verb->add_subcommand(
      "part", "What a selection kept in the viewer holds: a mesh, or with --wedges a table");
  part_verb->add_option("mesh", options->in, "PLY, OBJ, STL or GLB")->required();
  part_verb->add_option("--selection", options->selection, "its name")->required();
  part_verb->add_option("--selections", options->selections,
                        "the file it is in; without it the one beside the mesh, or the session's");
  part_verb->add_option("--wedges", options->wedges, "wedges.json: write the selected ones as CSV");
  part_verb->add_option("-o,--out", options->out, "part.ply, or wedges.csv")->required();
  part_verb->fallthrough();
  part_verb->callback([&chosen, options] {
    chosen = with_safe_outputs({options->out}, [options](CommandContext& c) { return part(*options, c); },
                               {options->in, options->wedges, selections_of(*options)});
  });
  for (CLI::App* sub : {check_verb, convert_verb, section_verb, part_verb}) {
    sub->add_option("--unit", options->unit, "what the file's numbers are; default: its own word, else mm")
        ->check(CLI::IsMember(std::vector<std::string>(kLengthUnits.begin(), kLengthUnits.end())));
  }
}

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar wedges correct: what a person says about the wedges that were found.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <utility>

#include "core/log.h"
#include "core/units.h"
#include "formats/atomic_file.h"
#include "formats/corrections_json.h"
#include "formats/mesh_io.h"
#include "formats/wedges_json.h"
#include "station/command/analyze.h"
#include "station/command/option_checks.h"
#include "station/command/outputs.h"
#include "station/command/place_option.h"
#include "station/correction_region.h"
#include "station/selection_store.h"
#include "station/wedges_beside.h"

namespace dubsar {

namespace {

struct CorrectArguments {
  AnalyzeArguments analyze;
  std::vector<int> remove;
  std::vector<int> merge;
  int split = -1;
  std::vector<std::string> into;
  std::string add;
  std::string add_at;
  double reach_mm = 0;
  bool undo = false;
  bool list = false;
};

constexpr const char* kKinds[] = {"delete", "merge", "split", "add"};

Result<std::vector<Eigen::Vector3d>> depth_points(const std::string& wedges_json,
                                                  const std::vector<int>& ids) {
  std::error_code ignored;
  if (!std::filesystem::exists(wedges_json, ignored)) {
    return fail(ErrorKind::kUsage, "the wedges whose ids are named have not been found yet", wedges_json,
                "run `dubsar analyze MESH -o " + wedges_json + "` first");
  }
  const Result<WedgeFile> file = read_wedges(wedges_json);
  if (!file) {
    return std::unexpected(file.error());
  }
  std::vector<Eigen::Vector3d> places;
  for (const int id : ids) {
    const auto wedge = std::ranges::find(file->wedges, id, &Wedge::id);
    if (wedge == file->wedges.end()) {
      return fail(ErrorKind::kUsage, fmt::format("there is no wedge {}", id), wedges_json,
                  "the ids are those in this file");
    }
    places.push_back(wedge->depth_point_mm);
  }
  return places;
}

/// Ids, and what was said before, are of the mesh that the wedges were found on.
Status check_same_mesh(const AnalyzeArguments& a) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(a.out, ignored) || !std::filesystem::is_regular_file(a.in, ignored)) {
    return {};
  }
  const Result<WedgeFile> file = read_wedges(a.out);
  if (!file || file->mesh.empty() || are_of(*file, a.in)) {
    return {};  // what cannot be read is said where it is used
  }
  return fail(
      ErrorKind::kUsage,
      fmt::format("these wedges are of {}, not of {}", std::filesystem::path(file->mesh).filename().string(),
                  std::filesystem::path(a.in).filename().string()),
      a.out, "name that mesh, or a file of this one's own, such as NAME.wedges.json");
}

/// What was said before is in the wedges, and would pass out of them.
Status check_said_before(const AnalyzeArguments& a, const std::filesystem::path& where) {
  std::error_code ignored;
  if (std::filesystem::exists(where, ignored) || !std::filesystem::is_regular_file(a.out, ignored)) {
    return {};
  }
  const Result<WedgeFile> file = read_wedges(a.out);
  if (!file || file->corrections == 0) {
    return {};
  }
  return fail(ErrorKind::kUsage,
              fmt::format("these wedges were corrected before ({}), and {} is not there", file->corrections,
                          where.filename().string()),
              a.out,
              "name the file that has these corrections with --corrections, or run `dubsar analyze` first, "
              "which measures without them");
}

/// Nothing that is said may pass unheard.
Status check_asked(const CorrectArguments& a) {
  const int asked = (a.remove.empty() ? 0 : 1) + (a.merge.empty() ? 0 : 1) + (a.split >= 0 ? 1 : 0) +
                    (a.add.empty() ? 0 : 1) + (a.add_at.empty() ? 0 : 1) + (a.undo ? 1 : 0) +
                    (a.list ? 1 : 0);
  if (asked != 1) {
    return fail(ErrorKind::kUsage,
                asked == 0 ? "it is not said what is to be corrected" : "only one thing is said at a time",
                "wedges correct", "say one of --delete, --merge, --split, --add, --add-at, --undo, --list");
  }
  if (!a.into.empty() && a.split < 0) {
    return fail(ErrorKind::kUsage, "only a split goes into several places", "--into",
                "say which wedge: --split 7 --into x,y,z --into x,y,z");
  }
  if (a.reach_mm > 0 && a.add_at.empty()) {
    return fail(ErrorKind::kUsage, "only a wedge that is added at a place is told its reach", "--reach",
                "say where: --add-at x,y,z --reach 3");
  }
  return {};
}

/// The unit that the mesh is measured in: the one that is said, or that its analysis took it for.
std::optional<double> mm_per_unit_of(const CorrectArguments& a) {
  if (!a.analyze.unit.empty()) {
    return mm_per_unit(a.analyze.unit);
  }
  const Result<WedgeFile> file = read_wedges(a.analyze.out);
  return file ? mm_per_unit(file->unit_assumed) : std::nullopt;
}

/// The correction that is asked for; its kind follows from the options.
Result<WedgeCorrection> asked_for(const CorrectArguments& a) {
  WedgeCorrection out;
  if (!a.add_at.empty()) {
    const Result<Eigen::Vector3d> place = place_of(a.add_at, "--add-at");
    if (!place) {
      return std::unexpected(place.error());
    }
    if (!(a.reach_mm > 0)) {
      return fail(ErrorKind::kUsage, "--add-at does not say how far the wedge reaches", "--reach",
                  "say it in mm, about its longest edge");
    }
    out.kind = CorrectionKind::kAdd;
    out.region_mm = {*place};
    out.reach_mm = a.reach_mm;
    return out;
  }
  if (!a.add.empty()) {
    const Result<Mesh> mesh = read_mesh(a.analyze.in, {.mm_per_unit = mm_per_unit_of(a)});
    if (!mesh) {
      return std::unexpected(mesh.error());
    }
    const Result<MeshSelection> selection = kept_selection(selections_file_of(a.analyze.in), *mesh, a.add);
    if (!selection) {
      return std::unexpected(selection.error());
    }
    return addition_of(*mesh, *selection);
  }
  const std::vector<int> ids = a.split >= 0 ? std::vector{a.split} : a.merge.empty() ? a.remove : a.merge;
  Result<std::vector<Eigen::Vector3d>> at = depth_points(a.analyze.out, ids);
  if (!at) {
    return std::unexpected(at.error());
  }
  out.at_mm = *std::move(at);
  out.kind = a.split >= 0      ? CorrectionKind::kSplit
             : a.merge.empty() ? CorrectionKind::kDelete
                               : CorrectionKind::kMerge;
  if (out.kind == CorrectionKind::kMerge && ids.size() < 2) {
    return fail(ErrorKind::kUsage, "one wedge is nothing to merge", "--merge",
                "name two or more: --merge 3,4");
  }
  for (const std::string& text : a.into) {
    const Result<Eigen::Vector3d> place = place_of(text, "--into");
    if (!place) {
      return std::unexpected(place.error());
    }
    out.into_mm.push_back(*place);
  }
  if (out.kind == CorrectionKind::kSplit && out.into_mm.size() < 2) {
    return fail(ErrorKind::kUsage, "a split goes into two wedges or more", "--into",
                "say a place in each: --split 7 --into x,y,z --into x,y,z");
  }
  return out;
}

int list(const CorrectionFile& file, const CommandContext& context) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < file.corrections.size(); ++k) {
    const WedgeCorrection& one = file.corrections[k];
    const Eigen::Vector3d& at = one.at_mm.empty() ? one.region_mm.front() : one.at_mm.front();
    const char* kind = kKinds[static_cast<std::size_t>(one.kind)];
    if (context.json) {
      json.push_back({{"number", k + 1}, {"do", kind}, {"at", {at.x(), at.y(), at.z()}}});
    } else {
      std::printf("%zu  %-6s  at %.3f, %.3f, %.3f mm\n", k + 1, kind, at.x(), at.y(), at.z());
    }
  }
  if (context.json) {
    CommandContext::print({{"corrections", std::move(json)}});
  }
  return 0;
}

bool same(const WedgeCorrection& a, const WedgeCorrection& b) {
  return a.kind == b.kind && a.at_mm == b.at_mm && a.into_mm == b.into_mm && a.region_mm == b.region_mm &&
         a.reach_mm == b.reach_mm;
}

/// Takes the last one back, unless that was noted before and the disk took no more then: what is missing is
/// the rest, for the wedges still have it.
Status take_back_last(CorrectionFile& said, const CorrectArguments& arguments,
                      const std::filesystem::path& where) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(arguments.analyze.out, ignored)) {
    const Result<WedgeFile> file = read_wedges(arguments.analyze.out);
    if (file && file->corrections > said.corrections.size()) {
      log_info("a correction was taken back before and the wedges still have it: they are measured again");
      return {};
    }
  }
  if (said.corrections.empty()) {
    return fail(ErrorKind::kUsage, "there is no correction to undo", where.string());
  }
  said.corrections.pop_back();
  return {};
}

Result<int> correct(const CorrectArguments& arguments, CommandContext& context) {
  if (const Result<std::string> head = read_file_head(arguments.analyze.in, 1); !head) {
    return std::unexpected(head.error());  // whatever else is wrong: a name that was mistyped comes first
  }
  if (const Status asked = check_asked(arguments); !asked) {
    return std::unexpected(asked.error());
  }
  const std::filesystem::path where = corrections_of(arguments.analyze);
  Result<CorrectionFile> said = read_corrections(where);
  if (!said) {
    return std::unexpected(said.error());
  }
  if (arguments.list) {
    return list(*said, context);
  }
  if (const Status same_mesh = check_same_mesh(arguments.analyze); !same_mesh) {
    return std::unexpected(same_mesh.error());
  }
  if (const Status known = check_said_before(arguments.analyze, where); !known) {
    return std::unexpected(known.error());
  }
  AnalyzeArguments analysis = arguments.analyze;
  analysis.known = said->corrections;
  if (arguments.undo) {
    if (const Status taken = take_back_last(*said, arguments, where); !taken) {
      return std::unexpected(taken.error());
    }
  } else {
    Result<WedgeCorrection> next = asked_for(arguments);
    if (!next) {
      return std::unexpected(next.error());
    }
    // It was noted before, and the disk took no more then: what is missing is the rest.
    if (said->corrections.empty() || !same(said->corrections.back(), *next)) {
      said->corrections.push_back(*std::move(next));
    }
    analysis.must_make_last = true;
  }
  analysis.corrected = std::move(said->corrections);
  analysis.again = true;
  return analyze(analysis, context);
}

}  // namespace

void add_wedges(CLI::App& app, Action& chosen) {
  CLI::App* verb = app.add_subcommand("wedges", "What a person says about the wedges that were found");
  verb->require_subcommand(1);
  verb->fallthrough();
  CLI::App* correct_verb = verb->add_subcommand(
      "correct", "Delete, merge, split or add a wedge: noted beside the output, and all measured again");
  const auto arguments = std::make_shared<CorrectArguments>();
  add_analyze_options(*correct_verb, arguments->analyze);
  correct_verb->add_option("--delete", arguments->remove, "ids of what is no wedge")->delimiter(',');
  correct_verb->add_option("--merge", arguments->merge, "ids of what is one wedge")->delimiter(',');
  correct_verb->add_option("--split", arguments->split, "id of what is several wedges; with --into")
      ->check(not_negative());
  correct_verb->add_option("--into", arguments->into, "x,y,z in mm: the deepest place of one of them")
      ->expected(1)
      ->take_all();
  correct_verb->add_option("--add", arguments->add,
                           "name of a selection kept in the viewer: a wedge is there");
  correct_verb->add_option("--add-at", arguments->add_at, "x,y,z in mm: a wedge is there; with --reach");
  correct_verb->add_option("--reach", arguments->reach_mm, "mm, how far around that place")
      ->check(in_range(0.05, 50.0));
  correct_verb->add_flag("--undo", arguments->undo, "takes the last correction back");
  correct_verb->add_flag("--list", arguments->list, "says what was corrected so far");
  correct_verb->fallthrough();
  correct_verb->callback([&chosen, arguments, correct_verb] {
    take_known_options(arguments->analyze,
                       [correct_verb](const char* name) { return correct_verb->count(name) > 0; });
    std::vector<std::string> written = written_by(arguments->analyze);
    written.push_back(corrections_of(arguments->analyze).string());
    chosen = with_safe_outputs(std::move(written),
                               [arguments](CommandContext& c) { return correct(*arguments, c); },
                               {arguments->analyze.in});
  });
}

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar analyze: the wedges of a mesh.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "analysis/field_colours.h"
#include "archive/wedge_drawing.h"
#include "core/log.h"
#include "core/number_text.h"
#include "core/stage_times.h"
#include "formats/file_label_reader.h"
#include "formats/mesh_io.h"
#include "station/analysis.h"
#include "station/command/analyze.h"
#include "station/command/mat_lines.h"
#include "station/command/mesh_unit.h"
#include "station/command/outputs.h"
#include "station/done_stamp.h"
#include "station/earlier_wedges.h"
#include "station/field_pictures.h"
#include "station/outward_faces.h"
#include "station/place_outside.h"
#include "station/same_tablet.h"
#include "station/tablet_label.h"
#include "station/wedge_doubts.h"

namespace dubsar {

namespace {

nlohmann::ordered_json summary_json(const AnalyzeArguments& arguments, const WedgeFile& file) {
  nlohmann::ordered_json json{{"wedges", arguments.out},
                              {"mesh", file.mesh},
                              {"count", file.wedges.size()},
                              {"rejected", file.rejected.size()}};
  if (!file.unit_assumed.empty()) {
    json["unit_assumed"] = file.unit_assumed;
  }
  if (!arguments.mesh_out.empty()) {
    json["mesh_out"] = arguments.mesh_out;
  }
  json["timings_s"] = nlohmann::ordered_json::object();
  for (const auto& [stage, seconds] : file.timings_s) {
    json["timings_s"][stage] = seconds;
  }
  return json;
}

/// The surface fields, and the wedges in colours, each as PLY and as PNG of six views.
Status draw_pictures(const std::filesystem::path& folder, const Mesh& mesh, const Analysis& analysis,
                     const FileLabel& label, const JobContext& job) {
  const RigidTransform& lies = analysis.text.text_from_model;
  if (Status drawn = write_field_pictures(folder, mesh, lies, analysis.fields, label, job); !drawn) {
    return drawn;
  }
  const Mesh coloured = annotated_mesh(mesh, analysis);
  if (Status written = write_mesh(folder / "wedges.ply", coloured, coloured_label(label)); !written) {
    return written;
  }
  return write_six_view_picture(folder / "wedges.png", coloured, lies, label, job);
}

Status write_extras(const AnalyzeArguments& arguments, const Mesh& mesh, const Analysis& analysis,
                    const std::vector<std::uint32_t>& lines, const FileLabel& label, const JobContext& job) {
  if (!arguments.pictures.empty()) {
    if (const Status written = draw_pictures(arguments.pictures, mesh, analysis, label, job); !written) {
      return written;
    }
  }
  if (!arguments.invariants.empty()) {
    return write_invariants(arguments.invariants, arguments.pictures, mesh, analysis.text.text_from_model,
                            analysis.fields, {.radius_mm = arguments.radius_mm}, lines, label, job);
  }
  return {};
}

/// Those in the folder of the pictures have names of their own, which a mesh in that folder may have, too.
Status check_files_apart(const AnalyzeArguments& arguments) {
  if (arguments.pictures.empty()) {
    return {};
  }
  std::vector<std::string> names{"surface", "wedges"};
  for (const SurfaceField field : kSurfaceFields) {
    names.emplace_back(field_name(field));
  }
  if (!arguments.invariants.empty()) {
    names.emplace_back("invariants");
  }
  std::vector<std::string> files{arguments.out, arguments.mesh_out, arguments.invariants};
  for (const std::string& name : names) {
    files.push_back((std::filesystem::path(arguments.pictures) / (name + ".ply")).string());
  }
  return check_apart(files, {arguments.in});
}

/// Stamped work needs files that can be read again: nothing is remembered of a pipe.
bool is_stampable(const AnalyzeArguments& arguments) {
  std::error_code error;
  const auto plain = [&](const std::string& path) {
    return !std::filesystem::exists(path, error) || std::filesystem::is_regular_file(path, error);
  };
  return std::filesystem::is_regular_file(arguments.in, error) && plain(arguments.out);
}

/// What the session says of its tablet in which the mesh lies: its own mesh tells what its scans tell, and
/// was stitched before a number was typed. Nothing in no session, or in one that is damaged. Errors:
/// kStorage.
Result<std::optional<FileLabel>> label_of_session_of(const std::filesystem::path& mesh) {
  const std::optional<std::filesystem::path> around = checked_folder_around(mesh);
  if (!around || !SessionStore::is_session(*around)) {
    return std::nullopt;
  }
  const Result<SessionStore> store = SessionStore::open(*around, SessionStore::Access::kReadOnly);
  const Result<FileLabel> label =
      store ? tablet_label(*store) : Result<FileLabel>(std::unexpected(store.error()));
  if (!label && label.error().kind == ErrorKind::kStorage) {
    return std::unexpected(label.error());
  }
  return label ? std::optional(*label) : std::nullopt;
}

void warn_of_doubts(const std::vector<Error>& doubts) {
  for (const Error& doubt : doubts) {
    log_warning(doubt.line());
  }
}

/// What was found when it was done before.
Result<int> tell_done(const AnalyzeArguments& arguments, CommandContext& context) {
  const Result<WedgeFile> file = read_wedges(arguments.out);
  if (!file) {
    return std::unexpected(file.error());
  }
  warn_of_doubts(doubts_of(*file, arguments.in));
  if (context.json) {
    nlohmann::ordered_json json = summary_json(arguments, *file);
    json["done_before"] = true;
    CommandContext::print(json);
  } else {
    finish_progress();
    std::printf("%s: %s, done before from this mesh; --again does it anew\n", arguments.out.c_str(),
                counted(file->wedges.size(), "wedge").c_str());
  }
  return 0;
}

void tell(const AnalyzeArguments& arguments, const WedgeFile& file, double took_s, CommandContext& context) {
  if (context.json) {
    CommandContext::print(summary_json(arguments, file));
    return;
  }
  finish_progress();
  const std::string hollows = counted(file.rejected.size(), "hollow");
  if (file.wedges.empty()) {
    std::printf("%s: no wedges (%s looked at), %.1f s\n", arguments.out.c_str(), hollows.c_str(), took_s);
  } else {
    std::printf("%s: %s, %s rejected, %.1f s\n", arguments.out.c_str(),
                counted(file.wedges.size(), "wedge").c_str(), hollows.c_str(), took_s);
  }
}

/// Everything that was written, for the stamp.
std::vector<std::filesystem::path> outputs_of(const AnalyzeArguments& arguments,
                                              const std::vector<std::filesystem::path>& drawings) {
  std::vector<std::filesystem::path> out{arguments.out};
  for (const std::string& file : {arguments.mesh_out, arguments.invariants}) {
    if (!file.empty()) {
      out.emplace_back(file);
    }
  }
  out.insert(out.end(), drawings.begin(), drawings.end());
  std::error_code error;
  if (!arguments.pictures.empty()) {
    for (const auto& entry : std::filesystem::directory_iterator(arguments.pictures, error)) {
      if (entry.path().extension() == ".ply" || entry.path().extension() == ".png") {
        out.push_back(entry.path());
      }
    }
  }
  std::ranges::sort(out);
  return out;
}

/// A mesh that was stitched or cleaned anew may have another name: then they are meant, and nothing is said
/// where that is known. So may a tablet that is analysed to where another one's wedges lay.
void warn_of_others(const AnalyzeArguments& arguments, const CorrectionFile& said,
                    const std::filesystem::path& file) {
  const std::filesystem::path mesh = std::filesystem::path(arguments.in).filename();
  const std::filesystem::path of = std::filesystem::path(said.mesh).filename();
  if (!said.corrections.empty() && !of.empty() && of != mesh && !is_of_the_tablet_of(arguments.in, file)) {
    log_warning(Error{ErrorKind::kBadInput,
                      "these corrections were made on " + of.string() + " and are made on " + mesh.string(),
                      file.string(), "if that is another tablet, give its wedges a file of their own"}
                    .line());
  }
}

/// Whether the correction that was asked for last could be made.
Status check_corrected(const AnalyzeArguments& arguments, const std::filesystem::path& file,
                       const Analysis& analysis) {
  const std::vector<LostCorrection>& lost = analysis.set.lost;
  if (!arguments.must_make_last || lost.empty() || lost.back().index + 1 != arguments.corrected->size()) {
    return {};
  }
  return fail(ErrorKind::kBadInput, lost.back().reason, file.string(),
              "nothing was changed; look at the place in the viewer");
}

/// Everything but what a person has said, and the stamp when all of it is there. The wedges come last: they
/// tell how many corrections the outputs have in them.
Status write_outputs(const AnalyzeArguments& arguments, const WedgeFile& file, const MeshInItsUnit& read,
                     const Analysis& analysis, const StampedWork* work, const JobContext& job) {
  const Mesh& mesh = read.mesh;
  if (!arguments.mesh_out.empty()) {
    if (Status written = write_mesh(arguments.mesh_out, annotated_mesh(mesh, analysis), file.label);
        !written) {
      return written;
    }
  }
  std::vector<std::filesystem::path> drawings;
  if (!arguments.svg.empty()) {
    auto drawn = write_wedge_drawings(arguments.svg, file.wedges, *file.text_from_model,
                                      picture_words(file.label, file.mesh), &mesh);
    if (!drawn) {
      return std::unexpected(drawn.error());
    }
    drawings = std::move(*drawn);
  }
  if (Status written =
          write_extras(arguments, mesh, analysis, lines_of_mat(arguments, read), file.label, job);
      !written) {
    return written;
  }
  if (Status written = write_wedges(arguments.out, file); !written) {
    return written;
  }
  return work != nullptr ? work->finish(outputs_of(arguments, drawings), job) : Status();
}

}  // namespace

Result<int> analyze(const AnalyzeArguments& arguments, CommandContext& context) {
  if (const Status named = arguments.mesh_out.empty() ? Status() : check_mesh_name(arguments.mesh_out);
      !named) {
    return std::unexpected(named.error());
  }
  if (const Status apart = check_files_apart(arguments); !apart) {
    return std::unexpected(apart.error());
  }
  const std::filesystem::path corrections_file = corrections_of(arguments);
  Result<CorrectionFile> said = read_corrections(corrections_file);
  if (!said) {
    return std::unexpected(said.error());
  }
  if (arguments.corrected) {
    said->corrections = *arguments.corrected;
    said->mesh = std::filesystem::path(arguments.in).filename().string();
  }
  const Result<std::optional<FileLabel>> of_session = label_of_session_of(arguments.in);
  if (!of_session) {
    return std::unexpected(of_session.error());
  }
  std::optional<StampedWork> work;
  if (is_stampable(arguments)) {
    Result<StampedWork> begun =
        StampedWork::begin(stamp_beside(arguments.out), "analyze",
                           parameters_of(arguments, *said, *of_session), {arguments.in}, context.job);
    if (!begun) {
      return std::unexpected(begun.error());
    }
    work = std::move(*begun);
    const Result<bool> done = arguments.again ? false : work->done(context.job);
    if (!done) {
      return std::unexpected(done.error());
    }
    if (*done) {
      return tell_done(arguments, context);
    }
  }
  const auto start = std::chrono::steady_clock::now();
  Result<MeshInItsUnit> read = read_mesh_in_its_unit(arguments.in, arguments.unit, context.job);
  if (!read) {
    return std::unexpected(read.error());
  }
  Mesh& mesh = read->mesh;
  face_outwards(&mesh, arguments.in);
  const double reading_s = seconds_since(start);
  AnalysisOptions options = options_of(arguments, said->corrections);
  options.wedges.earlier = earlier_wedges(arguments.out, arguments.in);
  Result<Analysis> analysis = analyze_mesh(mesh, options, context.job);
  if (!analysis) {
    Error error = analysis.error();
    error.where = error.where.empty() ? arguments.in : error.where;
    return std::unexpected(std::move(error));
  }
  if (const Status made = check_corrected(arguments, corrections_file, *analysis); !made) {
    return std::unexpected(made.error());
  }
  warn_of_others(arguments, *said, corrections_file);
  warn_of_lost(*analysis, corrections_file.string());
  if (const auto few = few_found_again(options.wedges.earlier, analysis->set)) {
    log_warning(arguments.out + ": " + *few);
  }
  analysis->timings_s.insert(analysis->timings_s.begin(), StageTiming{"reading", reading_s});
  const double took_s = seconds_since(start);
  analysis->timings_s.push_back({"all", took_s});
  std::error_code none;
  const bool comes_again = std::filesystem::is_regular_file(arguments.in, none);  // not from a pipe
  WedgeFile file = wedge_file(comes_again ? from_folder_of(arguments.in, arguments.out)
                                          : std::filesystem::path(arguments.in).filename().string(),
                              options, *analysis);
  warn_of_doubts(doubts_of(file, arguments.in, analysis->fields.body_count()));
  file.label = *of_session ? **of_session : read_mesh_label(arguments.in);
  file.unit_assumed = read->unit_assumed;
  if (const Status started = work ? work->start() : Status(); !started) {
    return std::unexpected(started.error());
  }
  if (arguments.corrected) {
    if (const Status written = replace_corrections(corrections_file, arguments.known, *said); !written) {
      return std::unexpected(written.error());
    }
  }
  if (const Status written =
          write_outputs(arguments, file, *read, *analysis, work ? &*work : nullptr, context.job);
      !written) {
    Error error = written.error();
    if (arguments.corrected) {
      error.mend += error.mend.empty() ? "" : "; ";
      error.mend += arguments.must_make_last ? "the correction is noted" : "the correction is taken back";
      error.mend += ": `dubsar analyze` then brings the outputs in line with that";
    }
    return std::unexpected(std::move(error));
  }
  tell(arguments, file, took_s, context);
  return 0;
}

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/session_wedges.h"

#include <fmt/format.h>

#include <limits>

#include "analysis/wedge_features.h"
#include "analysis/wedges.h"
#include "archive/wedge_drawing.h"
#include "core/log.h"
#include "core/number_text.h"
#include "formats/atomic_file.h"
#include "formats/corrections_json.h"
#include "formats/json_node.h"
#include "formats/json_text.h"
#include "formats/make_folder.h"
#include "formats/sha2.h"
#include "station/analysis.h"
#include "station/earlier_wedges.h"
#include "station/session_name.h"
#include "station/tablet_label.h"
#include "station/wedge_doubts.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

/// "1 wedge was", "3 wedges were".
std::string have_been(std::size_t count, std::string_view one) {
  return counted(count, one) + (count == 1 ? " was" : " were");
}

constexpr const char* kDocument = "wedges";
constexpr const char* kWedges = "analysis/wedges.json";
constexpr const char* kCorrections = "analysis/wedges.corrections.json";

/// Of what wedges are measured on: the vertices and the faces between them.
std::string digest_of(const Mesh& mesh) {
  const auto bytes = [](const auto& values) {
    return std::string_view(reinterpret_cast<const char*>(values.data()),
                            values.size() * sizeof(values.front()));
  };
  DigestSum sum(Digest::kSha256);
  sum.add(bytes(mesh.positions));
  sum.add(bytes(mesh.faces));
  return sum.hex();
}

/// What the session notes of its wedges.
struct NotedWedges {
  std::string file;
  std::string sha256;
  std::string surface_sha256;
  bool is_of_now = false;  ///< measured in the way of now, and corrected as is said now
};

std::optional<NotedWedges> noted_wedges(const SessionStore& store) {
  const auto text = store.load_document(kDocument);
  if (!text || !*text) {
    return std::nullopt;
  }
  const Result<JsonDocument> document = JsonDocument::parse(**text, kDocument);
  if (!document) {
    return std::nullopt;
  }
  const JsonNode root = document->root();
  NotedWedges noted{root.at("file").text(), root.at("sha256").text(), root.at("surface_sha256").text()};
  const auto method = root.find("method");
  const auto corrections = root.find("corrections");
  const std::string corrected = corrections ? corrections->text() : corrections_to_json({});
  noted.is_of_now = method && method->integer(0, std::numeric_limits<int>::max()) == kWedgeMethod &&
                    corrected == corrections_to_json({{}, session_corrections(store)});
  return document->status("") ? std::optional(std::move(noted)) : std::nullopt;
}

}  // namespace

std::vector<WedgeCorrection> session_corrections(const SessionStore& store) {
  Result<CorrectionFile> file = read_corrections(store.folder() / kCorrections);
  if (!file) {
    log_warning("the corrections of the wedges are passed over: " + file.error().line());
    return {};
  }
  return std::move(file->corrections);
}

std::vector<KnownWedge> session_known_wedges(const SessionStore& store) {
  return known_wedges_in(store.folder() / kWedges);
}

Result<std::optional<WedgeFile>> measure_wedges(const Mesh& mesh,
                                                const std::vector<WedgeCorrection>& corrections,
                                                std::vector<KnownWedge> known, const JobContext& job) {
  if (mesh.faces.empty()) {
    return std::nullopt;
  }
  AnalysisOptions options;
  options.wedges.corrections = corrections;
  options.wedges.earlier.wedges = std::move(known);
  const Result<Analysis> analysis = analyze_mesh(mesh, options, job);
  if (!analysis) {
    if (analysis.error().kind != ErrorKind::kBadInput) {
      return std::unexpected(analysis.error());
    }
    log_warning("wedges were not looked for: " + analysis.error().line());
    return std::nullopt;
  }
  warn_of_lost(*analysis, kCorrections);
  if (const auto few = few_found_again(options.wedges.earlier, analysis->set)) {
    log_info(*few);
  }
  WedgeFile file = wedge_file("../mesh/model.ply", options, *analysis);
  // Who scans so coarsely has chosen to: no warning at every end of a run.
  if (const std::optional<Error> coarse = too_coarse(file, "mesh/model.ply")) {
    log_info(coarse->line());
  }
  return file;
}

Result<std::optional<SessionWedges>> keep_wedges(SessionStore& store, const Mesh& mesh,
                                                 const JobContext& job) {
  const std::vector<WedgeCorrection> corrections = session_corrections(store);
  Result<std::optional<WedgeFile>> measured =
      measure_wedges(mesh, corrections, session_known_wedges(store), job);
  if (!measured) {
    return std::unexpected(measured.error());
  }
  if (!*measured) {
    return std::nullopt;
  }
  const Result<FileLabel> label = label_of_scans(store);
  if (!label) {
    return std::unexpected(label.error());
  }
  WedgeFile& file = **measured;
  file.label = *label;
  const fs::path folder = store.folder() / "analysis";
  if (const Status made = make_folder(folder); !made) {
    return std::unexpected(made.error());
  }
  SessionWedges out = counts_of(file, folder / "wedges.json");
  std::vector<WedgeDrawing> drawings;
  if (file.text_from_model) {
    drawings = wedge_drawings(folder, file.wedges, *file.text_from_model,
                              picture_words(file.label, session_name(store.folder())), &mesh);
  }
  const auto write = [&](const fs::path& to) { return write_wedges(to, file); };
  if (const Status kept = store.replace_file(kWedges, write); !kept) {
    return std::unexpected(kept.error());
  }
  for (const WedgeDrawing& drawing : drawings) {
    const auto draw = [&](const fs::path& to) { return write_file_atomically(to, drawing.svg); };
    if (const Status kept = store.replace_file(fs::path("analysis") / drawing.name, draw); !kept) {
      return std::unexpected(kept.error());
    }
  }
  const Result<std::string> sum = sha256_of_file(out.json, job);
  if (!sum) {
    return std::unexpected(sum.error());
  }
  const std::string name = out.json.lexically_relative(store.folder()).generic_string();
  if (const Status kept =
          store.save_document(kDocument, text_of({{"file", name},
                                                  {"sha256", *sum},
                                                  {"surface_sha256", digest_of(mesh)},
                                                  {"method", kWedgeMethod},
                                                  {"corrections", corrections_to_json({{}, corrections})}}));
      !kept) {
    return std::unexpected(kept.error());
  }
  return out;
}

KeptWedges kept_wedges(const SessionStore& store, const Mesh& mesh) {
  const std::optional<NotedWedges> noted = noted_wedges(store);
  if (!noted || noted->surface_sha256 != digest_of(mesh)) {
    return KeptWedges::kOfAnotherSurface;
  }
  return noted->is_of_now ? KeptWedges::kAsMeasuredNow : KeptWedges::kMeasuredOtherwise;
}

std::optional<WedgeFile> stored_wedges(const SessionStore& store, const Mesh& mesh, const JobContext& job) {
  const std::optional<NotedWedges> noted = noted_wedges(store);
  if (!noted || !noted->is_of_now || noted->surface_sha256 != digest_of(mesh)) {
    return std::nullopt;
  }
  const Result<std::string> now = sha256_of_file(store.folder() / noted->file, job);
  if (!now || *now != noted->sha256) {
    return std::nullopt;
  }
  Result<WedgeFile> wedges = read_wedges(store.folder() / noted->file);
  if (wedges) {
    wedges->method = kWedgeMethod;  // the file of a version before this one does not say it
  }
  return wedges ? std::optional(std::move(*wedges)) : std::nullopt;
}

std::string correction_sentence(const WedgeFile& file) {
  if (file.corrections == 0) {
    return {};
  }
  const std::size_t made = file.corrections - std::min(file.corrections, file.lost.size());
  const std::string all =
      fmt::format("A person has corrected what was found: {} made", have_been(made, "correction"));
  return file.lost.empty() ? all + "." : fmt::format("{}, and {} more could not be.", all, file.lost.size());
}

SessionWedges counts_of(const WedgeFile& file, fs::path json) {
  SessionWedges out{std::move(json),
                    file.wedges.size(),
                    file.rejected.size(),
                    correction_sentence(file),
                    {},
                    make_read_profiles(file.wedges)};
  for (Error& doubt : doubts_of(file, {})) {
    out.doubts.push_back(std::move(doubt.what));
  }
  return out;
}

std::string wedge_sentence(const SessionWedges& wedges, const std::string& where) {
  std::string sentence =
      wedges.count == 0
          ? fmt::format("No wedges were found; {} looked at.", have_been(wedges.rejected, "hollow"))
          : fmt::format(
                "{} measured, {} rejected: {} has every angle, the drawings "
                "beside it every wedge. Wedge measurement was tested on simulated tablets only.",
                have_been(wedges.count, "wedge"), have_been(wedges.rejected, "hollow"), where);
  if (!wedges.by_hand.empty()) {
    sentence += " " + wedges.by_hand;
  }
  for (const std::string& doubt : wedges.doubts) {
    sentence += " Take care: " + doubt + ".";
  }
  return sentence;
}

}  // namespace dubsar

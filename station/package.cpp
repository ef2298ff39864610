// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/package.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <set>
#include <utility>

#include "acquisition/session_presence.h"
#include "analysis/text_frame.h"
#include "analysis/wedge_features.h"
#include "archive/staged_folder.h"
#include "core/log.h"
#include "formats/bag_check.h"
#include "station/done_stamp.h"
#include "station/earlier_package.h"
#include "station/earlier_wedges.h"
#include "station/own_files.h"
#include "station/package_content.h"
#include "station/packed_names.h"
#include "station/session_name.h"
#include "station/session_wedges.h"
#include "station/tablet_label.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// Sides, lines and drawings of wedges whose text does not tell how the tablet lies go by what the pictures
/// go by.
void lie_as(const RigidTransform& tablet_from_model, WedgeFile* file) {
  file->text_from_model = tablet_from_model;
  place_wedges({tablet_from_model, file->text_certainty}, &file->wedges);
  file->profiles = make_profiles(file->wedges);
}

std::string base_url(const std::string& wanted, const std::string& name) {
  std::string url = wanted.empty() ? "https://dubsar.invalid/" + name : wanted;
  if (url.back() != '/') {
    url += '/';
  }
  return url;
}

struct FoundWedges {
  std::optional<WedgeFile> file;
  bool kept = false;  ///< in the session
};

/// What is to be said beside the device of the scan that was stored last: " (its files say: A)", or that
/// scans name different ones. Empty where nothing is.
std::string said_by_scans(const PackageContent& content) {
  std::set<std::string> devices = devices_of_scans(content.store);
  const bool some_name_none = devices.erase(std::string()) > 0;
  if (content.comes_of_several_devices()) {
    return fmt::format(" (the scan that was stored last; the scans name: {}{})", fmt::join(devices, "; "),
                       some_name_none ? "; and some name none" : "");
  }
  return devices.empty() || !content.comes_from_files()
             ? std::string()
             : fmt::format(" (its files say: {})", fmt::join(devices, "; "));
}

/// The session's own wedges, or, where it has none of this surface, measured now: then under the ids that an
/// earlier package in its place, or the session, has told.
Result<FoundWedges> wedges_of(const SessionStore& store, const Mesh& mesh, const fs::path& replaced,
                              const JobContext& job) {
  if (mesh.faces.empty()) {
    return FoundWedges{};
  }
  if (std::optional<WedgeFile> stored = stored_wedges(store, mesh, job)) {
    return FoundWedges{std::move(stored), true};
  }
  log_info("the session holds no wedges of this surface, corrected as it says: they are measured now");
  std::vector<KnownWedge> known =
      replaced.empty() ? std::vector<KnownWedge>() : known_wedges_in(replaced / "data/wedges/wedges.json");
  add_known(session_known_wedges(store), &known);
  Result<std::optional<WedgeFile>> measured =
      measure_wedges(mesh, session_corrections(store), std::move(known), job);
  return measured ? Result<FoundWedges>(FoundWedges{std::move(*measured), false})
                  : std::unexpected(measured.error());
}

/// "raw range grids, poses, report": what of the kinds of things that a package may hold is in this one.
std::string kinds_of_things(const PackageContent& content) {
  const auto is_listed = [&](std::string_view folder) {
    return std::ranges::any_of(content.files,
                               [&](const PackagedFile& file) { return file.path.starts_with(folder); });
  };
  std::string words;
  for (const auto& [word, there] : std::initializer_list<std::pair<const char*, bool>>{
           {"raw range grids", is_listed("scans/grids/")},
           {"rows of scans that were not over", is_listed("scans/unfinished/")},
           {"poses", true},
           {"model", !content.mesh().faces.empty()},
           {"pictures", !content.pictures.empty()},
           {"wedges", content.wedges && !content.wedges->wedges.empty()},
           {"report", true}}) {
    words += there ? (words.empty() ? "" : ", ") + std::string(word) : std::string();
  }
  return words;
}

std::vector<BagField> bag_fields(const PackageContent& content) {
  std::string description = content.simulated.empty()
                                ? std::string("Surface of a cuneiform tablet, ") +
                                      (content.comes_of_several_devices() ? "measured with several devices: "
                                       : content.comes_from_files()       ? "from files of scans: "
                                                                    : "measured by laser triangulation: ")
                                : "SIMULATED. " + content.simulated + " Here are ";
  description += kinds_of_things(content) + ". ";
  description += content.results().red_map.conclusive
                     ? "The verdict is conclusive: " + conclusive_words(content.results().red_map)
                     : "The verdict is not conclusive: see data/report/report.html for what is missing.";
  std::string left_out;
  for (const PackagePart part : content.options.without) {
    left_out += (left_out.empty() ? "" : ", ") + std::string(to_string(part));
  }
  return {{"Source-Organization", content.tablet.collection},
          {"External-Identifier", content.tablet.cdli},
          {"External-Identifier", content.tablet.museum_number},
          {"Internal-Sender-Identifier", session_name(content.store.folder())},
          {"Contact-Name", content.tablet.operator_name},
          {"External-Description", description},
          {"Rights", content.tablet.rights},
          {"Bagging-Date", content.when.substr(0, 10)},
          {"Bag-Software-Agent", program_name()},
          {"Dubsar-Signed", signature_words(content)},
          {"Dubsar-Left-Out", left_out}};
}

/// Runs the writers of all parts.
Status add_all(PackageContent& content, StageTimes& timings) {
  struct Step {
    const char* name;
    Status (*add)(PackageContent&);
    bool wanted;
  };
  const std::vector<Step> steps = {
      {"scans", add_scans, true},
      {"unfinished scans", add_unfinished, true},
      {"unreadable folders", add_unreadable, true},
      {"records", add_records, true},
      {"model", add_model, true},
      {"kept files", add_kept, true},
      {"selections and corrections", add_by_hand, true},
      {"what is left out", add_left_out, true},
      {"wedges", add_wedges, content.has(PackagePart::kWedges)},
      {"features", add_features, content.has(PackagePart::kFeatures)},
      {"renderings", add_renderings, content.has(PackagePart::kRenderings)},
      {"reports", add_reports, true},
      {"linked data", add_linked_data, true},
      {"readme", add_readme, true},
  };
  for (const Step& step : steps) {
    if (!step.wanted) {
      continue;
    }
    if (content.job.cancelled()) {
      return fail(ErrorKind::kCancelled, "stopped");
    }
    LapClock clock(&timings);
    if (const Status added = step.add(content); !added) {
      return added;
    }
    clock.done(step.name);
  }
  return {};
}

/// What is going to be replaced may hold what others put there.
Result<KeptFiles> keep_others(const fs::path& to, const std::optional<DoneStamp>& stamp, JobContext& job) {
  if (!is_bag(to)) {
    return KeptFiles{};  // nothing, or an empty folder
  }
  const Result<std::set<std::string>> own = own_files_of(to, stamp, job);
  if (!own) {
    return std::unexpected(own.error());
  }
  Result<KeptFiles> kept = keep_all_but(*own, to, job);
  if (kept && kept->files > 0) {
    log_warning(sentence_of(*kept));
  }
  return kept;
}

}  // namespace

std::string_view to_string(PackagePart part) {
  switch (part) {
    case PackagePart::kGridPly:
      return "grid-ply";
    case PackagePart::kWedges:
      return "wedges";
    case PackagePart::kFeatures:
      return "features";
    case PackagePart::kRenderings:
      break;
  }
  return "renderings";
}

const std::vector<PackagePart>& all_package_parts() {
  static const std::vector<PackagePart> kAll = {PackagePart::kGridPly, PackagePart::kWedges,
                                                PackagePart::kFeatures, PackagePart::kRenderings};
  return kAll;
}

Result<Package> write_package(const fs::path& session, const fs::path& to, const PackageOptions& options,
                              JobContext& job) {
  std::error_code ignored;
  if (const Status there = check_is_session(session); !there) {
    return std::unexpected(there.error());
  }
  if (const Status ours = check_is_package(to); !ours) {
    return std::unexpected(ours.error());
  }
  Result<StagedFolder> staged = StagedFolder::begin(to, options.replace);
  if (!staged) {
    return std::unexpected(staged.error());
  }
  StageTimes timings;
  LapClock opening(&timings);
  const Result<PackageSource> source = PackageSource::open(session, job);
  if (!source) {
    return std::unexpected(source.error());
  }
  const SessionStore& store = source->store();
  if (options.replace) {
    if (const Status same = check_is_of_session(to, store); !same) {
      return std::unexpected(same.error());
    }
  }
  const Mesh& mesh = source->results().mesh;
  opening.done("reading");
  PageFacts facts = page_facts_of(store);
  const Result<std::string> simulated = simulated_words(store);
  if (!simulated) {
    return std::unexpected(simulated.error());
  }
  Result<FileLabel> label = tablet_label(store);
  if (!label) {
    return std::unexpected(label.error());
  }
  if (!simulated->empty()) {
    facts.tablet.emplace(facts.tablet.begin(), "Simulated", *simulated);
  }
  const TabletRecord tablet = tablet_record_of(store);
  const std::string identifier = !tablet.cdli.empty() ? tablet.cdli : facts.title;
  PackageContent content{.root = staged->path() / "data",
                         .source = *source,
                         .store = store,
                         .options = options,
                         .facts = std::move(facts),
                         .tablet = tablet,
                         .identifier = identifier,
                         .stem = file_stem(identifier, session_name(store.folder())),
                         .when = utc_now(),
                         .simulated = *simulated,
                         .label = std::move(*label),
                         .tablet_from_model = source->tablet_from_model(),
                         .lies_by_text = false,
                         .wedges = {},
                         .wedges_are_kept = false,
                         .fields = {},
                         .files = {},
                         .pictures = {},
                         .lacking = {},
                         .left_out = {},
                         .job = job};
  const bool is_named_by_session = tablet.cdli.empty() && tablet.museum_number.empty();
  if (!content.facts.device.empty()) {
    content.facts.device += said_by_scans(content);
  }
  if (const std::string& behind = source->behind(); !behind.empty()) {
    log_warning(session.string() + ": " + behind + "; run dubsar register and plan on it, then export again");
    content.lacking.push_back("Take care: " + behind +
                              ". Poses and what is told of them are of before that.");
  }
  content.options.base_url = base_url(options.base_url, address_name(identifier, is_named_by_session));
  if (content.has(PackagePart::kWedges)) {
    Result<FoundWedges> wedges = wedges_of(store, mesh, options.replace ? to : fs::path(), job);
    if (!wedges) {
      return std::unexpected(wedges.error());
    }
    content.wedges = std::move(wedges->file);
    content.wedges_are_kept = wedges->kept;
    opening.done("wedges");
  }
  if (content.wedges && content.wedges->text_from_model && content.wedges->text_certainty >= kCertainText) {
    content.tablet_from_model = *content.wedges->text_from_model;
    content.lies_by_text = true;
  } else if (content.wedges) {
    lie_as(content.tablet_from_model, &*content.wedges);
  }
  if (const Status added = add_all(content, timings); !added) {
    return std::unexpected(added.error());
  }
  LapClock closing(&timings);
  const Result<BagSize> size = write_bag_tags(staged->path(), bag_fields(content), job);
  if (!size) {
    return std::unexpected(size.error());
  }
  // That of what lies there, before the new one takes its place.
  const std::optional<DoneStamp> earlier = read_done_stamp(stamp_beside(to), "export");
  if (options.before_publishing) {
    if (const Status allowed = options.before_publishing(staged->path()); !allowed) {
      return std::unexpected(allowed.error());
    }
  }
  // Somebody may have put something there meanwhile.
  if (const Status ours = check_is_package(to); !ours) {
    return std::unexpected(ours.error());
  }
  const Result<KeptFiles> kept =
      options.replace ? keep_others(to, earlier, job) : Result<KeptFiles>(KeptFiles{});
  if (!kept) {
    return std::unexpected(kept.error());
  }
  if (const Status published = staged->publish(); !published) {
    return std::unexpected(published.error());
  }
  closing.done("checksums");
  Package package{.folder = to,
                  .size = *size,
                  .kept = *kept,
                  .identifier = identifier,
                  .conclusive = source->results().red_map.conclusive,
                  .has_mesh = !mesh.faces.empty(),
                  .scans = 0,
                  .wedges = content.wedges ? content.wedges->wedges.size() : 0,
                  .lacking = std::move(content.lacking),
                  .timings = std::move(timings)};
  for (fs::directory_iterator it(to / "data" / "scans" / "grids", ignored), end; !ignored && it != end;
       it.increment(ignored)) {
    ++package.scans;
  }
  return package;
}

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "archive/report_pictures.h"
#include "core/log.h"
#include "formats/atomic_file.h"
#include "formats/checklist_json.h"
#include "formats/make_folder.h"
#include "formats/red_map_json.h"
#include "formats/states_ply.h"
#include "station/command/command.h"
#include "station/command/left_out_scans.h"
#include "station/command/outputs.h"
#include "station/command/plan_keeping.h"
#include "station/command/scan_set_options.h"
#include "station/command/scan_warnings.h"
#include "station/followed_word.h"
#include "station/offline.h"
#include "station/plan_again.h"
#include "station/session_name.h"
#include "station/session_pages.h"
#include "station/sign_off_words.h"
#include "station/tablet_flags.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

struct PlanArguments {
  ScanSetArguments set;
  std::string page;
  std::string states;
};

/// Those of a scan that has no place any more must not go on showing one. Files of others stay.
Status remove_states_of_before(const fs::path& folder, const std::set<std::string>& written) {
  constexpr std::size_t kHeadBytes = 256;
  std::vector<fs::path> before;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (!name.starts_with("states_") || !name.ends_with(".ply") || written.contains(name)) {
      continue;
    }
    if (const Result<std::string> head = read_file_head(it->path(), kHeadBytes);
        head && is_states_ply(*head)) {
      before.push_back(it->path());
    }
  }
  for (const fs::path& file : before) {
    if (!fs::remove(file, error)) {
      return fail(ErrorKind::kStorage, "states of before cannot be taken away", file.string(),
                  "take the file away by hand: it shows a scan that has no place any more");
    }
    log_info(file.string() + ": states of a scan that has no place any more, taken away");
  }
  return {};
}

Status write_states(const fs::path& folder, const ScanSet& set, const PlannedAgain& planned) {
  if (Status made = make_folder(folder); !made) {
    return made;
  }
  std::set<std::string> written_names;
  for (const PlacedScan& scan : planned.stage->placed()) {
    const auto states = planned.stage->states(scan.id);
    if (!states) {
      continue;
    }
    const std::string name = fmt::format("states_{:03d}.ply", scan.id);
    const fs::path file = folder / name;
    written_names.insert(name);
    if (const Status written = write_states_ply(file, scan.id, *scan.grid, scan.model_from_scanner, *states);
        !written) {
      return written;
    }
  }
  if (planned.stage->placed().size() + planned.stage->copies().size() < set.scans.size()) {
    log_warning("scans that are not registered have no states");
  }
  return remove_states_of_before(folder, written_names);
}

Status write_page(const fs::path& file, const PlannedAgain& planned, const PageFacts& facts,
                  const JobContext& job) {
  const ReportInput input = report_input(planned.results, *planned.stage, facts);
  const Result<ReportPictures> pictures = draw_pictures(input, job);
  if (!pictures) {
    return std::unexpected(pictures.error());
  }
  return write_file_atomically(file, checklist_html(input, *pictures));
}

std::string micrometres(double mm) {
  return std::isfinite(mm) ? fmt::format("{:.0f}", 1000 * mm) : "-";
}

/// Where nothing is `placed` there are no faces to tell of: a table of zeros would say that nothing is red.
void print_checklist(const Checklist& list, bool placed) {
  for (std::size_t f = 0; placed && f < kFaceCount; ++f) {
    const FaceCoverage& face = list.faces[f];
    std::printf("  %-8s %9.1f mm2 seen (%5.1f %%), red %.2f, excused %.2f; spacing %s um\n",
                to_string(static_cast<Face>(f)), face.seen_mm2, 100 * face.coverage(), face.red_mm2,
                face.excused_mm2, micrometres(face.sampling.spacing_mm.median).c_str());
  }
  if (placed) {
    std::printf("  spacing %s um median, %s um 95 %%; %.1f %% at 25 um or finer\n",
                micrometres(list.sampling.spacing_mm.median).c_str(),
                micrometres(list.sampling.spacing_mm.p95).c_str(), 100 * list.sampling.fine_share);
  }
  if (list.sign_off) {
    std::printf("  %s\n", sign_off_line(*list.sign_off).c_str());
  }
}

void print_map(const RedMap& map) {
  std::printf("%s\n", map.conclusive ? "conclusive" : "not conclusive");
  int strays = 0;
  for (std::size_t k = 0; k < map.regions.size(); ++k) {
    const RedRegion& region = map.regions[k];
    if (is_stray(region)) {
      ++strays;
      continue;
    }
    std::printf("  %3zu %-8s %-8s %8.2f mm2 at %.1f %.1f %.1f%s%s\n", region_number(k),
                region.state == RegionState::kRed ? "red" : "excused", to_string(region.face),
                region.area_mm2, region.center_mm.x(), region.center_mm.y(), region.center_mm.z(),
                region.reason.empty() ? "" : ": ", region.reason.c_str());
  }
  if (strays > 0) {
    std::printf("  %d group%s of stray returns, where no clay is missing\n", strays, strays == 1 ? "" : "s");
  }
  for (const GroupApart& group : map.apart) {
    std::printf("  apart: %s\n", group.say.c_str());
  }
  for (const NextView& view : map.next) {
    std::printf("  next: %s (about %.1f mm2)\n", view.say.c_str(), view.predicted_cleared_mm2);
  }
}

/// Scans that take no part in the verdict: those that are not registered or have no pose, told of here, and
/// what cannot be read, of which reading has told.
Result<std::vector<LeftOutScan>> leave_out(const ScanSet& set, const std::vector<ScanPose>& poses) {
  std::vector<LeftOutScan> out;
  for (const StationScan& scan : set.scans) {
    const auto pose = std::ranges::find(poses, scan.id, &ScanPose::id);
    if (pose == poses.end()) {
      out.push_back({scan.id, scan.file, LeftOutScan::Why::kNoPose, "there is no pose of it"});
      warn_of(out.back());
    } else if (pose->status != PoseStatus::kRegistered) {
      ScanPose named = *pose;
      named.file = scan.file;
      out.push_back(left_out(named));
      warn_of(out.back());
    }
  }
  if (std::ranges::find(poses, PoseStatus::kRegistered, &ScanPose::status) == poses.end()) {
    log_warning("no scan is registered: there is nothing to judge; see dubsar register");
  }
  Result<std::vector<LeftOutScan>> unread = unread_scans(set);
  if (unread) {
    unread->insert(unread->begin(), out.begin(), out.end());
  }
  return unread;
}

Result<int> plan(const PlanArguments& arguments, CommandContext& context) {
  if (const Status good = arguments.set.check_unit(arguments.set.poses); !good) {
    return std::unexpected(good.error());
  }
  // Any PLY of points in a folder is a scan of it.
  if (std::error_code not_there;
      !arguments.states.empty() && fs::equivalent(arguments.states, arguments.set.path, not_there)) {
    return fail(ErrorKind::kUsage, "states of samples would be read as scans of this folder",
                arguments.states, "give them a folder of their own");
  }
  ScanSetOptions how = arguments.set.reading();
  how.outputs.emplace_back(arguments.page);
  const bool may_write = how.access == SessionStore::Access::kReadWrite;
  Result<ScanSet> set = load_scan_set(arguments.set.path, how, context.job);
  if (!set) {
    return std::unexpected(set.error());
  }
  const Result<std::vector<ScanPose>> poses =
      poses_for(*set, arguments.set.poses, arguments.set.unit, context.job);
  if (!poses) {
    return std::unexpected(poses.error());
  }
  Result<std::vector<LeftOutScan>> left_out = leave_out(*set, *poses);
  if (!left_out) {
    return std::unexpected(left_out.error());
  }
  Result<PlannedAgain> planned = plan_again(*set, *poses, context.job);
  if (!planned) {
    return std::unexpected(planned.error());
  }
  for (const ForeignFound& found : planned->stage->foreign()) {
    if (found.is_all()) {
      const auto scan = std::ranges::find(set->scans, found.id, &StationScan::id);
      left_out->push_back(dubsar::left_out(found, scan->file));
      warn_of(left_out->back());
    } else {
      log_warning(sentence_of(found));
    }
  }
  Results& results = planned->results;
  log_scan_warnings(results.checklist.warnings);
  PlanComparison comparison;
  PlanKeeping is{{}, {}, may_write};
  if (auto behind = not_followed_sentence(*set);
      behind && !behind->empty() && arguments.set.poses.empty() && all_judged(*set)) {
    log_warning(arguments.set.path + ": " + *behind + "; run dubsar register on it");
    is.not_followed = std::move(*behind);
  }
  // Poses or pins of a file judge alone: the session keeps its own verdict.
  if (set->is_session() && arguments.set.poses.empty() && arguments.set.pins.empty()) {
    Result<PlanComparison> compared = keep_in_session(*set, *planned, std::move(is), context.job);
    if (!compared) {
      return std::unexpected(compared.error());
    }
    comparison = std::move(*compared);
  }
  if (!arguments.set.out.empty()) {
    if (const Status written = write_red_map(arguments.set.out, results.red_map); !written) {
      return std::unexpected(written.error());
    }
  }
  if (!arguments.states.empty()) {
    if (const Status written = write_states(arguments.states, *set, *planned); !written) {
      return std::unexpected(written.error());
    }
  }
  if (!arguments.page.empty()) {
    PageFacts facts;
    facts.title = session_name(arguments.set.path);
    if (set->is_session()) {
      facts = page_facts_of(*set->store);
    }
    if (const Status written = write_page(arguments.page, *planned, facts, context.job); !written) {
      return std::unexpected(written.error());
    }
  }
  finish_progress();
  if (context.json) {
    auto json = nlohmann::ordered_json::parse(red_map_to_json(results.red_map));
    json["left_out"] = left_out_json(*left_out);
    json["checklist"] = checklist_json(results.checklist);
    // It was checked just now: the same session gives the same bytes.
    json["checklist"].erase("store_checked");
    if (comparison.compared) {
      json["stored"] = {
          {"same", comparison.differs.empty()}, {"differs", comparison.differs}, {"kept", comparison.kept}};
    }
    CommandContext::print(json);
  } else {
    print_map(results.red_map);
    print_checklist(results.checklist, !results.red_map.scans.empty());
  }
  return results.red_map.conclusive ? 0 : 1;
}

}  // namespace

void add_plan(CLI::App& app, Action& chosen) {
  CLI::App* verb =
      app.add_subcommand("plan", "What is still red and where to scan next; status 1 when not conclusive");
  const auto arguments = std::make_shared<PlanArguments>();
  arguments->set.add_to(*verb, true);
  verb->add_option("-o,--out", arguments->set.out, "write red_map.json here");
  verb->add_option("--page", arguments->page, "write the checklist as a page for people (HTML) here");
  verb->add_option("--states", arguments->states,
                   "write what has become of every sample into this folder, a PLY for each scan");
  verb->callback([&chosen, arguments] {
    chosen = with_safe_outputs({arguments->set.out, arguments->page, as_folder(arguments->states)},
                               [arguments](CommandContext& c) { return plan(*arguments, c); },
                               {arguments->set.poses, arguments->set.pins});
  });
}

}  // namespace dubsar

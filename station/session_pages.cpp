// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/session_pages.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "archive/behind_page.h"
#include "core/scan_list.h"
#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "formats/json_text.h"
#include "formats/poses_json.h"
#include "station/kept_surface.h"
#include "station/picture_file.h"
#include "station/results.h"
#include "station/same_places.h"
#include "station/session_pins.h"
#include "station/session_wedges.h"
#include "station/station_scan.h"
#include "station/tablet_label.h"
#include "triangulation/placed_precision.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

constexpr std::array<const char*, kPages.size()> kKickers = {"Checklist", "Scan report"};

/// Two threads of the engine may come to a change at once.
std::mutex& taking_back() {
  static std::mutex mutex;
  return mutex;
}

bool is_there(const SessionStore& store, const char* name) {
  std::error_code unknown;
  return fs::exists(store.folder() / name, unknown);
}

bool says_it_is_behind(const SessionStore& store, const char* page) {
  const Result<std::string> head = read_file_head(store.folder() / page, kBehindHeadBytes);
  return head && is_behind_page(*head);
}

constexpr const char* kRedMap = "export/red_map.json";
constexpr const char* kRedSheet = "export/red_map.png";
constexpr const char* kPoses = "export/poses.json";
constexpr const char* kBehind = "behind";

/// Where a file of that name is there.
Status put_in_its_place(SessionStore& store, const char* name,
                        const std::function<Status(const fs::path&)>& write) {
  return is_there(store, name) ? store.replace_file(name, write) : Status();
}

Status put_text(SessionStore& store, const char* name, const std::string& text) {
  return put_in_its_place(
      store, name, [&](const fs::path& file) { return write_file_atomically(file, std::string_view(text)); });
}

constexpr std::string_view kBeforeMend = "; ";

/// What a file that was taken back says of it; nothing of one that was not, or is not there.
std::optional<std::string> said_in_json(const SessionStore& store, const char* name) {
  const Result<std::string> text = read_whole_file(store.folder() / name);
  const Result<JsonDocument> json = text ? JsonDocument::parse(*text, name) : std::unexpected(text.error());
  const auto said = json ? json->root().find(kBehind) : std::nullopt;
  return said ? std::optional(said->text()) : std::nullopt;
}

/// The pages first, and poses.json last: where it says so, all do.
Status take_back(SessionStore& store, std::string_view what, std::string_view mend) {
  BehindPage page{page_facts_of(store).title, {}, utc_now(), std::string(what), std::string(mend)};
  for (std::size_t k = 0; k < kPages.size(); ++k) {
    page.kicker = kKickers[k];
    if (Status put = put_text(store, kPages[k], behind_html(page)); !put) {
      return put;
    }
  }
  const std::string why =
      "the session was changed on " + page.when + ": " + page.what + std::string(kBeforeMend) + page.mend;
  const OrderedJson none = OrderedJson::array();
  if (Status put = put_text(
          store, kRedMap,
          text_of(
              {{kBehind, why}, {"conclusive", false}, {"scans", none}, {"regions", none}, {"next", none}}));
      !put) {
    return put;
  }
  const auto draw = [&](const fs::path& file) {
    return write_picture(file, behind_picture(page), {.title = page.title + ", behind"});
  };
  if (Status put = put_in_its_place(store, kRedSheet, draw); !put) {
    return put;
  }
  return put_text(store, kPoses,
                  text_of({{kBehind, why}, {"unit", "mm"}, {"frame", "model"}, {"scans", none}}));
}

/// Of the scans that stand and are whole, by id: the places of those that are registered.
std::vector<std::pair<int, std::string>> places_of(const std::vector<StoredScan>& scans,
                                                   const std::vector<ScanPose>& poses) {
  std::vector<std::pair<int, std::string>> out;
  for (const StoredScan& scan : scans) {
    if (scan.dropped || scan.damaged) {
      continue;
    }
    const auto pose = std::ranges::find(poses, scan.id, &ScanPose::id);
    const bool is_placed = pose != poses.end() && pose->status == PoseStatus::kRegistered;
    out.emplace_back(scan.id, is_placed ? text_of(json_of(pose->model_from_scanner)) : std::string());
  }
  return out;
}

/// Stored poses as plan_again() has them: a scan that is registered where the model cannot hold it is failed.
/// Only what pages show as failed is looked at, for its grid has to be read.
std::vector<ScanPose> as_planned(const SessionStore& store, std::vector<ScanPose> poses,
                                 const std::vector<ScanPose>& shown) {
  for (ScanPose& pose : poses) {
    const auto there = std::ranges::find(shown, pose.id, &ScanPose::id);
    if (pose.status != PoseStatus::kRegistered || there == shown.end() ||
        there->status != PoseStatus::kFailed) {
      continue;
    }
    Result<RangeGrid> grid = store.load_grid(pose.id);
    const Result<std::optional<PinSet>> pins = session_pins(store);
    if (grid && pins) {
      const StationScan scan = prepare_scan(pose.id, std::move(*grid), *pins);
      pose = PlacedPrecision(*scan.grid).judged(std::move(pose));
    }
  }
  return poses;
}

}  // namespace

Status take_pages_back(SessionStore& store, std::string_view what, std::string_view mend) {
  const std::scoped_lock lock(taking_back());
  return take_back(store, what, mend);
}

Status take_pages_back_once(SessionStore& store, std::string_view what, std::string_view mend) {
  const std::scoped_lock lock(taking_back());
  return pages_are_taken_back(store) ? Status() : take_back(store, what, mend);
}

Status pages_follow_record(SessionStore& store, JobContext& job) {
  if (std::ranges::none_of(kPages, [&](const char* page) { return is_there(store, page); })) {
    return {};
  }
  const Result<VerifyReport> found = store.verify(job);
  if (!found) {
    return std::unexpected(found.error());
  }
  const PageFacts facts = page_facts_of(store);
  for (const char* page : kPages) {
    if (std::ranges::find(found->whole, page) == found->whole.end()) {
      continue;
    }
    const Result<std::string> text = read_whole_file(store.folder() / page);
    const std::string renamed = text ? page_renamed(*text, facts.title, facts.tablet) : std::string();
    if (Status put = text && renamed != *text ? put_text(store, page, renamed) : Status(); !put) {
      return put;
    }
  }
  return {};
}

std::string mend_of_pages(const SessionStore& store) {
  for (const char* name : {kPoses, kRedMap}) {
    const std::string said = said_in_json(store, name).value_or("");
    if (const std::size_t mend = said.rfind(kBeforeMend); mend != std::string::npos) {
      return said.substr(mend + kBeforeMend.size());
    }
  }
  return std::ranges::any_of(kPages, [&](const char* page) { return says_it_is_behind(store, page); })
             ? kFollowAndPlan
             : kPlan;
}

bool pages_are_taken_back(const SessionStore& store) {
  int there = 0;
  for (const char* page : kPages) {
    if (is_there(store, page)) {
      ++there;
      if (!says_it_is_behind(store, page)) {
        return false;
      }
    }
  }
  for (const char* name : {kRedMap, kPoses}) {
    if (is_there(store, name) && !said_in_json(store, name)) {
      return false;
    }
  }
  return there > 0;
}

std::string why_pages_are_behind(const SessionStore& store) {
  if (std::ranges::none_of(kPages, [&](const char* page) { return is_there(store, page); })) {
    return {};
  }
  for (const char* page : kPages) {
    if (says_it_is_behind(store, page)) {
      return "the session was changed after they were made";
    }
  }
  const Result<std::optional<std::string>> map = store.load_document("red_map");
  const Result<std::vector<StoredScan>> scans = store.scans();
  const Result<std::vector<ScanPose>> poses = store.poses();
  const Result<std::string> shown = read_whole_file(store.folder() / kRedMap);
  if (!shown || !map || !*map || *shown != **map) {
    return "export/red_map.json is not the red map that the session holds";
  }
  const Result<std::vector<ScanPose>> lie = read_poses(store.folder() / kPoses);
  const auto has_none_of = [&](const ScanPose& pose) {
    const auto scan = std::ranges::find(*scans, pose.id, &StoredScan::id);
    return scan == scans->end() || scan->dropped;
  };
  if (!lie || !scans || !poses || std::ranges::any_of(*lie, has_none_of) ||
      places_of(*scans, *lie) != places_of(*scans, as_planned(store, as_shown(*poses, *lie), *lie))) {
    return "export/poses.json is not of the scans and places that the session holds";
  }
  return {};
}

Result<bool> keep_pages_anew(SessionStore& store, const PlannedAgain& planned, JobContext& job) {
  const Results& results = planned.results;
  if (!results.checklist.scans_lost.empty()) {
    const std::string lost = listed(results.checklist.scans_lost) + " cannot be read any more";
    const Status taken = take_pages_back_once(
        store, lost, "bring it back (dubsar verify --repair --from a copy) or drop it, and run dubsar plan");
    return taken ? Result<bool>(false) : std::unexpected(taken.error());
  }
  PageFacts facts = page_facts_of(store);
  tell_kept_wedges(facts, store, results.mesh, job);
  const Result<FileLabel> label = label_of_scans(store);
  const Status written = label ? write_pages(store, report_input(results, *planned.stage, facts), *label, job)
                               : std::unexpected(label.error());
  return written ? Result<bool>(true) : std::unexpected(written.error());
}

}  // namespace dubsar

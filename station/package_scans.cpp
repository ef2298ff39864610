// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The raw measurements of a package, and what the session has written down about them.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "acquisition/told_device.h"
#include "core/log.h"
#include "core/parallel.h"
#include "core/scan_list.h"
#include "formats/atomic_file.h"
#include "formats/checklist_json.h"
#include "formats/grid_file.h"
#include "formats/grid_ply.h"
#include "formats/json_node.h"
#include "formats/json_text.h"
#include "formats/poses_json.h"
#include "formats/red_map_json.h"
#include "station/lost_scans.h"
#include "station/package_content.h"
#include "station/packed_names.h"
#include "station/session_scans.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

std::string own_name(const StoredScan& scan) {
  return fmt::format("scans/grids/{:03}.grid", scan.id);
}
std::string ply_name(const StoredScan& scan) {
  return fmt::format("scans/ply/{:03}.ply", scan.id);
}

/// Copies one grid to the bit, once its bytes are known to be what was stored, and unfolds it beside.
Status add_scan(const PackageContent& content, const StoredScan& scan) {
  const fs::path from = content.store.folder() / scan.file;
  const Result<std::string> bytes = read_whole_file(from);
  if (!bytes) {
    return std::unexpected(bytes.error());
  }
  const auto span = std::as_bytes(std::span(bytes->data(), bytes->size()));
  if (const Status whole = verify_grid_bytes(span, from.string()); !whole) {
    return whole;
  }
  if (const Status written = write_file_atomically(content.root / own_name(scan), span);
      !written || !content.has(PackagePart::kGridPly)) {
    return written;
  }
  const Result<RangeGrid> grid = decode_grid(span, from.string());
  return grid ? write_grid_ply(content.root / ply_name(scan), *grid,
                               {.keep_source = true, .label = content.label})
              : std::unexpected(grid.error());
}

/// The poses with the files of their scans: original names may be missing, or those of two scans. A scan that
/// is lost keeps the place that it had.
Result<std::vector<ScanPose>> packed_poses(const PackageContent& content,
                                           const std::vector<StoredScan>& scans) {
  std::vector<ScanPose> poses = content.results().poses;
  const Result<std::vector<ScanPose>> stored = content.store.poses();
  if (!stored) {
    return std::unexpected(stored.error());
  }
  const std::vector<int> lost = lost_scans(scans);
  std::ranges::copy_if(*stored, std::back_inserter(poses),
                       [&](const ScanPose& pose) { return std::ranges::find(lost, pose.id) != lost.end(); });
  std::ranges::sort(poses, {}, &ScanPose::id);
  for (ScanPose& pose : poses) {
    const auto scan = std::ranges::find(scans, pose.id, &StoredScan::id);
    if (scan == scans.end() || scan->damaged) {
      continue;
    }
    pose.packed_as = {own_name(*scan)};
    if (content.has(PackagePart::kGridPly)) {
      pose.packed_as.push_back(ply_name(*scan));
    }
  }
  return poses;
}

/// What a document of the session is, for people.
std::string told_of(const std::string& name) {
  constexpr std::string_view kBegins = "signed ";
  constexpr std::array<std::pair<std::string_view, std::string_view>, 2> kSigned = {
      {{" red_map", "the red map"}, {" checklist", "the checklist"}}};
  for (const auto& [ending, what] : kSigned) {
    if (name.starts_with(kBegins) && name.ends_with(ending) && name.size() > kBegins.size() + ending.size()) {
      const std::string number = name.substr(kBegins.size(), name.size() - kBegins.size() - ending.size());
      return std::string(what) + " that sign-off " + number +
             " stands for, as it was then: formats/sign_off.txt";
    }
  }
  return "the session's document \"" + name + "\", as it was kept: formats/session.txt";
}

OrderedJson scan_json(const PackageContent& content, const StoredScan& scan, const std::string& stored,
                      const std::vector<ScanPose>& poses) {
  OrderedJson json{{"id", scan.id}};
  if (!scan.damaged) {
    json["grid"] = own_name(scan);
    if (content.has(PackagePart::kGridPly)) {
      json["ply"] = ply_name(scan);
    }
  }
  json["source"] = scan.source;
  json["device"] = scan.device;
  json["timestamp_ns"] = scan.timestamp_ns;
  if (!stored.empty()) {
    json["stored"] = stored;
  }
  json["rows"] = scan.rows;
  json["cols"] = scan.cols;
  json["samples"] = scan.samples;
  json["spacing_mm"] = scan.spacing_mm;
  json["taken_out"] = scan.dropped;
  if (!scan.note.empty()) {
    json["note"] = scan.note;
  }
  if (!scan.remark.empty()) {
    json["remark"] = scan.remark;
  }
  json["damaged"] = scan.damaged;
  const auto pose = std::ranges::find(poses, scan.id, &ScanPose::id);
  json["status"] = scan.dropped || pose == poses.end() ? "not placed" : to_string(pose->status);
  return json;
}

/// A document as it was kept, but for where the files of a device lay on that computer.
std::string told(const std::string& name, std::string text) {
  OrderedJson json = name == "device_settings" && json_depth(text) <= kMaxJsonDepth
                         ? OrderedJson::parse(text, nullptr, false)
                         : OrderedJson();
  if (!json.is_object() || !json.contains("devices")) {
    return text;
  }
  for (OrderedJson& device : json["devices"]) {
    if (device.is_object() && device.contains("uri") && device["uri"].is_string()) {
      device["uri"] = told_device(device["uri"].get<std::string>());
    }
  }
  return text_of(json);
}

/// What an event tells; as the text that was stored where that is no JSON, or is deeper than the list of
/// events, with the list and the event around it, may be.
OrderedJson what_of(const SessionEvent& event) {
  constexpr int kAround = 2;
  OrderedJson what = json_depth(event.json) <= kMaxJsonDepth - kAround
                         ? OrderedJson::parse(event.json, nullptr, false)
                         : OrderedJson(event.json);
  return what.is_discarded() ? OrderedJson(event.json) : what;
}

Result<std::string> events_text(const SessionStore& store) {
  const Result<std::vector<SessionEvent>> events = store.events();
  if (!events) {
    return std::unexpected(events.error());
  }
  OrderedJson list = OrderedJson::array();
  for (const SessionEvent& event : *events) {
    OrderedJson json{{"number", event.number}, {"time_ns", event.time_ns}, {"kind", event.kind}};
    json["what"] = what_of(event);
    list.push_back(std::move(json));
  }
  return text_of(list);
}

/// That there are scans whose place is not certain.
void tell_of_unsure(PackageContent& content) {
  std::vector<int> unsure;
  for (const ScanPose& pose : content.results().poses) {
    if (pose.status != PoseStatus::kRegistered) {
      unsure.push_back(pose.id);
    }
  }
  if (unsure.empty()) {
    return;
  }
  const std::string which = listed(unsure);
  content.lacking.push_back(fmt::format(
      "No certain place was found for {}: here as measured, with the reason in scans/poses.json, and "
      "in neither model nor verdict.",
      which));
  log_warning(
      fmt::format("{}: no certain place was found for {}, so that neither model nor verdict has what "
                  "was seen there; dubsar session list tells why",
                  content.store.folder().string(), which));
}

/// That there are scans which the model and the verdict know nothing of.
void tell_of_unplaced(PackageContent& content) {
  const std::vector<int>& unplaced = content.results().checklist.scans_unplaced;
  if (unplaced.empty()) {
    return;
  }
  const std::string which = listed(unplaced);
  content.lacking.push_back(
      fmt::format("No place was worked out yet for {}: stored in the session and here as measured, and in "
                  "neither model nor verdict (dubsar register places what a session holds; where another "
                  "program was scanning into it, the package is of its state at {}).",
                  which, content.when));
  log_warning(
      fmt::format("{}: no place was worked out yet for {}, so that neither model nor verdict has what "
                  "was seen there; dubsar register places what the session holds",
                  content.store.folder().string(), which));
}

}  // namespace

Status add_scans(PackageContent& content) {
  const Result<std::vector<StoredScan>> scans = content.store.scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  const bool any = std::ranges::any_of(*scans, [](const StoredScan& scan) { return !scan.damaged; });
  const bool as_ply = any && content.has(PackagePart::kGridPly);
  for (const char* folder : {"scans/grids/x", "scans/ply/x"}) {
    if (!any || (folder == std::string_view("scans/ply/x") && !as_ply)) {
      continue;
    }
    if (const auto made = content.place(folder); !made) {
      return std::unexpected(made.error());
    }
  }
  std::vector<std::optional<Error>> failed(scans->size());
  std::atomic<std::size_t> done{0};
  parallel_for_each_index(
      scans->size(),
      [&](std::size_t i) {
        const StoredScan& scan = (*scans)[i];
        if (!scan.damaged && !content.job.cancelled()) {
          if (const Status added = add_scan(content, scan); !added) {
            failed[i] = added.error();
          }
        }
        content.job.progress("packing scans",
                             static_cast<double>(done.fetch_add(1) + 1) / static_cast<double>(scans->size()));
      },
      1);
  if (content.job.cancelled()) {
    return fail(ErrorKind::kCancelled, "stopped");
  }
  for (const Error& damage : damage_of_record(content.store)) {
    content.lacking.push_back(fmt::format(
        "When this was packed the session's own record was not whole: {}. What could be read of it, of its "
        "backup and of its scans is here; what it said besides, signatures and places of scans maybe among "
        "it, is not.",
        damage.what));
  }
  const Result<std::vector<ScanPose>> poses = packed_poses(content, *scans);
  if (!poses) {
    return std::unexpected(poses.error());
  }
  tell_of_unplaced(content);
  tell_of_unsure(content);
  const std::map<int, std::string> stored = stored_times(content.store);
  OrderedJson list = OrderedJson::array();
  for (std::size_t i = 0; i < scans->size(); ++i) {
    if (failed[i]) {
      return std::unexpected(*failed[i]);
    }
    const StoredScan& scan = (*scans)[i];
    if (scan.damaged) {
      content.lacking.push_back(fmt::format(
          "Scan {} is damaged in the session, or may not be read: its samples are not here.{}", scan.id,
          std::ranges::find(*poses, scan.id, &ScanPose::id) == poses->end()
              ? ""
              : " Where it lay is in scans/poses.json."));
    }
    const auto at = stored.find(scan.id);
    list.push_back(scan_json(content, scan, at == stored.end() ? std::string() : at->second, *poses));
  }
  if (any) {
    content.list("scans/grids/", "every scan as it was measured, lossless: formats/grid.txt");
  }
  if (as_ply) {
    content.list("scans/ply/",
                 "the same scans as ordered PLY, which other programs read: formats/range_grid_ply.txt");
  }
  return content.text("scans/scans.json", text_of({{"scans", list}}),
                      "the list of the scans: files, device, time, size, and which were taken out and why: "
                      "formats/session.txt");
}

Status add_records(PackageContent& content) {
  const Results& results = content.results();
  const Result<std::vector<StoredScan>> scans = content.store.scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  const Result<std::vector<ScanPose>> poses = packed_poses(content, *scans);
  if (!poses) {
    return std::unexpected(poses.error());
  }
  for (const Status& written :
       {content.text("scans/poses.json", poses_to_json(*poses),
                     "where every scan lies in the model, and how certainly: formats/poses.txt"),
        content.text("verdict/red_map.json", red_map_to_json(results.red_map),
                     "what is sampled too thinly or excused, and why: formats/red_map.txt"),
        content.text("verdict/checklist.json", checklist_to_json(results.checklist),
                     "coverage of the six sides and what the verdict rests on: formats/checklist.txt")}) {
    if (!written) {
      return written;
    }
  }
  const Result<std::vector<std::string>> names = content.store.document_names();
  if (!names) {
    return std::unexpected(names.error());
  }
  const std::vector<std::string> files = document_files(*names);
  for (std::size_t k = 0; k < names->size(); ++k) {
    const std::string& name = (*names)[k];
    const auto document = content.store.load_document(name);
    if (!document) {
      return std::unexpected(document.error());
    }
    if (*document) {
      if (const Status written = content.text("session/" + files[k], told(name, **document), told_of(name));
          !written) {
        return written;
      }
    }
  }
  const Result<std::string> events = events_text(content.store);
  if (!events) {
    return std::unexpected(events.error());
  }
  if (const Status written = content.text(kPackedEvents, *events,
                                          "everything that happened in the session, in order; sign-offs with "
                                          "what was signed: formats/session.txt, formats/sign_off.txt");
      !written) {
    return written;
  }
  for (const FormatText& format : format_texts()) {
    if (const auto made = content.place(std::string("formats/") + format.name); !made) {
      return std::unexpected(made.error());
    } else if (const Status written = write_file_atomically(*made, std::string_view(format.text)); !written) {
      return written;
    }
  }
  content.list("formats/", "every file format of this package that is Dubsar's own, described");
  return {};
}

}  // namespace dubsar

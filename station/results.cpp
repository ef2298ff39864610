// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/results.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <utility>

#include "acquisition/sign_off_log.h"
#include "formats/checklist_json.h"
#include "formats/json_node.h"
#include "formats/mesh_io.h"
#include "formats/red_map_json.h"
#include "formats/sha2.h"
#include "planning/checklist.h"
#include "station/accuracy_words.h"
#include "station/kept_surface.h"
#include "station/lost_scans.h"
#include "station/range_camera_record.h"
#include "station/selected_mesh.h"
#include "station/session_name.h"
#include "station/session_scans.h"
#include "station/tablet_label.h"
#include "station/tablet_record.h"
#include "station/unplaced_scans.h"

namespace dubsar {

namespace {

constexpr const char* kRun = "run";
constexpr const char* kModel = "model";

/// What is to be said of single scans of the session: which are lost, which have none of the places, and what
/// devices remarked on those that stand.
Status tell_of_scans(const SessionStore& store, const std::vector<ScanPose>& poses, Checklist& list) {
  const auto scans = store.scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  list.scans_lost = lost_scans(*scans);
  list.scans_unplaced = unplaced_scans(*scans, poses);
  for (const StoredScan& scan : *scans) {
    if (!scan.dropped && !scan.damaged && !scan.remark.empty()) {
      list.remarks.push_back({scan.id, scan.remark});
    }
  }
  return {};
}

/// As people say it: whole ones, tenths where they are few. Nor should every byte that another program writes
/// change what `plan` prints.
double rounded_gib(double gib) {
  constexpr double kFew = 10;
  return gib >= kFew ? std::floor(gib) : std::floor(10 * gib) / 10;
}

/// Pictures with four pixels to a sample: more would cost time and show nothing new. Small objects are still
/// drawn large enough to look at.
int picture_size_px(const std::vector<PlacedScan>& scans, const Mesh& mesh) {
  constexpr double kPxPerSample = 4;
  constexpr double kLeastPx = 480;
  constexpr double kMostPx = 1000;
  double spacing_mm = std::numeric_limits<double>::infinity();
  for (const PlacedScan& scan : scans) {
    spacing_mm = std::min(spacing_mm, scan.grid->spacing_mm);
  }
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh.positions) {
    box.extend(p);
  }
  const double longest_mm = box.isEmpty() ? 0.0 : static_cast<double>(box.sizes().maxCoeff());
  const double wanted_px = spacing_mm > 0 ? kPxPerSample * longest_mm / spacing_mm : kMostPx;
  return static_cast<int>(std::clamp(wanted_px, kLeastPx, kMostPx));
}

}  // namespace

std::string utc_text(std::time_t time) {
  std::tm utc{};
  gmtime_r(&time, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::string utc_now() {
  return utc_text(std::time(nullptr));
}

std::string program_name() {
  return "Dubsar " DUBSAR_VERSION;
}

Result<Checklist> checklist_of(const RedMap& red_map, const std::vector<ScanPose>& poses,
                               const PlanningStage& stage, const Mesh& mesh, const Rig* rig,
                               const SessionStore* store, JobContext& job) {
  Checklist list = make_checklist(red_map, poses, stage.placed(), mesh, rig);
  if (store == nullptr) {
    return list;
  }
  if (rig == nullptr) {
    tell_of_range_camera(*store, list);
  }
  if (const Status told = tell_of_scans(*store, poses, list); !told) {
    return std::unexpected(told.error());
  }
  list.disk_free_gib = rounded_gib(store->disk_free_gib());
  const Result<VerifyReport> whole = store->verify(job);
  if (!whole && whole.error().kind == ErrorKind::kCancelled) {
    return std::unexpected(whole.error());
  }
  list.store_whole = whole && whole->ok();
  list.store_files = whole ? static_cast<int>(whole->whole.size() + whole->damaged.size()) : 0;
  list.store_checked = utc_now();
  Result<SignOffLog> signed_off = read_sign_offs(*store, job);
  if (!signed_off) {
    return std::unexpected(signed_off.error());
  }
  if (!signed_off->sign_offs.empty()) {
    list.sign_off = std::move(signed_off->sign_offs.back());
  }
  return list;
}

ReportInput report_input(const Results& results, const PlanningStage& stage, const PageFacts& facts) {
  std::vector<ScanPose> counting = results.poses;
  std::erase_if(counting, [&](const ScanPose& pose) {
    return copied_from(results.red_map.copies, pose.id).has_value();
  });
  return {.title = facts.title,
          .tablet = facts.tablet,
          .tool_version = program_name(),
          .when = utc_now(),
          .device = facts.device,
          .model = results.mesh,
          .red_map = results.red_map,
          .checklist = results.checklist,
          .scans = results.poses,
          .entries = facts.scans,
          .red_points = stage.red_points(results.mesh),
          .tablet_from_model = stage.tablet_from_model(results.mesh),
          .wedges = facts.wedges,
          .wedge_profiles = facts.wedge_profiles,
          .accuracy = accuracy_sentences(counting, stage.placed(), facts.gains),
          .calibration = {},
          .not_measured = facts.wedges.empty() ? std::vector<std::string>{"Wedges: they were not looked for."}
                                               : std::vector<std::string>{},
          .timings = facts.timings,
          .longest_px = picture_size_px(stage.placed(), results.mesh)};
}

Status keep_page_facts(SessionStore& store, const PageFacts& facts) {
  OrderedJson timings = OrderedJson::array();
  for (const StageTiming& timing : facts.timings) {
    timings.push_back({{"stage", timing.stage}, {"seconds", timing.seconds}});
  }
  OrderedJson gains = OrderedJson::array();
  for (const ViewGain& gain : facts.gains) {
    OrderedJson entry = {{"scan", gain.scan}, {"actual_cleared_mm2", gain.actual_mm2}};
    if (gain.predicted_mm2) {
      entry["predicted_cleared_mm2"] = *gain.predicted_mm2;
    }
    gains.push_back(std::move(entry));
  }
  return store.save_document(kRun, text_of({{"title", facts.title},
                                            {"device", facts.device},
                                            {"program", program_name()},
                                            {"when", utc_now()},
                                            {"timings", timings},
                                            {"gains", gains},
                                            {"wedges", facts.wedges}}));
}

PageFacts page_facts_of(const SessionStore& store) {
  PageFacts facts;
  facts.title = session_name(store.folder());
  const TabletRecord tablet = tablet_record_of(store);
  if (!tablet.museum_number.empty()) {
    facts.title = tablet.museum_number;
  }
  facts.tablet = words_of(tablet);
  facts.scans = scan_entries_of(store);
  const auto text = store.load_document(kRun);
  const Result<JsonDocument> document =
      text && *text ? JsonDocument::parse(**text, "run") : fail(ErrorKind::kBadInput, "no run");
  if (!document) {
    return facts;  // an earlier session: its pages say less
  }
  const JsonNode root = document->root();
  const std::string device = root.at("device").text();
  const auto program = root.find("program");
  const std::string made_by = program ? program->text() : std::string();
  StageTimes timings;
  for (const JsonNode& timing : root.at("timings").items()) {
    timings.push_back({timing.at("stage").text(), timing.at("seconds").number(0)});
  }
  std::vector<ViewGain> gains;
  if (const auto list = root.find("gains")) {
    for (const JsonNode& gain : list->items()) {
      ViewGain& g = gains.emplace_back();
      g.scan = static_cast<int>(gain.at("scan").integer(0, std::numeric_limits<int>::max()));
      g.actual_mm2 = gain.at("actual_cleared_mm2").number(0);
      if (const auto predicted = gain.find("predicted_cleared_mm2")) {
        g.predicted_mm2 = predicted->number(0);
      }
    }
  }
  std::string wedges;
  if (const auto sentence = root.find("wedges")) {
    wedges = sentence->text();
  }
  if (document->status("")) {
    facts.wedges = std::move(wedges);
    facts.gains = std::move(gains);
    facts.device = device;
    facts.program = made_by;
    facts.timings = std::move(timings);
  }
  return facts;
}

Result<std::vector<ScanPose>> standing_poses(const SessionStore& store) {
  const auto scans = store.scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  Result<std::vector<ScanPose>> poses = store.poses();
  if (poses) {
    std::erase_if(*poses, [&](const ScanPose& pose) {
      const auto scan = std::ranges::find(*scans, pose.id, &StoredScan::id);
      return scan == scans->end() || scan->dropped || scan->damaged;
    });
  }
  return poses;
}

std::string origin_of_mesh(std::vector<ScanPose> poses) {
  std::erase_if(poses, [](const ScanPose& pose) { return pose.status != PoseStatus::kRegistered; });
  std::ranges::sort(poses, {}, &ScanPose::id);
  OrderedJson places = OrderedJson::array();
  for (const ScanPose& pose : poses) {
    places.push_back({pose.id, json_of(pose.model_from_scanner), pose.sigma_mm});
  }
  return sha256_hex(program_name() + "\n" + text_of(places));
}

Result<std::optional<std::filesystem::path>> stored_mesh_file(const SessionStore& store,
                                                              const std::vector<ScanPose>& poses,
                                                              JobContext& job) {
  const auto text = store.load_document(kModel);
  if (!text || !*text) {
    return std::nullopt;
  }
  const Result<JsonDocument> document = JsonDocument::parse(**text, kModel);
  if (!document) {
    return std::nullopt;
  }
  const std::string file = document->root().at("file").text();
  const std::string sum = document->root().at("sha256").text();
  const std::string origin = document->root().at("origin").text();
  if (!document->status("") || origin != origin_of_mesh(poses)) {
    return std::nullopt;
  }
  const Result<std::string> now = sha256_of_file(store.folder() / file, job);
  if (!now && now.error().kind == ErrorKind::kCancelled) {
    return std::unexpected(now.error());
  }
  return now && *now == sum ? std::optional(store.folder() / file) : std::nullopt;
}

std::optional<Mesh> stored_mesh(const SessionStore& store, const std::vector<ScanPose>& poses,
                                JobContext& job) {
  const auto file = stored_mesh_file(store, poses, job);
  if (!file || !*file) {
    return std::nullopt;
  }
  Result<Mesh> mesh = read_mesh(**file);
  return mesh ? std::optional(std::move(*mesh)) : std::nullopt;
}

std::optional<RigidTransform> stored_tablet_from_model(const SessionStore& store) {
  const auto text = store.load_document(kModel);
  if (!text || !*text) {
    return std::nullopt;
  }
  const Result<JsonDocument> document = JsonDocument::parse(**text, kModel);
  if (!document) {
    return std::nullopt;
  }
  const auto node = document->root().find("tablet_from_model");
  if (!node) {
    return std::nullopt;
  }
  const RigidTransform lies = node->transform(1.0);
  return document->status("") ? std::optional(lies) : std::nullopt;
}

namespace {

/// All where no names are given.
Result<Deliverables> keep_files(SessionStore& store, const ReportInput& input,
                                const std::vector<std::string>* names, JobContext& job) {
  const Result<FileLabel> label = label_of_scans(store);
  if (!label) {
    return std::unexpected(label.error());
  }
  const bool with_mesh = names == nullptr || std::ranges::find(*names, kSessionMesh) != names->end();
  if (const Status kept =
          with_mesh && !input.model.faces.empty() ? keep_selected_mesh(store, input.model) : Status();
      !kept) {
    return std::unexpected(kept.error());
  }
  Result<Deliverables> files = names == nullptr ? write_deliverables(store, input, *label, job)
                                                : write_named(store, input, *label, *names, job);
  if (!files) {
    return files;
  }
  if (!files->mesh.empty()) {
    const Result<std::string> sum = sha256_of_file(files->mesh, job);
    if (!sum) {
      return std::unexpected(sum.error());
    }
    const std::string name = files->mesh.lexically_relative(store.folder()).generic_string();
    if (const Status s =
            store.save_document(kModel, text_of({{"file", name},
                                                 {"sha256", *sum},
                                                 {"origin", origin_of_mesh(input.scans)},
                                                 {"tablet_from_model", json_of(input.tablet_from_model)}}));
        !s) {
      return std::unexpected(s.error());
    }
  }
  return files;
}

}  // namespace

Result<Deliverables> keep_deliverables(SessionStore& store, const ReportInput& input, JobContext& job) {
  return keep_files(store, input, nullptr, job);
}

Result<Deliverables> keep_deliverables(SessionStore& store, const ReportInput& input,
                                       const std::vector<std::string>& names, JobContext& job) {
  return keep_files(store, input, &names, job);
}

}  // namespace dubsar

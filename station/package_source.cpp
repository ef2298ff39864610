// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/package_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "acquisition/sign_off_log.h"
#include "core/log.h"
#include "core/utf8.h"
#include "formats/atomic_file.h"
#include "formats/checklist_json.h"
#include "formats/poses_json.h"
#include "formats/red_map_json.h"
#include "station/followed_word.h"
#include "station/lost_scans.h"
#include "station/same_places.h"
#include "station/unplaced_scans.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// The files in which the session keeps its verdict. There is a red sheet wherever there is a mesh.
constexpr std::array<const char*, 5> kVerdictFiles = {"export/report.html", "export/checklist.html",
                                                      "export/red_map.png", "export/red_map.json",
                                                      "export/poses.json"};

/// A file of the session, when it is what was recorded.
std::optional<std::string> recorded(const SessionStore& store, const VerifyReport& whole,
                                    const std::string& file) {
  if (std::ranges::find(whole.whole, file) == whole.whole.end()) {
    return std::nullopt;
  }
  Result<std::string> bytes = read_whole_file(store.folder() / file);
  return bytes ? std::optional(std::move(*bytes)) : std::nullopt;
}

std::string not_as_stored(const Error& damage) {
  return fmt::format("{} is not as it was stored ({})", one_line(damage.where), one_line(damage.what));
}

/// What is wrong with the record or one of these files; empty where nothing is.
std::string fault_of_verdict_files(const VerifyReport& whole) {
  for (const Error& damage : whole.damaged) {
    // The backup and the list of checksums may be lost: every row has a checksum of its own.
    if (damage.where.starts_with("session.sqlite")) {
      return not_as_stored(damage);
    }
  }
  for (const char* file : kVerdictFiles) {
    const auto damage = std::ranges::find(whole.damaged, file, &Error::where);
    if (damage != whole.damaged.end()) {
      return not_as_stored(*damage);
    }
    if (std::ranges::find(whole.whole, file) == whole.whole.end()) {
      return std::string("the session has no record of ") + file;
    }
  }
  return {};
}

/// What is wrong with the mesh that is not that of the poses.
std::string fault_of_mesh(const VerifyReport& whole) {
  const auto damage =
      std::ranges::find_if(whole.damaged, [](const Error& one) { return one.where.starts_with("mesh"); });
  return damage == whole.damaged.end()
             ? "the session has no mesh of the scans where they lie now, made by this version of the program"
             : not_as_stored(*damage);
}

/// Why the latest sign-off is not that of the page; empty where it is, or where there is none.
std::string fault_of_signature(const std::vector<CheckedSignOff>& sign_offs, const std::string& page) {
  if (sign_offs.empty()) {
    return {};
  }
  if (!sign_offs.back().holds()) {
    return "the session has changed since they were signed";
  }
  return page.find(sign_offs.back().sign_off.digest) == std::string::npos
             ? "the latest signature does not stand on them"
             : std::string();
}

}  // namespace

std::vector<Error> damage_of_record(const SessionStore& store) {
  std::vector<Error> out = store.opening().damage;
  std::erase_if(out, [](const Error& damage) { return damage.where.ends_with(".grid"); });
  return out;
}

Status PackageSource::take_kept(JobContext& job) {
  const SessionStore& store = *store_;
  Result<VerifyReport> whole = store.verify(job);
  if (!whole) {
    return std::unexpected(whole.error());
  }
  for (const Error& damage : whole->damaged) {
    // Grids and the record are named where they are read again.
    if (!damage.where.ends_with(".grid") && !damage.where.starts_with("session.")) {
      log_warning(damage.line());
    }
  }
  found_ = *whole;
  Result<std::vector<ScanPose>> poses = standing_poses(store);
  if (!poses) {
    return std::unexpected(poses.error());
  }
  const Result<std::vector<StoredScan>> scans = store.scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  why_anew_ = fault_of_verdict_files(found_);
  if (!why_anew_.empty()) {
    return {};
  }
  const auto map_text = store.load_document("red_map");
  const auto list_text = store.load_document("checklist");
  const std::string where = store.folder().string();
  Result<RedMap> map = map_text && *map_text ? parse_red_map(**map_text, where + " (red map)")
                                             : fail(ErrorKind::kBadInput, "no red map");
  Result<Checklist> list = list_text && *list_text ? parse_checklist(**list_text, where + " (checklist)")
                                                   : fail(ErrorKind::kBadInput, "no checklist");
  Result<SignOffLog> signed_off = read_sign_offs(store, job);
  if (!signed_off && signed_off.error().kind == ErrorKind::kCancelled) {
    return std::unexpected(signed_off.error());
  }
  if (!map || !list || !signed_off) {
    why_anew_ = "the session's record has no verdict that can be read";
    return {};
  }
  // The mesh and the pages are of the places as they are written there, to the last digit.
  const auto shown = recorded(store, found_, "export/poses.json");
  if (const auto lie = shown ? parse_poses(*shown, "export/poses.json") : std::vector<ScanPose>()) {
    *poses = as_shown(std::move(*poses), *lie);
  }
  const bool of_scans = recorded(store, found_, "export/red_map.json") == **map_text &&
                        shown == poses_to_json(*poses) && list->scans_lost == lost_scans(*scans) &&
                        list->scans_unplaced == unplaced_scans(*scans, *poses);
  if (!of_scans) {
    why_anew_ = "they are not all of the scans as they stand";
    return {};
  }
  const auto report = recorded(store, found_, "export/report.html");
  const auto checklist = recorded(store, found_, "export/checklist.html");
  const auto red_sheet = recorded(store, found_, "export/red_map.png");
  if (!report || !checklist || !red_sheet) {
    why_anew_ = "a page cannot be read any more";
    return {};
  }
  why_anew_ = fault_of_signature(signed_off->sign_offs, *checklist);
  if (!why_anew_.empty()) {
    return {};
  }
  const std::optional<RigidTransform> lies = stored_tablet_from_model(store);
  std::optional<Mesh> mesh = lies ? stored_mesh(store, *poses, job) : std::nullopt;
  if (!mesh) {
    why_anew_ = fault_of_mesh(found_);
    return {};
  }
  if (!signed_off->sign_offs.empty()) {
    list->sign_off = std::move(signed_off->sign_offs.back());
  }
  results_ = {std::move(*poses), std::move(*map), std::move(*mesh), std::move(*list)};
  tablet_from_model_ = *lies;
  pages_ = KeptPages{*report, *checklist, *red_sheet};
  return {};
}

Result<PackageSource> PackageSource::open(const fs::path& session, JobContext& job) {
  PackageSource source;
  {
    Result<SessionStore> store = SessionStore::open(session, SessionStore::Access::kReadOnly);
    if (!store) {
      return std::unexpected(store.error());
    }
    source.store_ = std::move(*store);
  }
  if (const Status taken = source.take_kept(job); !taken) {
    return std::unexpected(taken.error());
  }
  if (source.pages_) {
    return source;
  }
  std::error_code unknown;
  if (!fs::exists(session / "export/report.html", unknown) &&
      !fs::exists(session / "export/checklist.html", unknown)) {
    source.why_anew_.clear();
  }
  log_info(source.why_anew_.empty()
               ? "the session keeps no pages: the verdict is worked out for the package"
               : "the verdict is worked out anew, with its pages, for those that the session keeps are not "
                 "packed: " +
                     source.why_anew_);
  source.store_.reset();
  Result<ScanSet> set =
      load_scan_set(session, {.access = SessionStore::Access::kReadOnly, .may_be_empty = true}, job);
  if (!set) {
    return std::unexpected(set.error());
  }
  source.set_ = std::move(*set);
  if (source.set_->scans.empty()) {
    log_warning(
        "no scan of the session stands and can be read: there is no model to be had, nor what is made of "
        "one; all else is packed");
  }
  Result<std::string> behind = not_followed_sentence(*source.set_);
  if (!behind) {
    return std::unexpected(behind.error());
  }
  source.behind_ = std::move(*behind);
  Result<PlannedAgain> planned = plan_again(*source.set_, source.set_->poses, job);
  if (!planned) {
    return std::unexpected(planned.error());
  }
  source.planned_ = std::move(*planned);
  source.tablet_from_model_ = source.planned_->stage->tablet_from_model(source.planned_->results.mesh);
  return source;
}

}  // namespace dubsar

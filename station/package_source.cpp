// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/package_source.h"

#include <algorithm>

#include "acquisition/sign_off_log.h"
#include "core/log.h"
#include "formats/atomic_file.h"
#include "formats/checklist_json.h"
#include "formats/poses_json.h"
#include "formats/red_map_json.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// A file of the session's export folder, when it is what was recorded.
std::optional<std::string> recorded(const SessionStore& store, const VerifyReport& whole, const char* name) {
  const std::string file = std::string("export/") + name;
  if (std::ranges::find(whole.whole, file) == whole.whole.end()) {
    return std::nullopt;
  }
  Result<std::string> bytes = read_whole_file(store.folder() / file);
  return bytes ? std::optional(std::move(*bytes)) : std::nullopt;
}

/// The latest sign-off holds and stands on the page; or there is none.
bool signed_as_shown(const std::vector<CheckedSignOff>& sign_offs, const std::string& page) {
  return sign_offs.empty() ||
         (sign_offs.back().holds() && page.find(sign_offs.back().sign_off.digest) != std::string::npos);
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
  const auto map_text = store.load_document("red_map");
  const auto list_text = store.load_document("checklist");
  const auto report = recorded(store, *whole, "report.html");
  const auto checklist = recorded(store, *whole, "checklist.html");
  const auto red_sheet = recorded(store, *whole, "red_map.png");  // there is one wherever there is a mesh
  const bool together = whole->ok() && map_text && *map_text && list_text && *list_text && report &&
                        checklist && red_sheet && recorded(store, *whole, "red_map.json") == **map_text &&
                        recorded(store, *whole, "poses.json") == poses_to_json(*poses);
  if (!together) {
    return {};
  }
  const std::string where = store.folder().string();
  Result<RedMap> map = parse_red_map(**map_text, where + " (red map)");
  Result<Checklist> list = parse_checklist(**list_text, where + " (checklist)");
  Result<SignOffLog> signed_off = read_sign_offs(store, job);
  if (!signed_off && signed_off.error().kind == ErrorKind::kCancelled) {
    return std::unexpected(signed_off.error());
  }
  if (!map || !list || !signed_off || !signed_as_shown(signed_off->sign_offs, *checklist)) {
    return {};
  }
  const std::optional<RigidTransform> lies = stored_tablet_from_model(store);
  std::optional<Mesh> mesh = lies ? stored_mesh(store, *poses, job) : std::nullopt;
  if (!mesh) {
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
  const bool has_pages = fs::exists(session / "export/report.html", unknown);
  log_info(has_pages
               ? "the session's pages are not of its scans as they lie now: the verdict is worked out anew"
               : "the session keeps no pages: the verdict is worked out for the package");
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
  Result<PlannedAgain> planned = plan_again(*source.set_, source.set_->poses, job);
  if (!planned) {
    return std::unexpected(planned.error());
  }
  source.planned_ = std::move(*planned);
  source.tablet_from_model_ = source.planned_->stage->tablet_from_model(source.planned_->results.mesh);
  return source;
}

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/engine_impl.h"

namespace dubsar {

namespace {

std::string iso_time() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::vector<std::string> accuracy_sentences(const std::vector<ScanPose>& poses) {
  double worst_sigma_mm = 0;
  double worst_rms_mm = 0;
  for (const ScanPose& pose : poses) {
    if (pose.status == PoseStatus::kRegistered) {
      worst_sigma_mm = std::max(worst_sigma_mm, pose.sigma_mm);
      worst_rms_mm = std::max(worst_rms_mm, pose.rms_mm);
    }
  }
  return {fmt::format(
              "Where scans overlap, their surfaces lie within {:.1f} µm RMS of each other in the worst scan.",
              1000 * worst_rms_mm),
          fmt::format(
              "The predicted error of a scan's place is at most {:.1f} µm (one standard deviation), from the "
              "overlaps alone; the calibration of the scanner comes on top.",
              1000 * worst_sigma_mm)};
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

/// Mesh, checklist, pictures and report of the settled scans.
Status Engine::Impl::finish(EngineResult& result, JobContext& job) {
  Mesh mesh;
  {
    const StageClock timing = clock("final planning and meshing");
    Result<Mesh> stitched = planning.mesh(job);
    if (!stitched) {
      return std::unexpected(stitched.error());
    }
    mesh = std::move(*stitched);
  }
  result.checklist =
      make_checklist(result.red_map, result.poses, planning.placed(), mesh, rig ? &*rig : nullptr);
  result.checklist.disk_free_gib = store->disk_free_gib();
  const Result<VerifyReport> whole = store->verify(job);
  result.checklist.store_whole = whole && whole->ok();
  for (const auto& [stage, spent] : seconds) {
    result.timings.push_back({stage, spent});
  }
  result.stored_scans = stored_count;
  result.device_error = device_error;

  const auto started = std::chrono::steady_clock::now();
  const ReportInput input{.title = options.session.filename().string(),
                          .tool_version = "Dubsar " DUBSAR_VERSION,
                          .when = iso_time(),
                          .device = options.device,
                          .model = mesh,
                          .red_map = result.red_map,
                          .checklist = result.checklist,
                          .scans = result.poses,
                          .red_points = planning.red_points(mesh),
                          .tablet_from_model = planning.tablet_from_model(mesh),
                          .accuracy = accuracy_sentences(result.poses),
                          .calibration = {},
                          .not_measured = {"Wedges: they are not measured yet."},
                          .timings = result.timings,
                          .longest_px = picture_size_px(planning.placed(), mesh)};
  Result<Deliverables> files = write_deliverables(options.session, input, job);
  if (!files) {
    return std::unexpected(files.error());
  }
  result.files = std::move(*files);
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - started;
  result.timings.push_back({"pictures and report", spent.count()});
  return keep_results(result);
}

/// The verdict and what it rests on go into the session, so that anyone can work it out again.
Status Engine::Impl::keep_results(const EngineResult& result) {
  if (const Status s = store->save_document("red_map", red_map_to_json(result.red_map)); !s) {
    return s;
  }
  if (const Status s = store->save_document("checklist", checklist_to_json(result.checklist)); !s) {
    return s;
  }
  for (const std::filesystem::path* file :
       {&result.files.mesh, &result.files.six_views, &result.files.red_map, &result.files.report,
        &result.files.poses, &result.files.red_map_json}) {
    if (file->empty()) {
      continue;
    }
    if (const Status s = store->record_file(std::filesystem::relative(*file, options.session)); !s) {
      return s;
    }
  }
  return store->append_event(
      "finished", result.red_map.conclusive ? R"({"conclusive":true})" : R"({"conclusive":false})");
}

}  // namespace dubsar

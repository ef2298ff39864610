// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "archive/render_scene.h"
#include "archive/scan_entries.h"
#include "core/checklist.h"
#include "core/job.h"
#include "core/mesh.h"
#include "core/red_map.h"
#include "core/result.h"
#include "core/rigid_transform.h"
#include "core/scan_pose.h"
#include "core/stage_times.h"
#include "core/wedge_profile.h"

namespace dubsar {

/// What people say of a tablet: name of the fact, fact.
using TabletWords = std::vector<std::pair<std::string, std::string>>;

/// Everything that the report tells. The references must outlive the call.
struct ReportInput {
  std::string title;         ///< what was scanned, such as a museum number
  TabletWords tablet{};      ///< what is known of it, in the order of the page
  std::string tool_version;  ///< "Dubsar 0.1.0"
  std::string when;          ///< ISO 8601, as the caller says it: nothing here looks at a clock
  std::string device;
  const Mesh& model;
  const RedMap& red_map;
  const Checklist& checklist;
  const std::vector<ScanPose>& scans;
  std::vector<ScanEntry> entries{};  ///< of all scans, those that were taken out too; empty without a session
  ColouredPoints red_points;         ///< red and excused samples in the model frame
  RigidTransform tablet_from_model;  ///< which way the faces look; see face_camera()
  std::string wedges;                ///< a sentence on them; empty: nobody looked
  std::vector<WedgeProfile> wedge_profiles{};  ///< of the tablet and of each written side; empty: not known
  std::vector<std::string> accuracy;  ///< sentences on how good the registration is and how it was measured
  std::vector<std::string> calibration;  ///< sentences beyond checklist.calibration
  std::vector<std::string> not_measured;
  StageTimes timings;
  int longest_px = 1000;  ///< of the longest side in the pictures
};

struct ReportPictures;  // archive/report_pictures.h

/// One self-contained HTML page: verdict in plain words, pictures of the six sides, red map, next views,
/// checklist, sign-off, regions, scans, accuracy, what was not measured, times. No script, no link to
/// anything outside, pictures inside as data URIs; every outside text escaped; life size on paper where it
/// fits. The same input gives the same bytes. Without a surface the page says so instead of showing pictures.
/// Errors: a picture that cannot be encoded.
[[nodiscard]] Result<std::string> report_html(const ReportInput& input, const ReportPictures& pictures);

/// The page that is signed and filed: verdict, sign-off, checklist, red map, and every red or excused place
/// with its picture; the same sections as the report's, without the rest. Prints on A4.
[[nodiscard]] std::string checklist_html(const ReportInput& input, const ReportPictures& pictures);

/// The page with another title, and other words on the tablet: a record may be corrected after the pages were
/// made, and neither verdict nor pictures follow from it. A page that report_html(), checklist_html() or
/// behind_html() made; any other comes back as it is.
[[nodiscard]] std::string page_renamed(std::string page, const std::string& title, const TabletWords& tablet);

/// The page with other words on the wedges, likewise: they may be corrected, or left out of a package, after
/// it was made. A page that tells of none stays as it is.
[[nodiscard]] std::string page_with_wedges(std::string page, const std::string& sentence,
                                           const std::vector<WedgeProfile>& profiles);

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <cmath>
#include <vector>

#include "archive/html.h"
#include "archive/report_sections.h"

namespace dubsar {

namespace {

constexpr std::size_t kMostRows = 500;

std::string row(const std::vector<std::string>& cells, const std::string& row_class = {}) {
  std::string html = row_class.empty() ? "<tr>" : "<tr class=\"" + row_class + "\">";
  for (const std::string& cell : cells) {
    html += "<td>" + cell + "</td>";
  }
  return html + "</tr>\n";
}

std::string table(const std::string& table_class, const std::vector<std::string>& names,
                  const std::string& rows) {
  std::string html = "<div class=\"wide\"><table class=\"" + table_class + "\">\n<thead><tr>";
  for (const std::string& name : names) {
    html += "<th scope=\"col\">" + name + "</th>";
  }
  return html + "</tr></thead>\n<tbody>\n" + rows + "</tbody>\n</table></div>\n";
}

std::string paragraphs(const std::vector<std::string>& sentences) {
  std::string html;
  for (const std::string& sentence : sentences) {
    html += "<p>" + html_escaped(sentence) + "</p>\n";
  }
  return html;
}

std::string micrometres(double mm) {
  return fixed(mm * 1000.0, 1);
}

std::string place(const Eigen::Vector3d& p) {
  return fixed(p.x(), 1) + ", " + fixed(p.y(), 1) + ", " + fixed(p.z(), 1);
}

const RedScan* find_counts(const RedMap& map, int id) {
  const auto found =
      std::find_if(map.scans.begin(), map.scans.end(), [&](const RedScan& scan) { return scan.id == id; });
  return found == map.scans.end() ? nullptr : &*found;
}

}  // namespace

std::string checklist_section(const ReportInput& input) {
  const Checklist& list = input.checklist;
  std::string rows;
  FaceCoverage total;
  for (int f = 0; f < kFaceCount; ++f) {
    const FaceCoverage& face = list.faces[static_cast<std::size_t>(f)];
    total.seen_mm2 += face.seen_mm2;
    total.red_mm2 += face.red_mm2;
    total.excused_mm2 += face.excused_mm2;
    const std::string state = face.seen_mm2 <= 0 ? "not seen" : face.red_mm2 > 0 ? "red" : "done";
    rows += row({to_string(static_cast<Face>(f)), fixed(face.seen_mm2, 1), fixed(face.red_mm2, 2),
                 fixed(face.excused_mm2, 2), state},
                state == "done" ? "" : "open");
  }
  rows +=
      row({"all", fixed(total.seen_mm2, 1), fixed(total.red_mm2, 2), fixed(total.excused_mm2, 2), ""}, "sum");
  std::string html = "<section>\n<h2>Checklist</h2>\n" +
                     table("faces", {"Face", "Meshed, mm²", "Red, mm²", "Excused, mm²", "State"}, rows);
  const std::string age =
      list.calibration_age_days ? ", " + fixed(*list.calibration_age_days, 1) + " days old" : "";
  html += "<dl>\n<dt>Scans</dt><dd>" + std::to_string(list.scans_registered) + " registered, " +
          std::to_string(list.scans_unsure) + " unsure, " + std::to_string(list.scans_failed) +
          " failed</dd>\n";
  html += "<dt>Calibration</dt><dd>" +
          (list.calibration.empty() ? "the device told none" : html_escaped(list.calibration) + age) +
          "</dd>\n";
  html += std::string("<dt>Store</dt><dd>") +
          (list.store_whole ? "every stored byte matches its checksum" : "not verified") + "; " +
          fixed(list.disk_free_gib, 1) + " GiB free</dd>\n</dl>\n";
  return html + "</section>\n";
}

std::string regions_section(const ReportInput& input) {
  std::vector<const RedRegion*> regions;
  regions.reserve(input.red_map.regions.size());
  for (const RedRegion& region : input.red_map.regions) {
    regions.push_back(&region);
  }
  if (regions.empty()) {
    return "<section>\n<h2>Red and excused places</h2>\n<p>None.</p>\n</section>\n";
  }
  // What is still to do first, then the largest first.
  const auto size = [](const RedRegion* r) { return std::isfinite(r->area_mm2) ? r->area_mm2 : 0.0; };
  std::stable_sort(regions.begin(), regions.end(), [&](const RedRegion* a, const RedRegion* b) {
    return a->state != b->state ? a->state == RegionState::kRed : size(a) > size(b);
  });
  std::string rows;
  double rest_mm2 = 0;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const RedRegion& region = *regions[i];
    if (i >= kMostRows) {
      rest_mm2 += size(&region);
      continue;
    }
    const bool is_red = region.state == RegionState::kRed;
    const char* excuse = region.excuse == Excuse::kUnreachable ? "unreachable"
                         : region.excuse == Excuse::kUnneeded  ? "unneeded"
                                                               : "excused";
    rows += row({is_red ? "red" : excuse, to_string(region.face), place(region.center_mm),
                 fixed(region.area_mm2, 2), html_escaped(region.reason)},
                is_red ? "open" : "");
  }
  std::string html = "<section>\n<h2>Red and excused places</h2>\n" +
                     table("regions", {"State", "Face", "Centre x, y, z, mm", "Area, mm²", "Reason"}, rows);
  if (regions.size() > kMostRows) {
    html += "<p>" + std::to_string(regions.size() - kMostRows) + " smaller places, " + fixed(rest_mm2, 2) +
            " mm² together, are left out of this table; the red map file lists them all.</p>\n";
  }
  return html +
         "<p class=\"aside\">An area is that of the hole which the red border encloses, by estimate: what "
         "nobody "
         "has seen has no samples. Centres are in the model frame.</p>\n</section>\n";
}

std::string scans_section(const ReportInput& input) {
  if (input.scans.empty()) {
    return "<section>\n<h2>Scans</h2>\n<p>There are none.</p>\n</section>\n";
  }
  std::string rows;
  for (const ScanPose& scan : input.scans) {
    const RedScan* counts = find_counts(input.red_map, scan.id);
    const bool placed = scan.status != PoseStatus::kFailed;
    const std::string dash = "–";
    rows +=
        row({std::to_string(scan.id), html_escaped(scan.file),
             std::string(to_string(scan.status)) + (scan.locked ? ", fixed by the operator" : ""),
             placed ? micrometres(scan.rms_mm) : dash, placed ? micrometres(scan.sigma_mm) : dash,
             placed ? fixed(100.0 * scan.overlap, 0) : dash, counts ? std::to_string(counts->samples) : dash,
             counts ? std::to_string(counts->sparse) : dash, counts ? std::to_string(counts->cleared) : dash,
             counts ? std::to_string(counts->excused) : dash, html_escaped(scan.reason)},
            scan.status == PoseStatus::kRegistered ? "" : "open");
  }
  return "<section>\n<h2>Scans</h2>\n" +
         table("scans",
               {"No", "File", "Status", "rms, µm", "σ, µm", "Overlap, %", "Samples", "Red", "Cleared",
                "Excused", "Reason"},
               rows) +
         "<p class=\"aside\">rms: residual from points to the surface of the other scans over the overlap. "
         "σ: how far "
         "this scan’s surface may be off because of its pose, as predicted. Overlap: share of the smaller "
         "scan that "
         "lies on the rest.</p>\n</section>\n";
}

std::string accuracy_section(const ReportInput& input) {
  std::vector<double> rms_mm;
  double worst_sigma_mm = 0;
  for (const ScanPose& scan : input.scans) {
    if (scan.status == PoseStatus::kRegistered && std::isfinite(scan.rms_mm)) {
      rms_mm.push_back(scan.rms_mm);
      worst_sigma_mm = std::max(worst_sigma_mm, scan.sigma_mm);
    }
  }
  std::string html = "<section>\n<h2>Accuracy</h2>\n";
  if (!rms_mm.empty()) {
    const auto middle = rms_mm.begin() + static_cast<std::ptrdiff_t>(rms_mm.size() / 2);
    std::nth_element(rms_mm.begin(), middle, rms_mm.end());
    html += "<p>Over the registered scans, the median residual between scans is " + micrometres(*middle) +
            " µm; the largest predicted displacement of a scan by its pose is " +
            micrometres(worst_sigma_mm) +
            " µm. Both say how well the scans agree with each other, not how true the scanner’s lengths "
            "are.</p>\n";
  }
  html += paragraphs(input.accuracy);
  if (input.checklist.calibration.empty()) {
    html += "<p>The device told no calibration: lengths are as good as its own word.</p>\n";
  }
  return html + paragraphs(input.calibration) + "</section>\n";
}

std::string not_measured_section(const ReportInput& input) {
  std::string items;
  for (const std::string& sentence : input.not_measured) {
    items += "<li>" + html_escaped(sentence) + "</li>\n";
  }
  const auto interpolated =
      std::count_if(input.model.flags.begin(), input.model.flags.end(),
                    [](std::uint8_t flags) { return (flags & kVertexInterpolated) != 0; });
  if (interpolated > 0) {
    items += "<li>" + counted(interpolated, "vertex", "vertices") +
             " of the mesh fill small gaps by interpolation; they are marked in the mesh file.</li>\n";
  }
  return items.empty() ? std::string()
                       : "<section>\n<h2>What was not measured</h2>\n<ul>\n" + items + "</ul>\n</section>\n";
}

std::string timings_section(const ReportInput& input) {
  if (input.timings.empty()) {
    return {};
  }
  std::string rows;
  for (const StageTiming& timing : input.timings) {
    rows += row({html_escaped(timing.stage), fixed(timing.seconds, 2)});
  }
  return "<section>\n<h2>Time</h2>\n" + table("times", {"Stage", "Seconds"}, rows) + "</section>\n";
}

}  // namespace dubsar

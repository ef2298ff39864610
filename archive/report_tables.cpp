// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <cmath>
#include <vector>

#include "archive/html.h"
#include "archive/html_table.h"
#include "archive/report_sections.h"
#include "core/order_statistics.h"
#include "core/scan_remark.h"

namespace dubsar {

namespace {

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

/// What registration found of it, then what its device remarked.
std::string remarks_on(const ScanPose& scan, const Checklist& checklist) {
  std::string out = remark_of(scan);
  for (const ScanWarning& remark : checklist.remarks) {
    if (remark.scan == scan.id) {
      out += (out.empty() ? "" : "; ") + remark.text;
    }
  }
  return out;
}

/// The file, and below it when the scan was made.
std::string file_cell(const ReportInput& input, int id, const std::string& file) {
  const auto entry = std::ranges::find(input.entries, id, &ScanEntry::id);
  if (entry == input.entries.end() || entry->when.empty()) {
    return html_escaped(file);
  }
  std::string when = entry->when;
  std::ranges::replace(when, 'T', ' ');
  std::erase(when, 'Z');
  return html_escaped(file) + "<br><span class=\"aside\">" + (entry->by_device ? "" : "stored ") +
         html_escaped(when) + " UTC</span>";
}

/// The scans that the operator took out, with the reason: in nothing else of the report.
std::string taken_out_rows(const ReportInput& input) {
  const std::string dash = "–";
  std::string rows;
  for (const ScanEntry& scan : input.entries) {
    if (scan.taken_out) {
      rows += table_row({std::to_string(scan.id), file_cell(input, scan.id, scan.file), "taken out", dash,
                         dash, dash, dash, dash, dash, dash,
                         scan.why.empty() ? "no reason was given" : html_escaped(scan.why)});
    }
  }
  return rows;
}

/// The scans that are stored and have no place yet: in nothing else of the table.
std::string unplaced_rows(const ReportInput& input) {
  const std::string dash = "–";
  std::string rows;
  for (const int id : input.checklist.scans_unplaced) {
    const auto entry = std::ranges::find(input.entries, id, &ScanEntry::id);
    const std::string file = entry == input.entries.end() ? std::string() : entry->file;
    rows += table_row({std::to_string(id), file_cell(input, id, file), "not placed yet", dash, dash, dash,
                       dash, dash, dash, dash, "stored, and in neither model nor verdict"},
                      "open");
  }
  return rows;
}

const RedScan* find_counts(const RedMap& map, int id) {
  const auto found =
      std::find_if(map.scans.begin(), map.scans.end(), [&](const RedScan& scan) { return scan.id == id; });
  return found == map.scans.end() ? nullptr : &*found;
}

}  // namespace

std::string scans_section(const ReportInput& input) {
  const std::string others = unplaced_rows(input) + taken_out_rows(input);
  if (input.scans.empty() && others.empty()) {
    return "<section>\n<h2>Scans</h2>\n<p>There are none.</p>\n</section>\n";
  }
  std::string rows;
  for (const ScanPose& scan : input.scans) {
    const RedScan* counts = find_counts(input.red_map, scan.id);
    const std::optional<int> first = copied_from(input.red_map.copies, scan.id);
    // What an unsure one has is of a place that was not taken.
    const bool placed = scan.status == PoseStatus::kRegistered;
    const std::string dash = "–";
    rows += table_row(
        {std::to_string(scan.id), file_cell(input, scan.id, scan.file),
         std::string(to_string(scan.status)) + (scan.locked ? ", fixed by the operator" : "") +
             (first ? ", a copy of scan " + std::to_string(*first) : ""),
         placed && was_compared(scan) ? micrometres(scan.rms_mm) : dash,
         placed ? micrometres(scan.sigma_mm) : dash, placed ? fixed(100.0 * scan.overlap, 0) : dash,
         counts ? std::to_string(counts->samples) : dash, counts ? std::to_string(counts->sparse) : dash,
         counts ? std::to_string(counts->cleared) : dash, counts ? std::to_string(counts->excused) : dash,
         html_escaped(remarks_on(scan, input.checklist))},
        scan.status == PoseStatus::kRegistered && scan.warning.empty() ? "" : "open");
  }
  return "<section>\n<h2>Scans</h2>\n" +
         html_table("scans",
                    {"No", "File", "Status", "rms, µm", "σ, µm", "Overlap, %", "Samples", "Red", "Cleared",
                     "Excused", "Remark"},
                    rows + others) +
         "<p class=\"aside\">rms: residual from points to the surface of the other scans over the overlap. "
         "σ: how far "
         "this scan’s surface may be off because of its pose, as predicted. Overlap: share of the smaller "
         "scan that "
         "lies on the rest. Below a file: when it was scanned, as its device says, or when the session "
         "stored "
         "it.</p>\n</section>\n";
}

std::string accuracy_section(const ReportInput& input) {
  std::vector<double> rms_mm;
  double worst_sigma_mm = 0;
  for (const ScanPose& scan : input.scans) {
    if (scan.status == PoseStatus::kRegistered && std::isfinite(scan.rms_mm) && was_compared(scan) &&
        !copied_from(input.red_map.copies, scan.id)) {
      rms_mm.push_back(scan.rms_mm);
      worst_sigma_mm = std::max(worst_sigma_mm, scan.sigma_mm);
    }
  }
  std::string html = "<section>\n<h2>Accuracy</h2>\n";
  if (!rms_mm.empty()) {
    html += "<p>Over the registered scans, the median residual between scans is " +
            micrometres(median_of(rms_mm)) +
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
    rows += table_row({html_escaped(timing.stage), fixed(timing.seconds, 2)});
  }
  return "<section>\n<h2>Time</h2>\n" + html_table("times", {"Stage", "Seconds"}, rows) + "</section>\n";
}

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The checklist: what was seen and how well, face by face, and what the verdict rests on.

#include <cmath>

#include "archive/html.h"
#include "archive/html_table.h"
#include "archive/report_sections.h"
#include "core/scan_list.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr const char* kDash = "–";

/// Rounded towards what is missing: a hair below all is not all.
std::string percent(double share, int decimals = 1) {
  const double steps = std::pow(10.0, decimals);
  return fixed(share >= 1 ? 100.0 : std::floor(100 * share * steps + (share < 0.5 ? 0.5 : 0.0)) / steps,
               decimals);
}

/// "3.25 in 2: 2.00, 1.25"
std::string sizes(double all_mm2, const std::vector<double>& each_mm2) {
  constexpr std::size_t kMost = 5;
  if (each_mm2.empty()) {
    return "0";
  }
  std::string text = fixed(all_mm2, 2) + " in " + std::to_string(each_mm2.size());
  for (std::size_t k = 0; k < each_mm2.size() && k < kMost && each_mm2.size() > 1; ++k) {
    text += (k == 0 ? ": " : ", ") + fixed(each_mm2[k], 2);
  }
  return text + (each_mm2.size() > kMost ? ", …" : "");
}

std::string faces_table(const Checklist& list) {
  std::string rows;
  FaceCoverage total;
  for (int f = 0; f < kFaceCount; ++f) {
    const FaceCoverage& face = list.faces[static_cast<std::size_t>(f)];
    total.seen_mm2 += face.seen_mm2;
    total.interpolated_mm2 += face.interpolated_mm2;
    total.red_mm2 += face.red_mm2;
    total.excused_mm2 += face.excused_mm2;
    const bool is_red = !face.red_regions_mm2.empty() || face.red_mm2 > 0;
    const std::string state = face.seen_mm2 <= 0 ? "not seen" : is_red ? "red" : "done";
    rows +=
        table_row({to_string(static_cast<Face>(f)), fixed(face.seen_mm2, 1), percent(face.coverage(), 2),
                   sizes(face.red_mm2, face.red_regions_mm2),
                   sizes(face.excused_mm2, face.excused_regions_mm2), fixed(face.interpolated_mm2, 2), state},
                  state == "done" ? "" : "open");
  }
  rows += table_row({"all", fixed(total.seen_mm2, 1), percent(total.coverage(), 2), fixed(total.red_mm2, 2),
                     fixed(total.excused_mm2, 2), fixed(total.interpolated_mm2, 2), ""},
                    "sum");
  return html_table(
      "faces", {"Face", "Seen, mm²", "Seen, %", "Red, mm²", "Excused, mm²", "Filled, mm²", "State"}, rows);
}

std::string micrometres_of(double mm) {
  return std::isfinite(mm) ? fixed(1000 * mm, 0) : kDash;
}

std::vector<std::string> sampling_cells(const std::string& name, const SamplingQuality& q) {
  const auto degrees = [](double rad) { return std::isfinite(rad) ? fixed(deg_from_rad(rad), 0) : kDash; };
  if (q.places == 0) {
    return {name, kDash, kDash, kDash, kDash, kDash, kDash, kDash, kDash, kDash};
  }
  double several = 0;
  for (std::size_t k = 2; k < q.scans_share.size(); ++k) {
    several += q.scans_share[k];
  }
  return {name,
          micrometres_of(q.spacing_mm.median),
          micrometres_of(q.spacing_mm.p95),
          percent(q.fine_share),
          micrometres_of(q.single_spacing_mm.median),
          percent(q.single_fine_share),
          degrees(q.incidence_rad.median),
          degrees(q.incidence_rad.p95),
          percent(several),
          percent(q.scans_share[0])};
}

std::string shares(const std::vector<std::pair<std::string, double>>& parts) {
  std::string text;
  for (const auto& [name, share] : parts) {
    if (share > 0) {
      text += (text.empty() ? "" : ", ") + name + " " + percent(share) + " %";
    }
  }
  return text;
}

std::string sampling_part(const Checklist& list) {
  if (list.sampling.places == 0) {
    return "<p>No surface was measured, so there is no spacing to tell.</p>\n";
  }
  std::string rows;
  for (int f = 0; f < kFaceCount; ++f) {
    rows += table_row(
        sampling_cells(to_string(static_cast<Face>(f)), list.faces[static_cast<std::size_t>(f)].sampling));
  }
  rows += table_row(sampling_cells("all", list.sampling), "sum");
  std::vector<std::pair<std::string, double>> angles;
  for (std::size_t k = 0; k < SamplingQuality::kAngleBins; ++k) {
    angles.emplace_back(std::to_string(10 * k) + "–" + std::to_string(10 * k + 10) + "°:",
                        list.sampling.incidence_share[k]);
  }
  std::vector<std::pair<std::string, double>> scans;
  for (std::size_t k = 0; k < SamplingQuality::kScanBins; ++k) {
    const bool last = k + 1 == SamplingQuality::kScanBins;
    scans.emplace_back(std::to_string(k) + (last ? " or more:" : ":"), list.sampling.scans_share[k]);
  }
  return "<h3>How well the surface was sampled</h3>\n" +
         html_table("sampling",
                    {"Face", "Spacing, µm", "95 % below", "≤ 25 µm, %", "Best scan, µm", "≤ 25 µm, %",
                     "Angle, °", "95 % below", "By two or more, %", "By none, %"},
                    rows) +
         "<p class=\"aside\">Spacing on the surface, slopes counted: of all scans together, and along the "
         "coarser direction of the best single scan. Angle: the best under which the surface was seen, by "
         "the worse placed of laser and camera. Medians unless said otherwise; shares are of the measured "
         "surface.</p>\n<dl>\n" +
         dl_entry("Best angle", shares(angles)) + dl_entry("Scans that sampled it well", shares(scans)) +
         "</dl>\n";
}

std::string calibration_words(const Checklist& list) {
  std::string html = list.calibration.empty() ? "what: not told" : html_escaped(list.calibration);
  html += list.calibration_age_days
              ? "; " + fixed(*list.calibration_age_days, 1) + " days old when the device was opened"
              : "; age: not told";
  if (list.calibration_check) {
    const CalibrationCheck& check = *list.calibration_check;
    html += "; last verified " + html_escaped(check.when) + " on " + html_escaped(check.artefact) +
            ", off by at most " + fixed(1000 * check.error_mm, 1) + " µm";
  } else {
    html += "; last verification: not told";
  }
  return html;
}

std::string store_words(const Checklist& list) {
  if (list.store_checked.empty()) {
    return list.store_whole ? "every stored byte matches its checksum" : "not verified";
  }
  return (list.store_whole ? "every byte of " : "DAMAGED: not every byte of ") +
         counted(list.store_files, "file", "files") + " matches its checksum (XXH64), read on " +
         html_escaped(list.store_checked);
}

}  // namespace

std::string checklist_section(const ReportInput& input) {
  const Checklist& list = input.checklist;
  std::string html = "<section>\n<h2>Checklist</h2>\n" + faces_table(list) +
                     "<p class=\"aside\">Red and excused areas are those of the holes, by estimate; seen: of "
                     "what there is, by that estimate. Filled: small gaps closed by interpolation, marked in "
                     "the mesh.</p>\n" +
                     sampling_part(list) + "<h3>What it rests on</h3>\n<dl>\n";
  html += dl_entry("Scans", std::to_string(list.scans_registered) + " registered, " +
                                std::to_string(list.scans_unsure) + " unsure, " +
                                std::to_string(list.scans_failed) + " failed");
  if (!list.scans_lost.empty()) {
    html += dl_entry("Lost", listed(list.scans_lost) + ", missing or not the bytes that were stored");
  }
  if (!list.scans_unplaced.empty()) {
    html += dl_entry("Not placed yet",
                     listed(list.scans_unplaced) + ", stored, and in neither model nor verdict");
  }
  if (list.worst_sigma_scan >= 0 && list.scans_registered > 1) {  // one alone lies where it lies
    html += dl_entry("Worst place", "scan " + std::to_string(list.worst_sigma_scan) + ", σ " +
                                        fixed(1000 * list.worst_sigma_mm, 1) + " µm");
  }
  for (const ScanWarning& warning : list.warnings) {
    html += dl_entry("Warning", "scan " + std::to_string(warning.scan) + ": " + html_escaped(warning.text));
  }
  for (const ScanWarning& remark : list.remarks) {
    html += dl_entry("Remark", "scan " + std::to_string(remark.scan) + ": " + html_escaped(remark.text));
  }
  html += dl_entry("Calibration", calibration_words(list));
  html += dl_entry("Store", store_words(list));
  html += dl_entry("Disk", fixed(list.disk_free_gib, 1) + " GiB free");
  return html + "</dl>\n</section>\n";
}

std::string sign_off_section(const ReportInput& input) {
  std::string html = "<section class=\"signed\">\n<h2>Sign-off</h2>\n";
  if (!input.checklist.sign_off) {
    return html +
           "<p>Not signed.</p>\n<p class=\"line\">Name and role</p>\n<p class=\"line\">Date and "
           "signature</p>\n</section>\n";
  }
  const CheckedSignOff& checked = *input.checklist.sign_off;
  const SignOff& s = checked.sign_off;
  html += "<dl>\n" + dl_entry("Signed by", html_escaped(s.name + (s.role.empty() ? "" : ", " + s.role))) +
          dl_entry("When", html_escaped(s.when)) +
          dl_entry("Verdict", s.conclusive ? "conclusive" : "not conclusive") +
          dl_entry("Signed incomplete", html_escaped(s.incomplete)) + dl_entry("Note", html_escaped(s.note)) +
          dl_entry("Program", html_escaped(s.program)) +
          dl_entry("SHA-256 of what was signed", "<code>" + html_escaped(s.digest) + "</code>") + "</dl>\n";
  if (checked.holds()) {
    html += "<p>It holds: scans, places, red map and verdict are those that were signed.</p>\n";
  } else {
    html += "<p class=\"void\">It is void: the session has changed since.</p>\n<ul>\n";
    for (const std::string& line : checked.changed) {
      html += "<li>" + html_escaped(line) + "</li>\n";
    }
    html += "</ul>\n";
  }
  return html + "</section>\n";
}

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <cctype>
#include <cmath>

#include "archive/html.h"
#include "archive/report_sections.h"
#include "core/scan_list.h"

namespace dubsar {

namespace {

std::string item(const std::string& html) {
  return "<li>" + html + "</li>\n";
}

std::string capitalised(std::string sentence) {
  if (!sentence.empty()) {
    sentence.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(sentence.front())));
  }
  return sentence;
}

std::string area(double mm2) {
  return fixed(mm2, mm2 < 10 ? 2 : 1) + " mm²";
}

/// What stands between this tablet and a conclusive scan, one sentence each.
std::string open_points(const ReportInput& input) {
  const Checklist& list = input.checklist;
  std::string items;
  const RegionSum red = sum_of(input.red_map, RegionState::kRed);
  if (red.count > 0) {
    items += item(counted(red.count, "place is", "places are") + " still red, " + area(red.area_mm2) +
                  " by estimate: the clay there is not sampled densely enough.");
  } else if (!input.red_map.conclusive) {
    items += item("The red map does not call the tablet complete, though it lists no red place.");
  }
  if (list.scans_unsure > 0) {
    items += item(counted(list.scans_unsure, "scan is", "scans are") +
                  " unsure: its place is not certain, so it was left out of the mesh until someone decides.");
  }
  for (const GroupApart& group : input.red_map.apart) {
    items += item(html_escaped(capitalised(group.say)) + ".");
  }
  if (list.scans_failed > 0) {
    items += item(counted(list.scans_failed, "scan", "scans") + " could not be placed at all.");
  }
  if (list.scans_registered == 0) {
    items += item("No scan is registered.");
  }
  if (!list.scans_lost.empty()) {
    items += item("The session has lost " + listed(list.scans_lost) +
                  ": what they saw is not in this verdict. A copy of the session may bring them back.");
  }
  if (!list.scans_unplaced.empty()) {
    items += item("No place was worked out yet for " + listed(list.scans_unplaced) +
                  ": what they saw is not in this verdict. dubsar register places them.");
  }
  if (!list.store_whole) {
    items += item(list.store_checked.empty()
                      ? "Not every stored byte was checked against its checksum."
                      : "Not every stored file is there and matches its checksum: dubsar verify names them.");
  }
  if (input.model.faces.empty()) {
    items += item("No surface was meshed.");
  }
  return items;
}

/// That the tablet need not be touched again; of clay that this scanner cannot show it is not made.
std::string promise(const RedMap& map) {
  const RegionSum hidden = sum_out_of_reach(map);
  return hidden.count == 0
             ? "Nobody has to touch the tablet again for its shape."
             : "Nobody has to touch the tablet again for the shape of that. <strong>" +
                   counted(hidden.count, "place is", "places are") + " out of its reach, " +
                   area(hidden.area_mm2) + " by estimate: there the shape is not recorded.</strong>";
}

}  // namespace

RegionSum sum_of(const RedMap& map, RegionState state) {
  return sum_of_regions(map, [&](const RedRegion& region) { return region.state == state; });
}

bool is_conclusive(const ReportInput& input) {
  return input.red_map.conclusive && input.checklist.conclusive;
}

std::string verdict_section(const ReportInput& input) {
  const RegionSum excused = sum_of(input.red_map, RegionState::kExcused);
  std::string excuses;
  if (excused.count > 0) {
    excuses =
        "<p>" + counted(excused.count, "place is", "places are") + " excused, " + area(excused.area_mm2) +
        " by estimate. Each is listed below with its reason; the clay there is not sampled densely.</p>\n";
  }
  if (const auto& checked = input.checklist.sign_off) {
    excuses += "<p>Signed by " + html_escaped(checked->sign_off.name) + " on " +
               html_escaped(checked->sign_off.when) +
               (checked->sign_off.incomplete.empty() ? "" : ", as incomplete") +
               (checked->holds() ? "." : "; <strong>void: the session has changed since</strong>.") +
               "</p>\n";
  }
  if (is_conclusive(input)) {
    return "<section class=\"verdict yes\">\n<h2>Conclusive</h2>\n<p>Every part of the tablet that this "
           "scanner can "
           "reach is sampled densely enough. " +
           promise(input.red_map) + "</p>\n" + excuses + "</section>\n";
  }
  return "<section class=\"verdict no\">\n<h2>Not conclusive</h2>\n<p>The tablet is not yet fully recorded. "
         "What is "
         "missing:</p>\n<ul>\n" +
         open_points(input) + "</ul>\n" + excuses + "</section>\n";
}

std::string next_section(const ReportInput& input) {
  if (input.red_map.next.empty() || is_conclusive(input)) {
    return {};
  }
  std::string html = "<section>\n<h2>What to scan next</h2>\n<ol>\n";
  for (const NextView& view : input.red_map.next) {
    html += item(html_escaped(view.say.empty() ? "(no words were given for this view)" : view.say) +
                 " <span class=\"aside\">expected to clear " + area(view.predicted_cleared_mm2) + "</span>");
  }
  return html + "</ol>\n</section>\n";
}

}  // namespace dubsar

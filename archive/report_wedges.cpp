// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "archive/html.h"
#include "archive/html_table.h"
#include "archive/report_sections.h"

namespace dubsar {

namespace {

constexpr std::string_view kSection = "<section>\n<h2>Wedges</h2>\n";
constexpr std::string_view kSectionEnd = "</section>\n";
constexpr int kLeastForQuantiles = 5;  // as the search does
constexpr std::size_t kTenth = 0;      // of WedgeProfile::quantiles
constexpr std::size_t kMedian = 4;
constexpr std::size_t kNineTenths = 8;

/// A row of the table: a feature in words, and with how many decimals it is told.
struct FeatureRow {
  std::string_view feature;
  std::string_view words;
  int decimals;
};
constexpr std::array<FeatureRow, 6> kRows = {{
    {"depth_mm", "Depth, mm", 2},
    {"directional_length_mm", "Directional edge, mm", 2},
    {"directional_slope_deg", "Its slope, °", 0},
    {"directional_opening_deg", "Opening at it, °", 0},
    {"second_opening_deg", "Opening at the second edge, °", 0},
    {"third_opening_deg", "Opening at the third edge, °", 0},
}};

std::size_t feature_of(const FeatureRow& row) {
  return static_cast<std::size_t>(std::ranges::find(kWedgeFeatures, row.feature) - kWedgeFeatures.begin());
}

std::string spread(const WedgeProfile& profile, const FeatureRow& row) {
  const std::size_t at = feature_of(row);
  const auto& quantiles = profile.quantiles[at];
  if (profile.known[at] < kLeastForQuantiles) {
    return "–";
  }
  return fixed(quantiles[kMedian], row.decimals) + " (" + fixed(quantiles[kTenth], row.decimals) + " to " +
         fixed(quantiles[kNineTenths], row.decimals) + ")";
}

/// A cell for each profile, behind what the row is of.
template <class Cell>
std::string row_of(const std::vector<WedgeProfile>& profiles, const std::string& words, const Cell& cell) {
  std::vector<std::string> cells = {words};
  for (const WedgeProfile& profile : profiles) {
    cells.push_back(cell(profile));
  }
  return table_row(cells);
}

std::string profile_table(const std::vector<WedgeProfile>& profiles) {
  std::vector<std::string> names = {"Of"};
  int beyond_mesh = 0;
  for (const WedgeProfile& profile : profiles) {
    names.emplace_back(profile.side ? to_string(*profile.side) : "tablet");
    beyond_mesh += profile.side ? 0 : profile.beyond_mesh;
  }
  std::string rows =
      row_of(profiles, "Wedges", [](const WedgeProfile& profile) { return std::to_string(profile.count); });
  bool are_lengths = true;
  for (const FeatureRow& row : kRows) {
    if (are_lengths && feature_of(row) >= kWedgeLengths) {
      are_lengths = false;
      rows += row_of(profiles, "Wedges that angles are read at", [&](const WedgeProfile& profile) {
        return std::to_string(profile.known[feature_of(row)]);
      });
    }
    rows += row_of(profiles, std::string(row.words),
                   [&](const WedgeProfile& profile) { return spread(profile, row); });
  }
  for (std::size_t kind = 0; kind < kWedgeKinds.size(); ++kind) {
    rows += row_of(profiles, std::string(kWedgeKinds[kind]) + ", %", [&](const WedgeProfile& profile) {
      return profile.count == 0 ? "–" : fixed(100.0 * profile.kinds[kind], 0);
    });
  }
  std::string aside =
      "Median, in brackets the tenth and the nine-tenths of the wedges: of fewer than five none are told. "
      "Slope and openings are read at wedges of which 0.8 or more is left (intact) and that are not worn "
      "(roundness at most 0.02). Every wedge by itself, with what it is uncertain by, stands in the file. "
      "Sides are named by the direction of the wedges here, elsewhere on this page by the tablet's shape and "
      "how it was laid down: where these differ, one side has two names.";
  if (beyond_mesh > 0) {
    aside += " The mesh ends before " +
             counted(beyond_mesh, "edge does: its length is", "edges do: their lengths are") + " in no row.";
  }
  return html_table("wedges", names, rows) + "<p class=\"aside\">" + html_escaped(aside) + "</p>\n";
}

}  // namespace

std::string wedges_section(const std::string& sentence, const std::vector<WedgeProfile>& profiles) {
  if (sentence.empty()) {
    return {};
  }
  const bool any =
      std::ranges::any_of(profiles, [](const WedgeProfile& profile) { return profile.count > 0; });
  return std::string(kSection) + "<p>" + html_escaped(sentence) + "</p>\n" +
         (any ? profile_table(profiles) : std::string()) + std::string(kSectionEnd);
}

std::string page_with_wedges(std::string page, const std::string& sentence,
                             const std::vector<WedgeProfile>& profiles) {
  const std::size_t from = page.find(kSection);
  const std::size_t to = from == std::string::npos ? from : page.find(kSectionEnd, from);
  if (to != std::string::npos) {
    page.replace(from, to + kSectionEnd.size() - from, wedges_section(sentence, profiles));
  }
  return page;
}

}  // namespace dubsar

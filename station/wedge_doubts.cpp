// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/wedge_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "analysis/text_frame.h"
#include "analysis/wedge_features.h"
#include "core/order_statistics.h"

namespace dubsar {

namespace {

/// Wedges of simulated tablets are 0.3 to 0.5 mm deep; docs/scholars/measurements.md has how many of them are
/// found at which spacing.
constexpr double kCoarseMm = 0.14;
constexpr double kSpacingsToADepth = 3.5;
constexpr std::size_t kFewestLarge = 10;

bool has_several_bodies(const WedgeFile& file, std::size_t bodies) {
  return bodies > 1 ||
         std::ranges::any_of(file.wedges, [](const Wedge& wedge) { return wedge.place.body > 0; });
}

/// What there is to say where wedges were found and no text runs through them.
std::optional<std::string> no_text(std::size_t wedges, double text_certainty) {
  if (wedges == 0 || text_certainty >= kCertainText) {
    return std::nullopt;
  }
  const std::string of_them =
      wedges == 1 ? std::string("no direction of writing shows in the one wedge that was found")
                  : fmt::format("no direction of writing shows in the {} wedges that were found", wedges);
  return of_them +
         ": confidence was learnt on inscribed tablets, and hollows of rough clay may pass for wedges: look "
         "at them before you count them";
}

}  // namespace

std::vector<Error> doubts_of(const WedgeFile& file, const std::string& where, std::size_t bodies) {
  std::vector<Error> doubts;
  if (has_several_bodies(file, bodies)) {
    doubts.push_back({ErrorKind::kBadInput,
                      "several bodies in one mesh: each is measured as if it were alone, and place.body "
                      "tells them apart; which side is which is told of all together",
                      where, "give each a file of its own where they do not lie alike"});
  }
  // Without a frame nobody has looked for a direction, as in what is known of a simulated tablet.
  if (const auto unwritten = file.text_from_model ? no_text(file.wedges.size(), file.text_certainty)
                                                  : std::optional<std::string>()) {
    doubts.push_back({ErrorKind::kBadInput, *unwritten, where, {}});
  }
  for (std::optional<Error> doubt : {too_coarse(file, where), worn(file.wedges, where)}) {
    if (doubt) {
      doubts.push_back(*std::move(doubt));
    }
  }
  return doubts;
}

std::optional<Error> too_coarse(const WedgeFile& file, const std::string& where) {
  std::vector<double> depths;
  for (const Wedge& wedge : file.wedges) {
    depths.push_back(wedge.depth_mm);
  }
  const bool large =
      depths.size() >= kFewestLarge && median_of(std::move(depths)) > kSpacingsToADepth * file.spacing_mm;
  if (file.spacing_mm <= kCoarseMm || large) {
    return std::nullopt;
  }
  return Error{ErrorKind::kBadInput,
               fmt::format("too coarse for wedges of the usual size, many or all of them are missed: "
                           "the mesh's spacing is {:.2f} mm",
                           file.spacing_mm),
               where, "scan it, or export it, at 0.1 mm or finer"};
}

std::optional<Error> worn(const std::vector<Wedge>& wedges, const std::string& where) {
  const auto round = static_cast<std::size_t>(
      std::ranges::count_if(wedges, [](const Wedge& wedge) { return wedge.roundness > kMostRoundness; }));
  if (2 * round <= wedges.size()) {
    return std::nullopt;
  }
  return Error{ErrorKind::kBadInput,
               fmt::format("most of the wedges are worn (their edges are rounded: {}): depths and angles "
                           "are those of the clay as it is, not of what was pressed",
                           round),
               where, "leave them out to compare hands"};
}

}  // namespace dubsar

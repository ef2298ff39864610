// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/earlier_wedges.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/log.h"
#include "core/number_text.h"
#include "formats/wedges_json.h"
#include "station/same_tablet.h"
#include "station/wedges_beside.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// Nothing where none lies there; with a warning where it cannot be read.
std::optional<WedgeFile> file_before(const fs::path& wedges_json) {
  std::error_code error;
  if (!fs::is_regular_file(wedges_json, error)) {
    return std::nullopt;
  }
  Result<WedgeFile> file = read_wedges(wedges_json);
  if (!file) {
    log_warning("the ids of its wedges are not carried over: " + file.error().line());
    return std::nullopt;
  }
  return *std::move(file);
}

}  // namespace

std::vector<KnownWedge> known_wedges(const std::vector<Wedge>& wedges,
                                     const std::vector<KnownWedge>& former) {
  std::vector<KnownWedge> known;
  for (const Wedge& wedge : wedges) {
    known.push_back({wedge.id, wedge.depth_point_mm, wedge.by_hand});
  }
  add_known(former, &known);
  return known;
}

std::vector<KnownWedge> known_wedges_in(const fs::path& wedges_json) {
  const std::optional<WedgeFile> file = file_before(wedges_json);
  return file ? known_wedges(file->wedges, file->former) : std::vector<KnownWedge>();
}

EarlierWedges earlier_wedges(const fs::path& wedges_json, const fs::path& mesh) {
  const std::optional<WedgeFile> file = file_before(wedges_json);
  if (!file) {
    return {};
  }
  return {known_wedges(file->wedges, file->former),
          !are_of(*file, mesh) && !is_of_the_tablet_of(mesh, wedges_json)};
}

void add_known(std::vector<KnownWedge> more, std::vector<KnownWedge>* known) {
  std::set<int> ids;
  for (const KnownWedge& one : *known) {
    ids.insert(one.id);
  }
  std::ranges::copy_if(more, std::back_inserter(*known),
                       [&](const KnownWedge& one) { return !ids.contains(one.id); });
}

std::optional<std::string> few_found_again(const EarlierWedges& earlier, const WedgeSet& now) {
  const std::size_t most = std::min(earlier.wedges.size(), now.wedges.size());
  if (2 * now.found_again >= most) {
    return std::nullopt;
  }
  return fmt::format("of {} that {} known before, {} where {}: {}", counted(earlier.wedges.size(), "wedge"),
                     earlier.wedges.size() == 1 ? "was" : "were",
                     now.found_again == 1 ? "1 lies" : fmt::format("{} lie", now.found_again),
                     now.found_again == 1 ? "it lay" : "they lay",
                     now.forgot_earlier
                         ? "they are taken for another tablet's, and all ids are given anew"
                         : "the others have new ids; was the mesh moved, or is it another tablet's?");
}

}  // namespace dubsar

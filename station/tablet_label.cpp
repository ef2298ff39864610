// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/tablet_label.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "formats/file_label_reader.h"
#include "station/session_name.h"
#include "station/tablet_record.h"
#include "station/unfinished_scan.h"

namespace dubsar {

namespace {

constexpr const char* kMadeUp =
    "A program made up this tablet and its scans: there is no such tablet, and nothing was measured.";

std::vector<std::pair<std::string, std::string>> words_of_scans(const std::string& simulated) {
  std::vector<std::pair<std::string, std::string>> words;
  if (!simulated.empty()) {
    words.emplace_back("SIMULATED", simulated);
  }
  return words;
}

bool is_simulator(const std::string& device) {
  return device == "sim" || device.starts_with("sim-");
}

}  // namespace

bool is_made_up(const RangeGrid& grid) {
  return is_simulator(grid.device);
}

Result<std::string> simulated_words(const SessionStore& store) {
  const Result<std::vector<StoredScan>> scans = store.scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  const auto by_simulator = [&](const LeftScan& left) { return std::ranges::any_of(left.parts, is_made_up); };
  const bool simulated = std::ranges::any_of(*scans, is_simulator, &StoredScan::device) ||
                         std::ranges::any_of(left_scans(store.folder()), by_simulator);
  return simulated ? kMadeUp : "";
}

FileLabel made_up_label() {
  return label_of_words(words_of_scans(kMadeUp));
}

FileLabel label_of_files(const std::vector<std::filesystem::path>& grids, bool made_up) {
  std::vector<FileLabel> labels;
  std::ranges::transform(grids, std::back_inserter(labels), read_file_label);
  const auto others = std::ranges::adjacent_find(labels, std::ranges::not_equal_to(), &FileLabel::words);
  const bool simulated = made_up || std::ranges::any_of(labels, &FileLabel::simulated);
  if (!labels.empty() && others == labels.end() && labels.front().simulated == simulated) {
    return labels.front();
  }
  return simulated ? made_up_label() : FileLabel{};
}

Result<FileLabel> tablet_label(const SessionStore& store) {
  const Result<std::string> simulated = simulated_words(store);
  if (!simulated) {
    return std::unexpected(simulated.error());
  }
  TabletRecord record = tablet_record_of(store);
  record.notes.clear();
  std::vector<std::pair<std::string, std::string>> words = words_of_scans(*simulated);
  if (record.cdli.empty() && record.museum_number.empty()) {
    words.emplace_back("Session", session_name(store.folder()));
  }
  std::ranges::move(words_of(record), std::back_inserter(words));
  return label_of_words(std::move(words));
}

Result<FileLabel> label_of_scans(const SessionStore& store) {
  const Result<std::string> simulated = simulated_words(store);
  if (!simulated) {
    return std::unexpected(simulated.error());
  }
  return label_of_words(words_of_scans(*simulated));
}

}  // namespace dubsar

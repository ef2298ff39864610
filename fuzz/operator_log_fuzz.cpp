// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the operator has said of where scans lie, as a session from elsewhere may have it: a line for each
// event, its kind's letter and then its JSON.
#include "acquisition/operator_log.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "fuzz/fuzz_support.h"

using namespace dubsar;

namespace {

std::string kind_of(char letter) {
  switch (letter) {
    case 'h':
      return "pose hint";
    case 'w':
      return "pose hint withdrawn";
    case 'l':
      return "scan locked";
    case 'u':
      return "scan unlocked";
    default:
      return "scan dropped";
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream text{std::string(fuzz::text_of(data, size))};
  std::vector<SessionEvent> events;
  for (std::string line; events.size() < 100 && std::getline(text, line);) {
    if (!line.empty()) {
      SessionEvent& event = events.emplace_back();
      event.number = static_cast<std::int64_t>(events.size());
      event.kind = kind_of(line.front());
      event.json = line.substr(1);
    }
  }
  const OperatorLog log = operator_log_of(events);
  fuzz::require(log.damage.size() <= events.size());
  const auto is_pose = [](const RigidTransform& pose) {
    return std::ranges::all_of(pose.row_major(), [](double x) { return std::isfinite(x); });
  };
  for (const auto& [id, lock] : log.word.locked) {
    fuzz::require(id >= 0 && lock.frame > 0 && is_pose(lock.model_from_scanner));
    for (const auto& [on, pose] : lock.beside_from_scanner) {
      fuzz::require(on >= 0 && is_pose(pose));
    }
  }
  fuzz::require(log.word.hints.empty() || log.word.hints.begin()->first >= 0);
  return 0;
}

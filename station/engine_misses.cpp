// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Scans that come in vain while the engine drives by itself: of nothing, of a hand, of another tablet. They
// are asked for once more, then a person is.
#include "station/engine_impl.h"

namespace dubsar {

namespace {

/// Scans in a row that may come in vain.
constexpr int kMostInVain = 2;

std::string listed(const std::set<int>& ids) {
  std::string text = ids.size() == 1 ? "scan " : "scans ";
  std::size_t left = ids.size();
  for (const int id : ids) {
    text += std::to_string(id);
    --left;
    text += left > 1 ? ", " : left == 1 ? " and " : "";
  }
  return text;
}

}  // namespace

Taken Engine::Impl::refuse_empty() {
  const Error nothing{ErrorKind::kBadInput, "the scan has no sample at all: nothing stands before the scanner",
                      options.device,
                      "see that the tablet lies in the measuring field, then give the same command again"};
  ++empty_scans;
  if (drives && empty_scans < kMostInVain) {
    emit(Notice{fmt::format("{}: {}; the same view is scanned once more", nothing.where, nothing.what)});
    return Taken::kNothing;
  }
  end_motion(nothing);
  return source->capabilities().finite ? Taken::kNothing : Taken::kEnd;
}

Engine::Impl::Miss Engine::Impl::judge_miss(int id, const std::vector<ScanPose>& poses) {
  std::set<int> now;
  std::string reason;
  for (const ScanPose& pose : poses) {
    if (pose.status == PoseStatus::kRegistered) {
      now.insert(pose.id);
    } else if (pose.id == id) {
      reason = pose.reason;
    }
  }
  const bool none_left =
      !taken_up.empty() && std::ranges::none_of(taken_up, [&](int one) { return now.contains(one); });
  const std::set<int> before = std::exchange(taken_up, now);
  if (now.contains(id) && none_left) {
    end_motion({ErrorKind::kBadInput,
                listed(now) + " fit each other and not " + listed(before) +
                    ": something was in the way before, or another tablet lies there now",
                options.session.string(),
                "take the wrong ones out (session drop), then give the same command again"});
    return Miss::kEnd;
  }
  if (now.contains(id)) {
    misses = 0;
    return Miss::kNone;
  }
  if (++misses < kMostInVain) {
    emit(Notice{fmt::format("scan {} is not taken up: {}; the same view is scanned once more", id, reason)});
    return Miss::kAgain;
  }
  end_motion({ErrorKind::kBadInput,
              fmt::format("two scans of this view in a row are not taken up, scan {} because {}", id, reason),
              options.session.string(),
              "see that it is the right tablet, that no hand is in view and that nothing moved, then give the "
              "same command again"});
  return Miss::kEnd;
}

}  // namespace dubsar

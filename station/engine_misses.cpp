// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Scans that come in vain while the engine drives by itself: of nothing, of a hand, of another tablet. They
// are asked for once more, then a person is.
#include <algorithm>
#include <iterator>

#include "core/scan_list.h"
#include "station/engine_impl.h"
#include "station/session_pages.h"

namespace dubsar {

namespace {

/// Scans in a row that may come in vain, and one more where the tablet was laid otherwise for them.
constexpr std::size_t kMostInVain = 3;
constexpr int kMostEmpty = 2;

}  // namespace

Taken Engine::Impl::refuse_empty() {
  const Error nothing{ErrorKind::kBadInput,
                      "the scan has no sample at all: nothing stands before the scanner", options.device,
                      "see that the tablet lies in the measuring field, then give the same command again"};
  ++empty_scans;
  if (drives && empty_scans < kMostEmpty) {
    emit(Notice{fmt::format("{}: {}; the same view is scanned once more", nothing.where, nothing.what)});
    return Taken::kNothing;
  }
  end_motion(nothing);
  return source->capabilities().finite ? Taken::kNothing : Taken::kEnd;
}

ScanPose Engine::Impl::set_intruders_aside(const StationScan& scan, ScanPose pose,
                                           std::vector<SetAside>& aside, JobContext& job) {
  intruders.add(scan);
  while (!job.cancelled()) {
    const std::optional<Intruder> found = intruders.look(scan.id, registrar.poses());
    if (!found || word.locked.contains(found->id)) {
      break;
    }
    intruders.remove(found->id);
    const std::string why = fmt::format(
        "something was in the way of scan {}: {:.0f} % of it, where scan {} looked too, stands in the air",
        found->id, 100 * found->share, found->witness);
    if (const Status taken =
            take_pages_back_once(*store, fmt::format("scan {} was taken out", found->id), kFollowAndPlan);
        !taken) {
      emit(Notice{taken.error().line()});
    }
    if (const Status dropped = store->drop_scan(found->id, why); !dropped) {
      give_up(dropped.error());
      break;
    }
    registrar.remove(found->id, job);
    aside.push_back({found->id, why});
    emit(Notice{why + "; it is set aside (session restore puts it back)"});
    if (found->id == scan.id) {
      pose = ScanPose{};
      pose.id = scan.id;
      pose.reason = why;
      break;
    }
    const std::vector<ScanPose> without = registrar.poses();  // which may tell of this one otherwise now
    pose = judged(*std::ranges::find(without, scan.id, &ScanPose::id));
    if (pose.status != PoseStatus::kRegistered) {
      pose = register_scan(scan, job);
    }
  }
  return pose;
}

void Engine::Impl::tell_foreign() {
  for (const ForeignFound& found : planning.foreign()) {
    if (told_foreign.insert(found.id).second) {
      emit(Notice{sentence_of(found)});
    }
  }
}

bool Engine::Impl::another_tablet(int id, const std::set<int>& before, const std::set<int>& now) {
  const auto lies = lies_as.find(id);
  return !before.empty() && lies != lies_as.end() && now.contains(id) &&
         std::ranges::none_of(before, [&](int one) { return now.contains(one); }) &&
         std::ranges::any_of(before, [&](int one) {
           const auto other = lies_as.find(one);
           return other != lies_as.end() && other->second == lies->second;
         });
}

NextStep Engine::Impl::once_more() {
  again = true;
  return Step{.view = {}, .scene = {}, .again = true};
}

StageScene Engine::Impl::unseen_and(const NextView& view) const {
  StageScene wide = unseen();
  if (const auto on_stage = planning.scene_for(*rig, *view.placement)) {
    wide.tablet_mm.extend(on_stage->tablet_mm);
    wide.focus_mm = on_stage->focus_mm;
  }
  return wide;
}

NextStep Engine::Impl::step_after(int id, const std::vector<ScanPose>& poses, const RedMap& red_map,
                                  JobContext& job) {
  std::set<int> now;
  std::string reason = "something was in the way";
  for (const ScanPose& pose : poses) {
    if (pose.status == PoseStatus::kRegistered) {
      now.insert(pose.id);
    } else if (pose.id == id) {
      reason = pose.reason;
    }
  }
  std::set<int> before = std::exchange(taken_up, now);
  std::erase_if(before, [&](int one) {  // what was set aside has given way to nobody
    return std::ranges::find(poses, one, &ScanPose::id) == poses.end();
  });
  if (another_tablet(id, before, now)) {
    end_motion({ErrorKind::kBadInput,
                listed(now) + " fit each other and not " + listed(before) +
                    ": something was in the way before, or another tablet lies there now",
                options.session.string(),
                "take the wrong ones out (session drop), then give the same command again"});
    return std::nullopt;
  }
  const bool is_again = std::exchange(again, false);
  const bool doubtful = !is_again && planning.shows_much_more(id);
  if (now.contains(id)) {
    in_vain.clear();
    laid_otherwise = false;
    if (doubtful) {
      emit(Notice{fmt::format(
          "scan {} shows much more than what is known; the same view is scanned once more, to see whether "
          "something was in the way",
          id)});
      return once_more();
    }
    return step_to(red_map);
  }
  in_vain.push_back(id);
  const auto lies_as_it = [&](int one) {
    const auto mine = lies_as.find(id);
    const auto other = lies_as.find(one);
    return mine != lies_as.end() && other != lies_as.end() && mine->second == other->second;
  };
  std::set<int> lie_as_it;
  std::ranges::copy_if(now, std::inserter(lie_as_it, lie_as_it.end()), [&](int one) {
    return lies_as_it(one) && !copied_from(planning.copies(), one);  // a copy is no second word
  });
  const bool just_lifted = lie_as_it.empty();
  const auto here = std::ranges::count_if(in_vain, lies_as_it);
  // One word against another: the first of the two may be the one with a hand in it.
  if (const auto first = lie_as_it.size() == 1 ? planning.drive_of(*lie_as_it.begin()) : std::nullopt;
      first && rig && in_vain.size() == 1) {
    emit(
        Notice{fmt::format("scan {} is not taken up: {}; the view of scan {} is scanned once more, to see "
                           "which of them is right",
                           id, reason, *lie_as_it.begin())});
    NextView view;
    view.say = say_placement(*rig, *first);
    view.placement = first;
    return Step{.view = std::move(view), .scene = unseen(), .again = false};
  }
  // Just lifted, it mostly shows too little that is known; else something was in the way and is gone again.
  const bool shows_too_little = just_lifted && !doubtful && !is_again;
  const bool look_elsewhere = here == (shows_too_little ? 1 : 2);
  // Nor does any other view of it as it lies: it has to lie otherwise.
  if (shows_too_little && here == 2 && rig && !laid_otherwise) {
    if (const std::optional<NextView> other = planning.laid_otherwise(*rig, in_vain, job)) {
      laid_otherwise = true;
      emit(Notice{
          fmt::format("scan {} is not taken up: {}; laid otherwise, the tablet shows more of what is known",
                      id, reason)});
      return Step{.view = *other, .scene = unseen_and(*other), .again = false};
    }
  }
  const std::optional<NextView> other = look_elsewhere && rig ? planning.after_miss(*rig, id) : std::nullopt;
  if (other) {
    emit(Notice{
        fmt::format("scan {} is not taken up: {}; the next view shows more of what is known", id, reason)});
    return Step{.view = *other, .scene = unseen_and(*other), .again = false};
  }
  if (in_vain.size() < kMostInVain + (laid_otherwise ? 1 : 0)) {
    emit(Notice{fmt::format("scan {} is not taken up: {}; the same view is scanned once more", id, reason)});
    return once_more();
  }
  end_motion(
      {ErrorKind::kBadInput,
       fmt::format("{} scans in a row are not taken up, scan {} because {}", in_vain.size(), id, reason),
       options.session.string(),
       "see that it is the right tablet, that no hand is in view and that nothing moved, then give the "
       "same command again"});
  return std::nullopt;
}

}  // namespace dubsar

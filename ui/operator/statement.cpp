// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/statement.h"

#include <algorithm>

#include "archive/seen_line.h"
#include "station/session_faults.h"
#include "ui/operator/before_signing.h"
#include "ui/operator/map_areas.h"
#include "ui/operator/next_steps.h"
#include "ui/operator/sentences.h"
#include "ui/shell/widgets.h"

namespace dubsar::ui {

namespace {

/// What is wrong with scans that are in the model: before the signature, not after it. True where something
/// is.
bool add_warnings(Statement& out, const LiveState& state, Language language) {
  int warned = 0;
  for (const LiveScan& scan : state.scans) {
    if (const std::string warning = scan_warning(scan, language); !warning.empty() && warned++ == 0) {
      add_sentence(out.detail, warning);
    }
  }
  if (warned > 1) {
    add_sentence(out.detail, filled(text_of(Text::kMoreWarned, language), warned - 1));
  }
  return warned > 0;
}

/// "Scans not judged yet: 7. Finish judges them"; empty where all are.
std::string unjudged_line(const LiveState& state, Language language) {
  const int count = unjudged_scans(state);
  return count == 0   ? std::string()
         : count == 1 ? text_of(Text::kUnjudgedScan, language)
                      : filled(text_of(Text::kUnjudgedScans, language), count);
}

/// What is to be read before a name goes under a verdict that is conclusive: the worst has the headline.
void say_conclusive(Statement& out, const LiveState& state, Language language) {
  const bool warned = add_warnings(out, state, language);
  const double excused = excused_mm2(*state.red_map);
  const bool damaged = is_damaged(state);
  out.headline = damaged  ? text_of(Text::kConclusiveDamaged, language)
                 : warned ? text_of(Text::kConclusiveBut, language)
                 : excused > 0
                     ? filled(text_of(Text::kConclusiveExcused, language), area_words(excused, language))
                     : text_of(Text::kConclusive, language);
  out.tone = damaged ? Tone::kWarn : warned || is_much_excused(state) ? Tone::kAsk : Tone::kGood;
  if (const std::string sides = excused_sides(*state.red_map, language); !sides.empty()) {
    add_sentence(out.detail, sides);
  }
  out.may_sign = true;
}

/// A scan that was taken out is damaged: it takes no part, and yet what is signed is not whole.
void add_damaged_taken_out(Statement& out, const LiveState& state, Language language) {
  const std::string scans = damaged_scans_taken_out(state);
  if (!scans.empty()) {
    add_sentence(out.detail, filled(text_of(Text::kDamagedTakenOut, language), scans));
  }
  if (is_damaged(state)) {
    add_sentence(out.detail, text_of(Text::kDamagedOrReason, language));
  }
}

/// What of the session is damaged, lost or void: on every opening, and before anything is signed. What ended
/// a run, and a scanner that is still to be chosen, keep the headline: it is not free then.
void say_faults(Statement& out, const LiveState& state, bool is_free, bool conclusive, Language language) {
  const std::string damaged = damaged_scans(state);
  const std::string may_be_out = scans_of_lost_records(state);
  std::string said;
  if (!state.void_signed_by.empty()) {
    said = damaged.empty() ? filled(text_of(Text::kVoidSignatureSince, language),
                                    state.void_signed_by.c_str(), translated(state.void_since, language))
                           : filled(text_of(Text::kVoidSignature, language), state.void_signed_by.c_str());
  }
  if (!state.lost_records.empty()) {
    add_sentence(said, filled(text_of(Text::kLostRecords, language),
                              translated(one_line(state.lost_records), language)));
  }
  if (!may_be_out.empty()) {
    add_sentence(said, filled(text_of(Text::kMayBeTakenOut, language), may_be_out));
  }
  if (!damaged.empty()) {
    const bool is_one = damaged.find(',') == std::string::npos;
    const std::string line =
        filled(text_of(is_one ? Text::kDamagedScan : Text::kDamagedScans, language), damaged);
    // What is red by the lack of them is not to be scanned first.
    add_sentence(said, text_of(Text::kDamagedHow, language));
    out.detail = is_free ? said : fmt::format("{} {}. {}", out.detail, line, said);
    out.headline = is_free ? line : out.headline;
    out.tone = Tone::kBad;
    return;
  }
  if (said.empty()) {
    return;
  }
  if (!state.lost_records.empty() || !may_be_out.empty()) {
    out.tone = out.tone == Tone::kBad ? out.tone : Tone::kWarn;
    if (is_free && !state.signed_off) {
      if (!conclusive) {  // what it said is still what is next
        add_sentence(said, out.headline + ".");
      }
      out.headline = text_of(conclusive ? Text::kConclusiveLost : Text::kRecordsLost, language);
    }
  }
  add_sentence(said, out.detail);
  out.detail = said;
}

/// A run was stopped, or the window closed: what is shown is not in the session, and no name goes under it
/// yet.
bool lacks_verdict(const LiveState& state) {
  return newest_standing(state) != nullptr && state.red_map && !state.verdict_kept && !state.signed_off;
}

/// What the red map would do next is for motors, and no run asks for it yet.
bool is_driven(const LiveState& state) {
  return state.is_driven && state.red_map && !state.red_map->next.empty() &&
         state.red_map->next.front().placement;
}

/// The group that the scan is of, which fits nothing of the model; null where it is of none.
const GroupApart* group_of(const LiveState& state, int scan) {
  if (!state.red_map) {
    return nullptr;
  }
  const auto found = std::ranges::find_if(state.red_map->apart, [scan](const GroupApart& group) {
    return std::ranges::find(group.ids, scan) != group.ids.end();
  });
  return found != state.red_map->apart.end() ? &*found : nullptr;
}

/// By the run that goes on: the operator did not take it out.
bool newest_is_set_aside(const LiveState& state) {
  return state.phase != LivePhase::kStill && !state.scans.empty() && state.scans.back().set_aside;
}

/// The last scan is not taken up: it was set aside, or it lies nowhere for certain. False where it does.
bool say_not_taken_up(Statement& out, const LiveState& state, Language language) {
  const LiveScan* last = newest_standing(state);
  const GroupApart* group = nullptr;
  if (!state.scans.empty() && state.scans.back().set_aside) {
    const LiveScan& aside = state.scans.back();
    out.headline = filled(text_of(Text::kSetAsideScan, language), aside.id);
    out.detail = fmt::format("{} {}", sentence(aside.note, language), text_of(Text::kSetAsideHow, language));
  } else if (last != nullptr && last->pose && last->pose->status != PoseStatus::kRegistered) {
    const bool failed = last->pose->status == PoseStatus::kFailed;
    out.headline = filled(text_of(failed ? Text::kFailedScan : Text::kUnsureScan, language), last->id);
    group = group_of(state, last->id);
    out.detail = sentence(group != nullptr ? group->say : last->pose->reason, language);
    out.may_point = true;
  } else {
    return false;
  }
  // How to turn it for more of what is red is not how to join the group, but motors go there.
  if (state.next && (group == nullptr || state.next->placement)) {
    add_sentence(out.detail, what_is_next(*state.next, language));
  }
  return true;
}

/// The red map is not one of before this scan was taken up.
bool is_mapped(const LiveState& state, const LiveScan& scan) {
  return scan.pose->status != PoseStatus::kRegistered || copy_of(state, scan) ||
         (state.red_map &&
          std::ranges::find(state.red_map->scans, scan.id, &RedScan::id) != state.red_map->scans.end());
}

void say_waiting(Statement& out, const LiveState& state, Wording wording) {
  const Language language = wording.language;
  out.tone = Tone::kAsk;
  out.may_scan = out.may_finish = true;
  if (state.last_not_taken_up && say_not_taken_up(out, state, language)) {
    return;
  }
  const LiveScan* last = newest_standing(state);
  if (state.next) {
    if (state.next->placement && !is_turned_by_hand(*state.next)) {
      out.headline = text_of(Text::kScanAsItLies, language);
      out.detail = what_is_next(*state.next, language);
    } else {
      const NextSteps steps = steps_of(*state.next);
      out.headline = capitalised(translated(steps.hand, language));
      out.detail = text_of(Text::kTurnThenScan, language);
      if (const std::string drive = goes_itself(steps.motors, language); !drive.empty()) {
        add_sentence(out.detail, drive);
      }
    }
  } else if (last == nullptr) {
    out.headline = text_of(Text::kLayTablet, language);
  } else if (!last->pose ||
             !is_mapped(state,
                        *last)) {  // nothing drives this scanner: it waits while its scan is still judged
    out.headline = text_of(Text::kJudging, language);
    out.detail = text_of(Text::kJudgedWhileWaiting, language);
  } else if (is_driven(state)) {  // the step would have come with the waiting: there is none to turn for
    out.headline = text_of(Text::kScanAsItLies, language);
  } else if (state.red_map && !state.red_map->next.empty()) {
    const std::string turn = by_hand(state, language);
    out.headline = turn.empty() ? text_of(Text::kScanAsItLies, language) : turn;
    out.detail = text_of(Text::kThenScan, wording);
  } else {
    out.headline = text_of(Text::kScanTheRed, wording);
  }
}

void say_still(Statement& out, const LiveState& state, bool has_device, Wording wording) {
  const Language language = wording.language;
  const bool any = newest_standing(state) != nullptr;
  const std::string broken_off = state.broken_off_rows > 0
                                     ? filled(text_of(Text::kBrokenOff, language), state.broken_off_rows)
                                     : std::string();
  const std::string choose = text_of(Text::kChooseDevice, language);
  out.may_scan = has_device;  // without one, what was scanned elsewhere is judged, signed and packed
  const std::string unjudged = any ? unjudged_line(state, language) : std::string();
  const bool conclusive =
      any && state.red_map && state.red_map->conclusive && state.verdict_kept && unjudged.empty();
  out.may_pack = any && state.signed_off;
  if (any && state.signed_off) {  // another scan would undo the signature, or be of the next tablet
    out.may_scan = false;
    out.may_next = true;
    out.scan_label = Text::kNextTablet;
  }
  if (state.error) {
    out.tone = Tone::kBad;
    out.headline = text_of(Text::kStopped, language);
    out.detail = translated(*state.error, language);
    out.scan_label = out.may_next ? Text::kNextTablet : Text::kGoOn;
    out.may_sign = conclusive && !state.signed_off;
    out.may_finish = lacks_verdict(state) || !unjudged.empty();
    if (!unjudged.empty()) {
      add_sentence(out.detail, unjudged + ".");
    }
  } else if (!any && !has_device) {
    out.headline = choose;
    out.tone = Tone::kAsk;
  } else if (!any) {
    out.headline = text_of(Text::kLayTablet, language);
    out.tone = Tone::kAsk;
    out.detail = broken_off;
    if (state.care && state.care->is_due()) {
      const bool failed = state.care->last && !state.care->last->passed;
      out.tone = failed ? Tone::kBad : out.tone;
      out.headline = text_of(Text::kMeasureFirst, language);
      add_sentence(out.detail, text_of(failed ? Text::kVerifyHasFailed : Text::kVerifyFirst, language));
    }
  } else if (state.signed_off) {
    const bool packed = !state.package.empty();
    out.headline =
        filled(text_of(packed ? Text::kSignedNext : Text::kSignedPack, language), seen_line(state.signed_by));
    out.detail = packed ? filled(text_of(Text::kPackageKept, language), seen_line(state.package.string()))
                 : conclusive ? text_of(Text::kIntoItsBox, language)
                              : std::string();
    if (!conclusive) {
      add_sentence(out.detail, text_of(Text::kSignedIncomplete, language));
    }
    out.tone = conclusive ? Tone::kGood : Tone::kAsk;
  } else if (!unjudged.empty()) {  // what is red by the lack of them is not to be scanned first
    out.headline = unjudged;
    out.detail = text_of(Text::kUnjudgedHow, wording);
    if (!broken_off.empty()) {
      add_sentence(out.detail, broken_off);
    }
    out.tone = Tone::kAsk;
    out.scan_label = Text::kGoOn;
    out.may_finish = true;
    add_damaged_taken_out(out, state, language);
  } else if (conclusive) {
    say_conclusive(out, state, language);
    add_damaged_taken_out(out, state, language);
  } else {
    // A map that knows of no red yet is one of scans that are not judged.
    const double red = state.red_map && !state.red_map->conclusive ? red_mm2(*state.red_map) : 0.0;
    const std::string still = red > 0 ? filled(text_of(Text::kStillRed, wording), area_words(red, language))
                                      : filled(text_of(Text::kStoredScans, language), state.scans.size());
    out.headline = has_device ? still : choose;
    out.detail = has_device ? std::string() : still + ".";
    out.tone = Tone::kAsk;
    out.scan_label = Text::kGoOn;
    // As incomplete, with the reason.
    out.may_sign = state.red_map != nullptr && state.verdict_kept;
    out.may_finish = lacks_verdict(state);
    if (!broken_off.empty()) {
      add_sentence(out.detail, broken_off);
    }
    if (state.red_map && !state.red_map->apart.empty()) {  // before more of either side is scanned
      add_sentence(out.detail, sentence(state.red_map->apart.front().say, language));
    }
    if (is_driven(state)) {  // whatever is next, the run begins with a scan of how the tablet lies
      add_sentence(out.detail, text_of(Text::kFirstAsItLies, language));
    } else if (const std::string turn = by_hand(state, language); !turn.empty()) {
      add_sentence(out.detail, turn + ".");
    }
    add_warnings(out, state, language);
    add_damaged_taken_out(out, state, language);
  }
  say_faults(out, state, !state.error && out.headline != choose, conclusive, language);
}

}  // namespace

Statement statement_of(const LiveState& state, bool has_device, Wording wording) {
  const Language language = wording.language;
  Statement out;
  // Nor while a scan comes in, or when the newest is out by itself: the key would take the one before it.
  // What is signed goes by a click only.
  out.may_undo = newest_standing(state) != nullptr && !newest_is_set_aside(state) &&
                 state.phase != LivePhase::kReading && state.phase != LivePhase::kScanning &&
                 state.phase != LivePhase::kSigning && state.phase != LivePhase::kPacking && has_device &&
                 !(state.phase == LivePhase::kStill && state.signed_off);
  out.may_stop =
      state.phase != LivePhase::kStill && !(state.phase == LivePhase::kReading && state.reads_folder);
  const auto hands_off = [&](Text headline) {
    out.tone = Tone::kHandsOff;
    out.headline = text_of(headline, language);
  };
  if (state.silence) {  // whatever it was asked for
    out.tone = Tone::kBad;
    out.headline = capitalised(translated(state.silence->what, language));
    out.detail = sentence(state.silence->mend, language);
    out.may_undo = false;
    out.may_halt = !state.halted;
    return out;
  }
  if (state.halted && state.phase != LivePhase::kStill) {  // its pages are still made, perhaps
    out.tone = Tone::kBad;
    out.headline = text_of(Text::kHalted, language);
    out.detail = text_of(Text::kHandsOffYet, language);
    return out;
  }
  out.may_halt = state.phase == LivePhase::kOpening || state.phase == LivePhase::kMoving ||
                 state.phase == LivePhase::kScanning || state.phase == LivePhase::kMeasuring;
  switch (state.phase) {
    case LivePhase::kStill:
      say_still(out, state, has_device, wording);
      break;
    case LivePhase::kReading:
      out.headline = text_of(Text::kReading, language);
      break;
    case LivePhase::kOpening:
      hands_off(Text::kOpening);
      break;
    case LivePhase::kMoving:
      hands_off(Text::kMoving);
      if (const std::string motors = state.next ? steps_of(*state.next).motors : std::string();
          !motors.empty()) {
        out.detail = sentence(motors, language);
      }
      break;
    case LivePhase::kScanning:
      hands_off(Text::kScanning);
      out.detail = filled(text_of(Text::kProfiles, language), state.profiles);
      break;
    case LivePhase::kJudging:
      hands_off(Text::kJudging);
      out.detail = text_of(Text::kHandsOffYet, language);
      break;
    case LivePhase::kWaiting:
      say_waiting(out, state, wording);
      break;
    case LivePhase::kFinishing:
      out.tone = Tone::kPlain;
      out.headline = text_of(Text::kFinishing, language);
      if (state.error) {  // why it ends, while pages are made
        out.tone = Tone::kBad;
        out.detail = translated(*state.error, language);
      }
      break;
    case LivePhase::kSigning:
      out.headline = text_of(Text::kSigning, language);
      break;
    case LivePhase::kPacking:
      out.headline = text_of(Text::kPacking, language);
      break;
    case LivePhase::kMeasuring:
      hands_off(Text::kMeasuring);
      break;
  }
  return out;
}

}  // namespace dubsar::ui

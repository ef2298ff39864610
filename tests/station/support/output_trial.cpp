// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/station/support/output_trial.h"

#include <cmath>
#include <fstream>
#include <regex>
#include <stdexcept>

#include "core/range_grid.h"
#include "formats/atomic_file.h"
#include "formats/grid_file.h"
#include "formats/search_index.h"

namespace dubsar::test {

namespace fs = std::filesystem;

namespace {

/// A plate as a scanner looking down sees it: what the artefact is measured in.
RangeGrid plate() {
  constexpr int kSide = 60;
  constexpr float kStepMm = 0.2F;
  RangeGrid grid;
  grid.allocate(kSide, kSide);
  for (int row = 0; row < kSide; ++row) {
    for (int col = 0; col < kSide; ++col) {
      const std::size_t i = grid.index(row, col);
      grid.x[i] = kStepMm * static_cast<float>(col);
      grid.y[i] = kStepMm * static_cast<float>(row);
      grid.z[i] = 0.002F * static_cast<float>(std::sin(row + 2 * col));
      grid.valid[i] = 1;
    }
  }
  return grid;
}

constexpr const char* kPlate =
    "name = \"plate\"\ncertificate = \"none\"\nplane = true\n[limit]\nflatness_um = 60\n";

/// Two runs of a verb write the same but for these.
std::string less_times(const std::string& bytes) {
  static const std::regex kTimes(
      R"re("timings_s":\s*\{[^}]*\}|"(made_at|when|xxh128)":\s*"[^"]*"|"bytes":\s*\d+|\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d)?)re");
  const bool text = bytes.starts_with("{") || bytes.starts_with("<");
  return text ? std::regex_replace(bytes, kTimes, "") : bytes;
}

}  // namespace

std::vector<OutputVerb> output_verbs() {
  const std::string poses = "FOLDER/poses.json";
  return {
      {"search", {"search", "FOLDER/tablets", "--like", "FOLDER/tablets/a.json"}, true},
      {"calibrate", {"calibrate", "FOLDER/board", "-o", "FOLDER/new.json"}},
      {"calibrate over", {"calibrate", "FOLDER/board", "-o", "FOLDER/calibration.json"}},
      {"board", {"calibrate", "--board", "chessboard:9x6:5", "--print", "FOLDER/board.png"}},
      {"artefact",
       {"calibrate", "FOLDER/plate.grid", "--verify", "FOLDER/plate.toml", "--calibration",
        "FOLDER/calibration.json"},
       false,
       false},
      {"analyze",
       {"analyze", "FOLDER/tablet.ply", "-o", "FOLDER/fresh.json", "--mesh-out", "FOLDER/fresh.ply", "--svg",
        "FOLDER/drawings", "--invariants", "FOLDER/invariants.mat"}},
      {"analyze over", {"analyze", "FOLDER/tablet.ply", "-o", "FOLDER/wedges.json", "--exit", "extent"}},
      {"correct",
       {"wedges", "correct", "FOLDER/tablet.ply", "-o", "FOLDER/wedges.json", "--delete", "0"},
       false,
       true,
       {"analyze", "FOLDER/tablet.ply", "-o", "FOLDER/wedges.json"}},
      {"convert", {"mesh", "convert", "FOLDER/tablet.ply", "FOLDER/tablet.glb"}},
      {"section",
       {"mesh", "section", "FOLDER/tablet.ply", "--from", "-3,0,0", "--to", "3,0,0", "-o", "FOLDER/cut.svg"}},
      {"tablet", {"simulate", "tablet", "--size", "10x8x6", "--spacing", "0.4", "-o", "FOLDER/another"}},
      {"scans",
       {"simulate", "scans", "--tablet", "FOLDER/tablet.ply", "--views", "3", "--spacing", "0.5", "-o",
        "FOLDER/more"}},
      {"register folder", {"register", "FOLDER/scans", "-o", "FOLDER/found.json"}},
      {"stitch folder", {"stitch", "FOLDER/scans", "--poses", poses, "-o", "FOLDER/model.ply"}},
      {"plan folder",
       {"plan", "FOLDER/scans", "--poses", poses, "-o", "FOLDER/red.json", "--page", "FOLDER/page.html",
        "--states", "FOLDER/states"}},
  };
}

OutputTrials::OutputTrials(fs::path folder, std::uint64_t seed)
    : folder_(std::move(folder)), prepared_(folder_ / "prepared"), place_(folder_ / "place") {
  const std::string at = place_.string();
  fs::create_directories(place_ / "tablets");
  must({"simulate", "tablet", "--seed", std::to_string(seed), "--size", "14x11x8", "--spacing", "0.2", "-o",
        at});
  must({"analyze", at + "/tablet.ply", "-o", at + "/wedges.json"});
  for (const char* name : {"a.json", "b.json"}) {
    fs::copy(place_ / "truth.json", place_ / "tablets" / name);
  }
  must({"simulate", "scans", "--tablet", at + "/tablet.ply", "--views", "4", "--spacing", "0.5", "-o",
        at + "/scans"});
  fs::rename(place_ / "scans" / "truth_poses.json", place_ / "poses.json");
  must({"simulate", "rig", "--poses", "9", "--stops", "3", "--width", "768", "--height", "408", "-o",
        at + "/board"});
  must({"calibrate", at + "/board", "--temperature", "19", "-o", at + "/calibration.json"});
  if (!write_grid_file(place_ / "plate.grid", plate()) ||
      !write_file_atomically(place_ / "plate.toml", kPlate)) {
    throw std::runtime_error("the plate for the trials was not written");
  }
  fs::rename(place_, prepared_);
}

void OutputTrials::must(const Arguments& arguments) const {
  const Outcome made = run_command(arguments);
  if (made.status != 0) {
    throw std::runtime_error(arguments.front() + " did not make what the trials need, status " +
                             std::to_string(made.status) + ": " + made.err);
  }
}

void OutputTrials::lay_out() const {
  fs::remove_all(place_);
  fs::copy(prepared_, place_, fs::copy_options::recursive);
}

OutputTrials::Files OutputTrials::files() const {
  Files out;
  for (const auto& entry : fs::recursive_directory_iterator(place_)) {
    const std::string name = entry.path().lexically_relative(place_).string();
    const bool temporary = entry.path().filename().string().starts_with(kTemporaryPrefix);
    // The index remembers when its files were changed: whether it is whole is told by reading it.
    if (entry.is_regular_file() && !temporary) {
      const std::string bytes = bytes_of(entry.path());
      const bool index = entry.path().filename() == kSearchIndexName;
      out[name] = !index                                        ? less_times(bytes)
                  : parse_search_index(bytes, name).has_value() ? "whole"
                                                                : "damaged";
    }
  }
  return out;
}

TrialOutcome OutputTrials::undisturbed(const OutputVerb& verb) {
  lay_out();
  before_ = files();
  TrialOutcome out = run_with_fault(filled_in(verb.arguments, {{"FOLDER", place_.string()}}), place_,
                                    folder_ / "fault.log", {});
  after_ = files();
  status_ = out.command.status;
  if (status_ != 0 && status_ != 1) {
    out.faults.push_back("undisturbed, it ended with status " + std::to_string(status_) + ": " +
                         out.command.err);
  }
  if (before_ == after_) {
    out.faults.push_back("undisturbed, it left no file");
  }
  return out;
}

TrialOutcome OutputTrials::run(const OutputVerb& verb, const Fault& fault) {
  lay_out();
  TrialOutcome out = run_with_fault(filled_in(verb.arguments, {{"FOLDER", place_.string()}}), place_,
                                    folder_ / "fault.log", fault);
  look(verb, out);
  return out;
}

void OutputTrials::look(const OutputVerb& verb, TrialOutcome& out) const {
  const auto say = [&](const std::string& what) { out.faults.push_back(what); };
  const Files left = files();
  const auto is_as_in = [](const Files& files, const std::string& name, const std::string& bytes) {
    const auto it = files.find(name);
    return it != files.end() && it->second == bytes;
  };
  for (const auto& [name, bytes] : left) {
    if (!is_as_in(before_, name, bytes) && !is_as_in(after_, name, bytes)) {
      say(name + " is neither as it was nor as it should be");
    }
  }
  for (const auto& [name, bytes] : before_) {
    if (!left.contains(name) && after_.contains(name) && !name.ends_with(".done")) {
      say(name + " was there before and is gone");
    }
  }
  const bool done = !out.killed && out.command.status == status_ && !out.command.timed_out;
  if (done && !verb.may_do_without && left != after_) {
    say("it said that it was done, and its files are not all there");
  }
  if (!verb.repeats) {
    return;
  }
  const auto in_place = [&](const Arguments& words) {
    return filled_in(words, {{"FOLDER", place_.string()}});
  };
  Outcome again = run_command(in_place(verb.arguments));
  if (!verb.then.empty()) {
    again = run_command(in_place(verb.then));
  }
  const Files in_the_end = files();
  for (const auto& [name, bytes] : after_) {
    if (!is_as_in(in_the_end, name, bytes)) {
      say("started again, " + name + " is not as it should be");
    }
  }
  if (again.status != status_ || in_the_end.size() != after_.size()) {
    say("started again, it ended with status " + std::to_string(again.status) + " and " +
        std::to_string(in_the_end.size()) + " files: " + again.err);
  }
}

}  // namespace dubsar::test

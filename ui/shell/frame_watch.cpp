// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/frame_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace dubsar::ui {

namespace {

/// What nothing was said of: the panels themselves.
constexpr std::string_view kRest = "panels";

double seconds(FrameWatch::Clock::duration span) {
  return std::chrono::duration<double>(span).count();
}

}  // namespace

void FrameWatch::begin(Clock::time_point now, std::string doing) {
  began_ = now;
  doing_ = std::move(doing);
  spent_s_.clear();
  open_.clear();
  counted_ = true;
}

void FrameWatch::charge(Clock::time_point now) {
  if (!open_.empty()) {
    spent_s_[open_.back().work] += seconds(now - open_.back().since);
    open_.back().since = now;
  }
}

void FrameWatch::start(std::string_view work, Clock::time_point now) {
  charge(now);
  open_.push_back({std::string(work), now});
}

void FrameWatch::finish(Clock::time_point now) {
  if (open_.empty()) {
    return;
  }
  charge(now);
  open_.pop_back();
  if (!open_.empty()) {
    open_.back().since = now;
  }
}

std::string FrameWatch::parts(double rest_s) const {
  std::string out = fmt::format("{} {:.0f}", kRest, 1000 * rest_s);
  for (const auto& [work, s] : spent_s_) {
    if (s >= 0.001) {
      out += fmt::format(", {} {:.0f}", work, 1000 * s);
    }
  }
  return doing_.empty() ? out : out + "; " + doing_;
}

void FrameWatch::end(Clock::time_point now) {
  const double frame_s = seconds(now - began_);
  if (!counted_) {
    frame_before_s_ = 0;  // nobody could have pressed anything in it
    return;
  }
  double rest_s = frame_s;
  std::string_view most = kRest;
  double most_s = 0;
  for (const auto& [work, s] : spent_s_) {
    rest_s -= s;
    if (s > most_s) {
      most = work;
      most_s = s;
    }
  }
  if (rest_s >= most_s) {
    most = kRest;
  }
  Kind& kind = kinds_.try_emplace(std::string(most)).first->second;
  ++kind.frames;
  kind.slow += frame_s > kSlowS ? 1 : 0;
  if (frame_s > kind.longest_s) {
    kind.longest_s = frame_s;
    kind.longest_of = parts(rest_s);
  }
  kind.longest_wait_s = std::max(kind.longest_wait_s, frame_before_s_ + frame_s);
  frame_before_s_ = frame_s;
}

std::vector<std::string> FrameWatch::lines() const {
  std::vector<std::pair<std::string, Kind>> kinds(kinds_.begin(), kinds_.end());
  std::ranges::stable_sort(
      kinds, [](const auto& a, const auto& b) { return a.second.longest_s > b.second.longest_s; });
  std::vector<std::string> out;
  out.reserve(kinds.size());
  for (const auto& [work, kind] : kinds) {
    out.push_back(
        fmt::format("{}: input to picture at most {:.0f} ms; longest frame {:.0f} ms ({}); {} of {} "
                    "frames above {:.0f} ms",
                    work, 1000 * kind.longest_wait_s, 1000 * kind.longest_s, kind.longest_of, kind.slow,
                    kind.frames, 1000 * kSlowS));
  }
  return out;
}

}  // namespace dubsar::ui

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/text_lines.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/order_statistics.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr double kStepMm = 0.05;
constexpr double kMostLeanDeg = 5;
/// A gap between lines holds at most this share of what the fuller parts on both sides hold.
constexpr double kGap = 0.45;
/// What stands above a gap is a line when it holds this share of what the line below holds, or more than one
/// wedge: a heading of one sign is a line too, a stray hollow is none.
constexpr double kLineShare = 0.25;
constexpr double kMoreThanOne = 1.5;

/// How many members cover each height, with the ends of each drawn in: wedges of neighbouring lines touch.
struct Profile {
  double from = 0;
  std::vector<double> count;
};

Profile profile_at(const std::vector<LineMember>& members, double lean) {
  double low = 1e30;
  double high = -1e30;
  for (const LineMember& m : members) {
    low = std::min(low, m.low - lean * m.along);
    high = std::max(high, m.high - lean * m.along);
  }
  Profile profile;
  profile.from = low;
  profile.count.assign(static_cast<std::size_t>(std::clamp((high - low) / kStepMm, 0.0, 1e5)) + 2, 0.0);
  for (const LineMember& m : members) {
    const double drawn_in = 0.15 * (m.high - m.low);
    const auto first =
        static_cast<std::size_t>(std::max(0.0, (m.low + drawn_in - lean * m.along - low) / kStepMm));
    const auto last =
        static_cast<std::size_t>(std::max(0.0, (m.high - drawn_in - lean * m.along - low) / kStepMm));
    for (std::size_t i = first; i <= last && i < profile.count.size(); ++i) {
      profile.count[i] += 1.0;
    }
  }
  return profile;
}

/// How much the profile rises and falls: most where the lean is right.
double contrast(const Profile& profile) {
  double squares = 0;
  double sum = 0;
  for (const double c : profile.count) {
    squares += c * c;
    sum += c;
  }
  return sum > 0 ? squares / sum : 0.0;
}

std::vector<double> smoothed(const std::vector<double>& values, std::size_t reach) {
  std::vector<double> out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t first = i >= reach ? i - reach : 0;
    const std::size_t last = std::min(values.size() - 1, i + reach);
    double sum = 0;
    for (std::size_t k = first; k <= last; ++k) {
      sum += values[k];
    }
    out[i] = sum / static_cast<double>(last - first + 1);
  }
  return out;
}

/// Heights that part the lines, rising.
std::vector<double> gaps(const Profile& profile, double typical_height) {
  const auto reach = static_cast<std::size_t>(std::max(1.0, 0.12 * typical_height / kStepMm));
  const std::vector<double> count = smoothed(profile.count, reach);
  std::vector<double> cuts;
  // From one crest to the next: a valley deep enough against the lower of both is a gap.
  double crest = 0;
  double valley = 1e30;
  std::size_t valley_from = 0;
  std::size_t valley_to = 0;
  for (std::size_t i = 0; i < count.size(); ++i) {
    if (crest > 0 && count[i] < valley) {
      valley = count[i];
      valley_from = i;
    }
    if (crest > 0 && count[i] <= valley + 1e-9) {
      valley_to = i;
    }
    if (count[i] > crest && valley > kGap * crest) {
      crest = count[i];
      valley = 1e30;
    } else if (crest > 0 && valley <= kGap * crest && valley <= kGap * count[i] &&
               count[i] >= std::min(kLineShare * crest, kMoreThanOne)) {
      cuts.push_back(profile.from + kStepMm * 0.5 * static_cast<double>(valley_from + valley_to));
      crest = count[i];
      valley = 1e30;
    }
  }
  return cuts;
}

}  // namespace

void find_lines(std::vector<LineMember>* members) {
  if (members->empty()) {
    return;
  }
  std::vector<double> heights;
  for (const LineMember& m : *members) {
    heights.push_back(m.high - m.low);
  }
  const double typical_height = median_of(std::move(heights));

  double lean = 0;
  double best = contrast(profile_at(*members, 0)) * 1.02;  // straight unless another is clearly better
  for (double deg = -kMostLeanDeg; deg <= kMostLeanDeg; deg += 0.5) {
    const double candidate = std::tan(rad_from_deg(deg));
    if (const double c = contrast(profile_at(*members, candidate)); c > best) {
      best = c;
      lean = candidate;
    }
  }
  const std::vector<double> cuts = gaps(profile_at(*members, lean), typical_height);
  const int lines = static_cast<int>(cuts.size()) + 1;
  std::vector<std::size_t> order(members->size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (LineMember& m : *members) {
    const double v = 0.5 * (m.low + m.high) - lean * m.along;
    m.line = lines - static_cast<int>(std::ranges::upper_bound(cuts, v) - cuts.begin());
  }
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    const LineMember& first = (*members)[a];
    const LineMember& second = (*members)[b];
    return first.line != second.line ? first.line < second.line : first.along < second.along;
  });
  int at = 0;
  int line = 0;
  for (const std::size_t i : order) {
    LineMember& m = (*members)[i];
    at = m.line == line ? at + 1 : 1;
    line = m.line;
    m.order = at;
  }
}

}  // namespace dubsar

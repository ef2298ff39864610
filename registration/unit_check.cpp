// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/unit_check.h"

#include <array>
#include <cmath>
#include <optional>

#include "core/number_text.h"

namespace dubsar {

namespace {

/// A unit that scans come in, against the millimetre that is wanted.
struct Unit {
  double mm;
  const char* looks;  ///< what the smaller (or, under a millimetre, the larger) numbers look like
  const char* are;    ///< the same, of what may be so
  const char* mend;
};
constexpr std::array<Unit, 4> kUnits{
    {{1000.0, " and look like metres", "are metres, that is the wrong unit",
      "give its unit: --unit m for a folder, or `obj_info unit m` in its header"},
     {25.4, " and look like inches", "are inches, that is the wrong unit",
      "give its unit: --unit in for a folder, or `obj_info unit in` in its header"},
     {10.0, " and look like centimetres", "are centimetres, that is the wrong unit",
      "give its unit: --unit cm for a folder, or `obj_info unit cm` in its header"},
     {0.001, " and look like micrometres", "are micrometres, that is the wrong unit",
      "give its unit: --unit um for a folder, or `obj_info unit um` in its header"}}};

/// What is in a session was made millimetres of when it was stored.
constexpr const char* kOfSession = "; a session keeps its unit: scan into a new one with that";

/// One scanner keeps its spacing; what it sees of the object in one view varies.
constexpr double kSpacingWithin = 1.3;
constexpr double kSizeWithin = 3.0;

bool near(double ratio, double factor, double within) {
  return std::abs(std::log(ratio / factor)) <= std::log(within);
}

/// How many times smaller (below 1: larger) a scan is when read as millimetres, rounded for people.
std::string times(double ratio) {
  return std::to_string(std::lround(ratio >= 1.0 ? ratio : 1.0 / ratio)) +
         (ratio >= 1.0 ? " times smaller than the scans before it"
                       : " times larger than the scans before it");
}

std::optional<Unit> unit_of(double smaller_by, double within) {
  for (const Unit& unit : kUnits) {
    if (near(smaller_by, unit.mm, within)) {
      return unit;
    }
  }
  return std::nullopt;
}

/// The same where it is the scans before that are in the odd unit.
std::optional<Unit> unit_of_others(double smaller_by, double within) {
  for (const Unit& unit : kUnits) {
    if (unit.mm > 1.0 && unit.mm < 1000.0 && near(smaller_by, 1.0 / unit.mm, within)) {
      return unit;
    }
  }
  return std::nullopt;
}

}  // namespace

std::string impossible_size(const ScanSize& scan, double least_mm, double most_mm) {
  if (scan.scale_mm >= least_mm && scan.scale_mm <= most_mm) {
    return {};
  }
  // What was said is not known here, and may be what is wrong: the advice is a step from there.
  const bool is_small = scan.scale_mm < least_mm;
  const double thousand_times_mm = is_small ? 1000.0 * scan.scale_mm : 0.001 * scan.scale_mm;
  const bool one_step = is_small ? thousand_times_mm >= least_mm : thousand_times_mm <= most_mm;
  const char* times = one_step ? "1000" : "1 000 000";
  const char* instead = is_small
                            ? (one_step ? "--unit m (metres) in place of mm, or --unit mm in place of um"
                                        : "--unit m in place of um")
                            : (one_step ? "--unit um (micrometres) in place of mm, or --unit mm in place of m"
                                        : "--unit um in place of m");
  return "it would be " + short_text(scan.scale_mm, 3) + " mm across: its unit is " + times +
         (is_small ? " times larger than was said; give " : " times smaller than was said; give ") + instead +
         " (in a file's header: `obj_info unit`)" + kOfSession;
}

bool same_spacing(const ScanSize& a, const ScanSize& b) {
  return a.spacing_mm > 0 && b.spacing_mm > 0 && near(a.spacing_mm / b.spacing_mm, 1.0, kSpacingWithin);
}

bool sizes_agree(const ScanSize& a, const ScanSize& b, double most_ratio) {
  return same_spacing(a, b) ||
         (a.scale_mm <= most_ratio * b.scale_mm && b.scale_mm <= most_ratio * a.scale_mm);
}

std::string other_unit(const ScanSize& scan, const ScanSize& before) {
  const double by_size = before.scale_mm / scan.scale_mm;
  const double by_spacing =
      scan.spacing_mm > 0 && before.spacing_mm > 0 ? before.spacing_mm / scan.spacing_mm : by_size;
  const std::string what = "by its numbers it is " + times(by_size) + ": they are in another unit";
  std::optional<Unit> unit = unit_of(by_spacing, kSpacingWithin);
  if (!unit) {
    unit = unit_of(by_size, kSizeWithin);
  }
  return unit ? what + unit->looks + "; " + unit->mend + kOfSession
              : what + "; give the right --unit, or export it in millimetres";
}

std::string perhaps_other_unit(const ScanSize& scan, const ScanSize& before) {
  if (!(scan.scale_mm > 0 && scan.spacing_mm > 0 && before.scale_mm > 0 && before.spacing_mm > 0)) {
    return {};
  }
  const double by_size = before.scale_mm / scan.scale_mm;
  const double by_spacing = before.spacing_mm / scan.spacing_mm;
  const std::string what = "by its numbers it is about " + times(by_size);
  if (const auto unit = unit_of(by_spacing, kSpacingWithin); unit && near(by_size, unit->mm, kSizeWithin)) {
    return what + ", in size and in spacing: if they " + unit->are + "; " + unit->mend + kOfSession;
  }
  if (const auto unit = unit_of_others(by_spacing, kSpacingWithin);
      unit && near(by_size, 1.0 / unit->mm, kSizeWithin)) {
    return what + ", in size and in spacing: if those of the others " + unit->are + "; " + unit->mend +
           kOfSession;
  }
  return {};
}

}  // namespace dubsar

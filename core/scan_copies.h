// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/placed_scan.h"
#include "core/range_grid.h"
#include "core/rigid_transform.h"
#include "core/scan_copy.h"
#include "core/scan_marks.h"

namespace dubsar {

/// What tells a file's samples from any others: the valid samples of a grid and their cells, bit by bit; not
/// their confidence, nor what else a file says of them. Against chance, not against anybody.
struct SampleDigest {
  std::uint64_t across = 0;  ///< of x and y
  std::uint64_t along = 0;   ///< of z and the cells

  auto operator<=>(const SampleDigest&) const = default;
};

/// Nothing of a grid without a valid sample, which measures nothing.
[[nodiscard]] std::optional<SampleDigest> sample_digest(const RangeGrid& grid);

/// By what a measurement is known again, whatever file it comes from.
struct ScanPrint {
  SampleDigest digest;
  std::size_t samples = 0;
  ScanMarks marks;
};

/// Nothing of a grid without a valid sample.
[[nodiscard]] std::optional<ScanPrint> scan_print(const RangeGrid& grid);

/// Whether both are one measurement: the very samples, or the same but for rounding, the order of rows and
/// columns, what was cut off, and the frame (same_marks.h).
[[nodiscard]] bool are_copies(const ScanPrint& a, const ScanPrint& b);
/// The motion that lays the samples of `b` on those of `a`; nothing unless both are one measurement. The
/// identity, to the last digit, where both are in one frame.
[[nodiscard]] std::optional<RigidTransform> copy_motion(const ScanPrint& a, const ScanPrint& b);
/// Whether one of two copies has much fewer samples than the other, `whole`: what lies around them is not
/// known of both.
[[nodiscard]] bool is_part(const ScanPrint& part, const ScanPrint& whole);

/// Which of many scans are copies of others, as they come and go. One thread at a time.
class KnownPrints {
 public:
  /// Replaces what is known of the id. Nothing is known again by nothing.
  void add(int id, std::optional<ScanPrint> print);
  void remove(int id);
  void clear();
  /// By id: all but those that count. Of scans that are one measurement the one with the most samples does,
  /// of these the one with the lowest id.
  [[nodiscard]] std::vector<ScanCopy> copies() const;
  /// The same of some alone.
  [[nodiscard]] std::vector<ScanCopy> copies_among(std::set<int> ids) const;

 private:
  std::map<int, ScanPrint> prints_;
  std::set<std::pair<int, int>> same_;  ///< the lower id first
};

[[nodiscard]] std::vector<ScanCopy> copies_among(std::span<const PlacedScan> scans);

}  // namespace dubsar

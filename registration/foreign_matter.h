// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "core/range_grid.h"
#include "core/sample_flags.h"
#include "core/scan_copies.h"
#include "core/scan_pose.h"

namespace dubsar {

/// What a sample is, by what the other scans saw.
enum class Matter : std::uint8_t {
  kTablet,    ///< as far as anybody knows
  kDoubtful,  ///< may be either
  kForeign,   ///< a hand, a sleeve, a tool
};

/// Of a scan that shows something foreign.
struct ForeignFound {
  int id = 0;
  double foreign_mm2 = 0;  ///< as the scanner sees it: samples times µ²
  double doubtful_mm2 = 0;
  std::vector<int> witnesses;  ///< scans that saw through it, by id
  double left_mm2 = 0;         ///< of all other samples

  /// Next to nothing else is in it: its pose is wrong, or the thing lay over all that it saw.
  [[nodiscard]] bool is_all() const { return left_mm2 + doubtful_mm2 < 0.02 * foreign_mm2; }
};

/// Finds the samples of registered scans that are not of the tablet. A hand moves between scans, clay does
/// not: where more other scans looked through a sample, at clay well behind it, than show something there,
/// nothing of the tablet stands. From there it is followed over the scan's own surface as far as others see
/// through it, however near to the clay, or see nothing at all where clay must show; and a part that hangs on
/// it alone, not on clay that another scan shows, goes with it. What is left beside it that only this scan
/// shows may be either, and so may what is shown as often as looked through: it is doubtful, for people to
/// scan again. How deep a look through must go follows from how well the two scans agree elsewhere: a wrong
/// pose makes no clay foreign. Of scans with the very samples of each other one counts for all
/// (scan_copies.h): the others neither see nor are seen.
///
/// Keeps a witness of each scan that is a good deal smaller than a large grid, which may go. One thread at a
/// time.
class ForeignMatter {
 public:
  ForeignMatter();
  ~ForeignMatter();
  ForeignMatter(ForeignMatter&&) noexcept;
  ForeignMatter& operator=(ForeignMatter&&) noexcept;
  ForeignMatter(const ForeignMatter&) = delete;
  ForeignMatter& operator=(const ForeignMatter&) = delete;

  /// Makes a scan known; replaces it when it is. `flags` are those of its own samples.
  void add(int id, const RangeGrid& grid, const SampleFlags& flags);
  void remove(int id);

  /// Holds all scans that are registered against each other; the others neither see nor are seen. The scans
  /// in which something was found, by id. Depends on scans and poses alone.
  std::vector<ForeignFound> find(std::span<const ScanPose> poses);
  /// The registered scans that did not count in the last find(), by id.
  [[nodiscard]] const std::vector<ScanCopy>& copies() const { return copies_; }
  /// What the last find() has found of each sample of a scan, [rows*cols]; `grid` as it was added. Empty when
  /// it found nothing there.
  [[nodiscard]] std::vector<Matter> matter(int id, const RangeGrid& grid) const;

 private:
  struct Witness;
  struct Placed;
  static bool is_suspect(const Placed& own, std::span<const Placed> all);
  static bool look(const Placed& own, std::span<const Placed> all);

  std::map<int, std::unique_ptr<Witness>> witnesses_;
  KnownPrints prints_;  ///< of these
  std::vector<ScanCopy> copies_;
};

}  // namespace dubsar

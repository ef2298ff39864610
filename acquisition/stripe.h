// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "acquisition/stripe_fit.h"
#include "acquisition/stripe_line.h"
#include "core/gray_image.h"
#include "core/result.h"

namespace dubsar {

/// How the middle of the stripe is found. `dubsar-frames` (bench/accuracy) measures them against each other.
enum class StripeMethod {
  /// Centre of mass under a Gaussian window, then an average along the stripe; how wide both are, the noise
  /// of
  /// this frame's stripe decides: narrow where the laser speckles little, wide where it speckles.
  kAdaptive,
  kCentroid,  ///< centre of mass over the background
  kGaussian,  ///< weighted least squares of a parabola to the logarithm
  kSteger,    ///< ridge of the smoothed image
};

/// Which way the stripe runs through the image.
enum class StripeAxis {
  kPerColumn,  ///< one sample per image column: the stripe runs across
  kPerRow,     ///< one sample per image row: the stripe runs from top to bottom
};

struct StripeOptions {
  StripeMethod method = StripeMethod::kAdaptive;
  StripeAxis axis = StripeAxis::kPerColumn;
  double sigma_px = 1.2;      ///< of the stripe's cross section, about
  int least_peak = 12;        ///< grey values over the background: less is no stripe
  int saturated_from = 254;   ///< grey value that may have been more
  int most_saturated_px = 4;  ///< across the stripe; more and its middle is a guess
  double widest = 2.5;        ///< times sigma_px: a wider one is no clean stripe
  double second_share = 0.5;  ///< another peak of this share of the best makes the sample doubtful: left out
  bool keep_light = false;    ///< the profile keeps the light around the stripe
  /// Errors (kUsage): numbers that make no sense.
  [[nodiscard]] Status check() const;
};

/// What became of a column.
enum class StripeState : std::uint8_t {
  kGood = 0,
  kNone,        ///< nothing as bright as a stripe
  kSaturated,   ///< too many saturated pixels
  kReflection,  ///< two peaks, one of which is a reflection
  kWide,        ///< smeared: an edge, a blurred or a washed-out stripe
};

/// The light around the stripe, background taken off, column by column: what a later look at several
/// pictures together needs of one (swept_light.h).
struct StripeLight {
  int rows = 0;             ///< of a column
  std::vector<int> from;    ///< [columns] row of the first
  std::vector<float> grey;  ///< [columns × rows]; dark where there is no stripe
};

/// One sample per column (or row, see StripeAxis).
struct StripeProfile {
  std::vector<float> at_px;       ///< where the stripe is; of no meaning unless good
  std::vector<float> peak;        ///< over the background, share of the full range
  std::vector<float> confidence;  ///< [0,1]; 0 unless good
  std::vector<StripeState> state;
  double noise_px = 0;  ///< of one column's middle, before any average; kAdaptive only
  StripeLight light;    ///< empty unless asked for
  void resize(std::size_t count);
  [[nodiscard]] std::size_t count_of(StripeState which) const;
};

/// Finds the laser stripe in frames of one size. Keeps its scratch memory between frames: use one per thread.
/// One pass over the pixels, which runs at memory speed, then a few dozen pixels per column.
class StripeExtractor {
 public:
  explicit StripeExtractor(const StripeOptions& options)
      : options_(options), ridge_(std::max(0.8, options.sigma_px)), window_(options.sigma_px) {}

  [[nodiscard]] const StripeOptions& options() const { return options_; }
  /// `off` is a frame of the same size without the laser and is subtracted first; an empty one is allowed.
  void extract(const GrayView& on, const GrayView& off, StripeProfile& profile);

 private:
  static constexpr int kMostHalf = 24;  ///< rows looked at on either side of a peak
  static constexpr int kSide = 2 * kMostHalf + 1;
  /// The rows around a column's stripe, background taken off.
  struct Cut {
    std::array<float, kSide> light;
    int low = 0;  ///< row of the first
    int size = 0;
  };
  struct CutLight {
    int saturated = 0;  ///< rows
    /// What was left of the background, from the two ends, of which a neighbour's light may lift one. Taken
    /// off.
    float ground = 0;
    float peak = 0;
  };

  void find_peaks(const GrayView& on, const GrayView& off);
  CutLight take_cut(const GrayView& on, const GrayView& off, int column, int row, int reach, Cut& cut) const;
  void refine(const GrayView& on, const GrayView& off, int column, StripeProfile& profile);
  [[nodiscard]] std::optional<double> ridge_row(const GrayView& on, const GrayView& off, int column,
                                                double start) const;
  void settle(StripeProfile& profile);
  void keep_light(StripeProfile& profile) const;

  StripeOptions options_;
  RidgeDetector ridge_;
  CentreWindow window_;
  std::vector<Cut> cuts_;  ///< [columns]
  StripeLine line_;
  int blocks_ = 0;
  std::vector<std::uint8_t> block_peak_;   ///< [blocks × columns]
  std::vector<std::uint8_t> best_;         ///< [columns] the highest block peak
  std::vector<std::uint16_t> best_block_;  ///< [columns]
  std::vector<std::uint8_t> second_;       ///< [columns] the highest that is not beside it
  GrayImage turned_on_, turned_off_;
};

}  // namespace dubsar

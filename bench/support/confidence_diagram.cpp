// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/confidence_diagram.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace dubsar::bench {

namespace {

struct Bin {
  double from = 0;
  double promised = 0;
  int right = 0;
  int all = 0;
};

/// The last tenth is parted, for most wedges lie there.
constexpr std::array<double, 10> kFrom = {0.0, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 0.98, 0.995};

void put(double confidence, bool right, std::array<Bin, kFrom.size()>* bins) {
  std::size_t at = kFrom.size() - 1;
  while (at > 0 && confidence < kFrom[at]) {
    --at;
  }
  Bin& bin = (*bins)[at];
  bin.promised += confidence;
  bin.right += right ? 1 : 0;
  ++bin.all;
}

}  // namespace

void print_confidence_diagram(const std::vector<double>& right, const std::vector<double>& wrong) {
  std::array<Bin, kFrom.size()> bins;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    bins[i].from = kFrom[i];
  }
  for (const double c : right) {
    put(c, true, &bins);
  }
  for (const double c : wrong) {
    put(c, false, &bins);
  }
  double off = 0;
  int total = 0;
  for (const Bin& bin : bins) {
    if (bin.all == 0) {
      continue;
    }
    const double n = bin.all;
    const double share = bin.right / n;
    const double z2 = 1.96 * 1.96;
    const double middle = (share + z2 / (2 * n)) / (1 + z2 / n);
    const double half = 1.96 / (1 + z2 / n) * std::sqrt(share * (1 - share) / n + z2 / (4 * n * n));
    std::printf("confidence from %.3f: %5d of %5d are wedges, %.3f (%.3f to %.3f), promised %.3f\n", bin.from,
                bin.right, bin.all, share, middle - half, middle + half, bin.promised / n);
    off += std::abs(bin.promised - bin.right);
    total += bin.all;
  }
  std::printf("expected calibration error %.4f over %d\n", total > 0 ? off / total : 0.0, total);
}

}  // namespace dubsar::bench

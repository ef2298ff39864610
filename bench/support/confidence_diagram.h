// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

namespace dubsar::bench {

/// Prints the reliability diagram of the confidences: of the found wedges whose confidence lies in a bin, the
/// mean of what was promised beside the share that are wedges, with the 95 % interval of that share (Wilson);
/// then the expected calibration error, the mean of |promised - share| over the wedges.
void print_confidence_diagram(const std::vector<double>& right, const std::vector<double>& wrong);

}  // namespace dubsar::bench

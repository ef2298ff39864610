// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/scanner.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace dubsar::sim {
namespace {}  // namespace
}  // namespace dubsar::sim

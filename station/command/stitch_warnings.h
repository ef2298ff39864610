// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <map>
#include <string>

#include "triangulation/stitcher.h"

namespace dubsar {

/// Says which scans (names by id) overlap no other, and which lie apart where they do.
void warn_of_places(const Stitcher& stitcher, const std::map<int, std::string>& names);

}  // namespace dubsar

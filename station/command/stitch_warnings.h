// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <map>
#include <string>

#include "triangulation/stitcher.h"

namespace dubsar {

/// Takes the scans that only repeat another's samples out of the names (by id), and says so.
void leave_out_copies(const Stitcher& stitcher, std::map<int, std::string>& names);

/// Says which scans overlap no other, and which lie apart where they do.
void warn_of_places(const Stitcher& stitcher, const std::map<int, std::string>& names);

}  // namespace dubsar

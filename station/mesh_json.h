// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <nlohmann/json.hpp>

#include "triangulation/mesh_check.h"

namespace dubsar {

/// What `mesh check --json` and `stitch --json` print of a mesh.
[[nodiscard]] nlohmann::ordered_json mesh_report_json(const MeshReport& report);

}  // namespace dubsar

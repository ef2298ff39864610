// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"
#include "core/scan_copy.h"
#include "triangulation/stitcher.h"

namespace dubsar {

/// For people, of scans by their names (by id), one line each: which overlap no other, and which lie apart
/// where they do: of many pairs the scans that seem at fault, in one line.
[[nodiscard]] std::vector<std::string> warnings_of_places(const Stitcher& stitcher,
                                                          const std::map<int, std::string>& names);
/// The pairs that lie apart: [{"ids":[0,3],"mm":0.21}].
[[nodiscard]] nlohmann::ordered_json apart_json(const Stitcher& stitcher);

/// That a scan is no part of the mesh, and why. `word`, what the scan is (`unsure`), and `reason` may be
/// empty.
[[nodiscard]] std::string left_out_sentence(const std::string& name, const std::string& word,
                                            const std::string& reason);
/// The reason of one that only repeats another's samples.
[[nodiscard]] std::string copy_reason(const ScanCopy& copy, const std::map<int, std::string>& names);
/// The reason of one without a triangle.
[[nodiscard]] std::string no_surface_reason();

/// That scans gave no mesh; nothing where the mesh has a face.
[[nodiscard]] Status check_has_surface(const Mesh& mesh, const std::string& where);

}  // namespace dubsar

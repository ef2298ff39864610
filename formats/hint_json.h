// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/pose_hint.h"
#include "core/result.h"

namespace dubsar {

/// What a hint file says (docs/formats/hints.md). `hint.on` is -1 where the file does not name the other
/// scan. A rough pose comes against the other scan (in the hint) or in the model frame.
struct HintFile {
  PoseHint hint;
  std::optional<RigidTransform> model_from_scanner;
};

/// The hint with its other scan, on one line: what the session keeps.
[[nodiscard]] std::string hint_to_json(const PoseHint& hint);

/// Exactly one of `points`, `on_from_scanner` and `model_from_scanner` must be there.
[[nodiscard]] Result<HintFile> parse_hint(std::string_view text, const std::string& where);
[[nodiscard]] Result<HintFile> read_hint(const std::filesystem::path& path);

/// The command line's short forms: `x,y,z=x,y,z` is one pair; `n` numbers stand apart by commas or blanks.
[[nodiscard]] Result<PointPair> parse_point_pair(std::string_view text);
[[nodiscard]] Result<RigidTransform> parse_pose_numbers(std::string_view text, const std::string& where);

}  // namespace dubsar

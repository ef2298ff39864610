// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace dubsar {

/// A certified artefact: balls on a bar or plate, and perhaps a plane; and what a scanner may be off by.
struct Artefact {
  struct Ball {
    double diameter_mm = 0;
    Eigen::Vector3d center_mm{0, 0, 0};  ///< in the certificate's own frame
  };
  std::string name;         ///< with its serial number
  std::string certificate;  ///< number and date
  std::vector<Ball> balls;
  bool has_plane = false;
  /// Of the plane, the longer side first: what has to be seen of it. Both 0: any part will do.
  std::array<double, 2> plane_mm{0, 0};
  double form_limit_mm = 0;     ///< probing error (form)
  double size_limit_mm = 0;     ///< probing error (size), either way
  double spacing_limit_mm = 0;  ///< sphere spacing error, either way
  double flatness_limit_mm = 0;
};

/// Reads artefact.toml (docs/formats/artefact.md). Errors: kBadInput.
[[nodiscard]] Result<Artefact> parse_artefact(std::string_view toml, const std::string& where);

}  // namespace dubsar

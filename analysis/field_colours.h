// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "analysis/surface_fields.h"

namespace dubsar {

enum class SurfaceField { kReliability, kMeanCurvature, kOpenness, kFreeSurface, kHeight };
inline constexpr std::array<SurfaceField, 5> kSurfaceFields = {
    SurfaceField::kReliability, SurfaceField::kMeanCurvature, SurfaceField::kOpenness,
    SurfaceField::kFreeSurface, SurfaceField::kHeight};

/// For file names: "reliability", "curvature", "openness", "free_surface", "height".
[[nodiscard]] std::string_view field_name(SurfaceField field);

/// One colour a vertex for Mesh::colours, [V]: reliability and openness from dark to pale, free surface clay
/// on dark, curvature blue in valleys and red on ridges (±3 per mm), height blue below the surface and red
/// above it, full at the depth that 1 % of the vertices lie below. Not finite: grey.
[[nodiscard]] std::vector<std::array<std::uint8_t, 3>> field_colours(const SurfaceFields& fields,
                                                                     SurfaceField field);

/// Colours of any values: low blue, middle pale, high red; full at ±range about the middle.
[[nodiscard]] std::vector<std::array<std::uint8_t, 3>> diverging_colours(const std::vector<float>& values,
                                                                         float middle, float range);

}  // namespace dubsar

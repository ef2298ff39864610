// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>

#include "analysis/cross_section.h"
#include "archive/picture_words.h"
#include "core/result.h"

namespace dubsar {

/// A row for each point: piece, along_mm, height_mm, x_mm, y_mm, z_mm.
[[nodiscard]] std::string section_csv(const CrossSection& section);

/// SVG 1.1 in millimetres, 1:1 and not exaggerated: the cut, the line between its two places, length and
/// greatest depth below that line, dimensioned; the words stand in its metadata as RDF.
[[nodiscard]] std::string section_svg(const CrossSection& section, const PictureWords& words);

/// As the name ends: .csv or .svg, which says what the mesh's label says. Errors: kUsage for another ending,
/// kStorage.
Status write_section(const CrossSection& section, const std::filesystem::path& file, const FileLabel& label);

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/wedge_correction.h"

namespace dubsar {

/// What a person has said about the wedges of a mesh: corrections.json (docs/formats/corrections.md).
struct CorrectionFile {
  std::string mesh;  ///< file name of the mesh
  std::vector<WedgeCorrection> corrections;
};

/// NAME.corrections.json beside NAME.json, the wedges.
[[nodiscard]] std::filesystem::path corrections_file_of(const std::filesystem::path& wedges_json);

[[nodiscard]] std::string corrections_to_json(const CorrectionFile& file);
/// Others have another one; XXH3 (128 bits) of their JSON.
[[nodiscard]] std::string corrections_digest(const std::vector<WedgeCorrection>& corrections);
[[nodiscard]] Status write_corrections(const std::filesystem::path& path, const CorrectionFile& file);
/// The same where the file still says what was `known` when these were made, so that nobody's correction is
/// lost. Errors: kUsage when another program has changed them meanwhile, kBadInput when the file cannot be
/// read, kStorage; nothing is written then.
[[nodiscard]] Status replace_corrections(const std::filesystem::path& path,
                                         const std::vector<WedgeCorrection>& known,
                                         const CorrectionFile& file);
[[nodiscard]] Result<CorrectionFile> parse_corrections(std::string_view text, const std::string& where);
/// No corrections where there is no file.
[[nodiscard]] Result<CorrectionFile> read_corrections(const std::filesystem::path& path);

}  // namespace dubsar

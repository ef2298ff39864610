// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/wedge_correction.h"
#include "formats/corrections_json.h"
#include "formats/file_label.h"
#include "station/analysis_asked.h"
#include "station/command/command.h"

namespace dubsar {

/// What `dubsar analyze` is asked for.
struct AnalyzeArguments : AnalysisAsked {
  std::string in;
  bool again = false;
  std::string corrections;                                ///< file; empty: the one beside the output
  std::optional<std::vector<WedgeCorrection>> corrected;  ///< in the place of what that file says
  std::vector<WedgeCorrection> known;                     ///< what that file said when they were made
  /// The last of `corrected` is new (where it cannot be made, nothing is changed); else one was taken back.
  bool must_make_last = false;
};

/// Every file and folder that the analysis writes.
[[nodiscard]] std::vector<std::string> written_by(const AnalyzeArguments& arguments);

void add_analyze_options(CLI::App& verb, AnalyzeArguments& arguments);

/// Everything beside the mesh that decides what is written, and where, for the stamp. `of_session`: what the
/// session says in which the mesh lies.
[[nodiscard]] std::string parameters_of(const AnalyzeArguments& arguments, const CorrectionFile& said,
                                        const std::optional<FileLabel>& of_session);

/// Where the corrections lie that the analysis goes by.
[[nodiscard]] std::filesystem::path corrections_of(const AnalyzeArguments& arguments);

/// Writes `arguments.corrected`, where it is set, as the corrections file. Errors: kBadInput where the last
/// correction must be made and cannot be; nothing is written then.
[[nodiscard]] Result<int> analyze(const AnalyzeArguments& arguments, CommandContext& context);

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/known_wedge.h"
#include "core/result.h"
#include "core/rigid_transform.h"
#include "core/stage_times.h"
#include "core/wedge.h"
#include "core/wedge_correction.h"
#include "core/wedge_profile.h"
#include "formats/file_label.h"

namespace dubsar {

/// What an analysis says of one mesh: wedges.json (contract "Wedges" in design.md; docs/formats/wedges.md).
struct WedgeFile {
  std::string program;  ///< that measured them, with its version; empty where nobody says so
  int method = 0;       ///< kWedgeMethod (analysis/wedges.h) that they were measured by; 0: not known
  FileLabel label;      ///< what they are of; the file may travel alone
  std::string mesh;     ///< file name of the mesh
  ExitDefinition exits = ExitDefinition::kSurface;
  /// What the mesh's numbers were taken for, by their size alone: one of kLengthUnits. Mostly empty.
  std::string unit_assumed;
  /// Of the mesh: the edge of the equilateral triangle that its mean vertex stands for; 0: not said.
  double spacing_mm = 0;
  std::vector<Wedge> wedges;
  std::vector<KnownWedge> former;  ///< ids of wedges that are no more, and are given to no other
  std::vector<RejectedWedge> rejected;
  std::size_t corrections = 0;       ///< how many a person has asked for
  std::string corrections_xxh128;    ///< corrections_digest() of them; empty: not said
  std::vector<LostCorrection> lost;  ///< those of them that could not be made
  /// Text's frame: x to the reader's right, y up the obverse, z out of it (analysis/text_frame.h).
  std::optional<RigidTransform> text_from_model;
  double text_certainty = 0;
  /// Of the tablet and of its sides. Lengths are in millimetres whatever the file's unit.
  std::vector<WedgeProfile> profiles;
  StageTimes timings_s;
};

/// Whether these are the corrections that a person had asked for when the wedges were measured. A file that
/// says nothing but their number is taken at that.
[[nodiscard]] bool has_corrections(const WedgeFile& file, const std::vector<WedgeCorrection>& corrections);

[[nodiscard]] std::string wedges_to_json(const WedgeFile& file);
[[nodiscard]] Status write_wedges(const std::filesystem::path& path, const WedgeFile& file);
/// Reads also what only the contract asks for, as another program or a truth.json has it.
[[nodiscard]] Result<WedgeFile> parse_wedges(std::string_view text, const std::string& where);
[[nodiscard]] Result<WedgeFile> read_wedges(const std::filesystem::path& path);

}  // namespace dubsar

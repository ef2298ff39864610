// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "core/range_grid.h"
#include "core/result.h"
#include "formats/file_label.h"

namespace dubsar {

/// A sentence where a scan, or rows of one that was not over, come from the simulator, by the id that it
/// gives its grids: an archive that outlives whoever tried the scanner must not take such a tablet for clay.
/// Empty of clay.
[[nodiscard]] Result<std::string> simulated_words(const SessionStore& store);

/// Whether the grid names the simulator as its device. A grid file (.grid) tells it so alone.
[[nodiscard]] bool is_made_up(const RangeGrid& grid);

/// Of files that the simulator makes.
[[nodiscard]] FileLabel made_up_label();

/// What a mesh of range grids that belong to no session says: what their own files say, where all say the
/// same; else no more than that some of them were made up. Files that say nothing count, too. `made_up`:
/// is_made_up() of any of them.
[[nodiscard]] FileLabel label_of_files(const std::vector<std::filesystem::path>& grids, bool made_up);

/// What the files of a session's tablet say of themselves: its numbers (without any the session's name),
/// collection, who scanned it, rights, and whether a program made it up. Notes stay with the session.
[[nodiscard]] Result<FileLabel> tablet_label(const SessionStore& store);

/// What files that stay in the session say: what its scans tell, and no more, for they can be made anew from
/// the scans, the same to the byte, whatever was typed since and wherever the session lies.
[[nodiscard]] Result<FileLabel> label_of_scans(const SessionStore& store);

}  // namespace dubsar

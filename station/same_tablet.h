// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

namespace dubsar {

/// Whether a mesh is of the tablet whose wedges were corrected in `corrections`, whatever its file is called:
/// both belong to one session, in it or in SESSION.results beside it, or the corrections lie in a session and
/// the mesh says of itself what that session calls its tablet, as one that was stitched from it does. False
/// also where nobody can tell.
[[nodiscard]] bool is_of_the_tablet_of(const std::filesystem::path& mesh,
                                       const std::filesystem::path& corrections);

}  // namespace dubsar

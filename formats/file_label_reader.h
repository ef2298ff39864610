// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/file_label.h"
#include "formats/json_node.h"

namespace dubsar {

/// A label of words with their usual names ("Museum number", "CDLI number", "Session", "Rights",
/// "SIMULATED"): what the tablet is called follows from them.
[[nodiscard]] FileLabel label_of_words(std::vector<std::pair<std::string, std::string>> words);

/// Of an object that has them by name, as GLB and wedges.json do; other names are passed over.
[[nodiscard]] FileLabel label_in_object(const JsonNode& object);

/// What a mesh in PLY, OBJ, GLB or STL, or a range grid in PLY, that Dubsar wrote says of itself, so that
/// what is made of it says the same; empty where that is nothing, is another program's, or cannot be read.
/// Looks at the first MiB alone.
[[nodiscard]] FileLabel read_file_label(const std::filesystem::path& file);
[[nodiscard]] FileLabel file_label_in(std::string_view head);

/// The same of a mesh; where it does not say that Dubsar made it, what is made of it has an origin, which
/// names the file.
[[nodiscard]] FileLabel read_mesh_label(const std::filesystem::path& file);

}  // namespace dubsar

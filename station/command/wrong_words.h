// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "core/result.h"

/// What the parser itself has no good words for.
namespace dubsar {

/// A word, or nothing, where a verb should stand: with the one that is meant, or those that there are.
[[nodiscard]] std::optional<Error> unknown_verb(const CLI::App& app);

/// An option or argument that was given no text: most often a variable of a script that is not set.
[[nodiscard]] std::optional<Error> empty_option(const CLI::App& app);

}  // namespace dubsar

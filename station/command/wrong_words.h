// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "core/result.h"

/// What the parser itself has no good words for.
namespace dubsar {

/// A word, or nothing, where a verb should stand: with the one that is meant, or those that there are.
[[nodiscard]] std::optional<Error> unknown_verb(const CLI::App& app);

/// An option that the verb does not have: with the one that is meant, where one is like it.
[[nodiscard]] std::optional<Error> unknown_option(const CLI::App& app);

/// What else was left over, in the order in which it stands.
[[nodiscard]] std::optional<Error> surplus_words(const CLI::App& app);

/// What the verb that was asked for works on: its first argument, else its output, else its own name.
[[nodiscard]] std::string subject_of(const CLI::App& app);

/// An option or argument that was given no text: most often a variable of a script that is not set.
[[nodiscard]] std::optional<Error> empty_option(const CLI::App& app);

}  // namespace dubsar

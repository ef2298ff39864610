// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "station/command/command.h"

namespace dubsar {

/// The action of a verb that writes these files: kUsage, before it begins, where one of them
/// - lies in a session or package or is one (place_outside.h);
/// - has no folder to lie in;
/// - is what the verb reads (`inputs`), or two are the same place;
/// - is standard output, while --json prints its object there.
/// Empty paths are passed over; links are followed.
[[nodiscard]] Action with_safe_outputs(std::vector<std::string> outputs, Action action,
                                       std::vector<std::string> inputs = {});

/// Errors: kUsage where one of the outputs is an input, or two are the same place. Empty paths are passed
/// over; links are followed.
[[nodiscard]] Status check_apart(const std::vector<std::string>& outputs,
                                 const std::vector<std::string>& inputs);

/// Where a file lies, from the folder of an output: both may move together. Empty for none.
[[nodiscard]] std::string from_folder_of(const std::string& path, const std::string& output);

/// For the list of outputs: a folder, which is made with all the folders that it lies in.
[[nodiscard]] std::string as_folder(const std::string& path);

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>

#include "core/job.h"
#include "core/result.h"

namespace dubsar {

/// read_whole_file() (formats/atomic_file.h) that ends soon after the job was cancelled (kCancelled): it is
/// asked between blocks. A null job stops nothing.
[[nodiscard]] Result<std::string> read_whole_file_unless_stopped(const std::filesystem::path& path,
                                                                 const JobContext* job);

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "core/job.h"
#include "core/result.h"
#include "station/done_stamp.h"

namespace dubsar {

/// Whether the package may go for the one that `now` makes of the session: it is whole by its own checksums,
/// and the stamp beside it says that it was made of this very session when that held the same scans or fewer,
/// by whatever version and with whatever options. Not where nothing tells that it is of this session. Reads
/// every byte of it. Errors: kCancelled; kBadInput where it is of this session and somebody changed it, or
/// the session has lost since what it holds, a scan or a line of its record, or that record is damaged; those
/// of opening the session.
[[nodiscard]] Result<bool> is_earlier_package(const std::filesystem::path& package,
                                              const std::filesystem::path& session, const StampedWork& now,
                                              JobContext& job);

}  // namespace dubsar

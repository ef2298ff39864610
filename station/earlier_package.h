// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "acquisition/session_store.h"
#include "core/job.h"
#include "core/result.h"
#include "station/done_stamp.h"

namespace dubsar {

/// kUsage unless the folder is a package that Dubsar made, whole or not: a bag that names Dubsar as what made
/// it or holds the record of a session. Bags of others are theirs. An empty folder is nothing, and passes.
[[nodiscard]] Status check_is_package(const std::filesystem::path& folder);

/// kUsage where the package shows that it is of another session: it has a record, and neither an event of
/// that nor a scan is one of this session's. Passes where there is no package.
[[nodiscard]] Status check_is_of_session(const std::filesystem::path& package, const SessionStore& store);

/// kBadInput where the payload of the package, which was written as the stamp says, holds a file that
/// somebody added: the package is no longer valid. Files beside the payload are allowed.
[[nodiscard]] Status check_nothing_added(const std::filesystem::path& package, const DoneStamp& stamp);

/// Whether the package may go for the one that `now` makes of the session: it is whole by its own checksums,
/// and the stamp beside it says that it was made of this very session when that held the same scans or fewer,
/// by whatever version and with whatever options. Not where nothing tells that it is of this session. Reads
/// every byte of it. Errors: kCancelled; kBadInput where it is of this session and somebody changed it, or
/// the session has lost since what it holds, a scan, what a person said or a line of its record, or that
/// record is damaged; those of opening the session.
[[nodiscard]] Result<bool> is_earlier_package(const std::filesystem::path& package,
                                              const std::filesystem::path& session, const StampedWork& now,
                                              JobContext& job);

/// For whoever did not ask to replace it: kUsage, with what lies there and what is to be done, where that is
/// a package of this session. Errors besides: those of is_earlier_package(). Passes where it is something
/// else, or nothing.
[[nodiscard]] Status check_is_not_packed(const std::filesystem::path& package,
                                         const std::filesystem::path& session, const StampedWork& now,
                                         JobContext& job);

}  // namespace dubsar

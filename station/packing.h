// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "core/job.h"
#include "core/result.h"
#include "station/package.h"

namespace dubsar {

struct PackRequest {
  std::filesystem::path session;
  std::filesystem::path to;  ///< the folder to make
  PackageOptions package;    ///< `replace`: done before or not
  bool update = false;       ///< replaces what lies there where it is an earlier package of this session
};

struct Packing {
  bool done_before = false;  ///< from the same session; then nothing was written, and `package` is empty
  Package package;
};

/// write_package() with a stamp beside it (done_stamp.h), so that packing the same session again finds it
/// done. The package goes where `to` leads (resolved_place()). Errors: those of write_package(), and kUsage
/// for a place in a session or package (check_place_of_package()), and behind a ".." that leads nowhere.
[[nodiscard]] Result<Packing> pack_session(const PackRequest& request, JobContext& job);

/// Whether a package of the session as it stands lies there, by whatever version and with whatever was left
/// out: the stamp beside it says that it was made of these very files, and each of its own is there, as long
/// as it was written. Reads the session, and nothing of the package: dubsar verify does that. Errors:
/// kStorage, kCancelled.
[[nodiscard]] Result<bool> is_packed(const std::filesystem::path& session,
                                     const std::filesystem::path& package, const JobContext& job);

/// "SESSION.results/package", where a session's package goes unless somebody says otherwise
/// (docs/collections.md).
[[nodiscard]] std::filesystem::path usual_package_of(const std::filesystem::path& session);

}  // namespace dubsar

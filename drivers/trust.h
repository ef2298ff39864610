// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <sys/types.h>

#include <filesystem>

#include "core/result.h"

namespace dubsar {

/// Whether code may be loaded from this file: nobody but the user and root can have put it there or change
/// it. The file, the folder that it lies in and every folder above, with all links followed, belong to the
/// user or to root; they are written to by neither others, nor a group with other people in it, nor anybody
/// whom an access list names. A folder above the file's own may be, where its sticky bit keeps names from
/// being replaced, or where its group may install programs anyway (root; staff, which Debian gives /usr/local
/// to). Gives the file with all links followed. Errors: kDevice, with who may change what and how to take the
/// right away.
[[nodiscard]] Result<std::filesystem::path> trusted_file(const std::filesystem::path& file, uid_t user);

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

namespace dubsar {

/// flock() on an open folder, with LOCK_EX or LOCK_EX | LOCK_NB. 0 when it is locked, and where the file
/// system cannot lock a folder, so that nothing is worse there than without locks: NFS wants a file that is
/// open for writing, which no folder can be. Else the errno, EWOULDBLOCK when another has it.
[[nodiscard]] int lock_folder(int folder, int operation);

}  // namespace dubsar

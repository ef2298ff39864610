// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/folder_lock.h"

#include <sys/file.h>

#include <cerrno>

namespace dubsar {

int lock_folder(int folder, int operation) {
  while (::flock(folder, operation) != 0) {
    switch (errno) {
      case EINTR:
        continue;
      case EBADF:
      case EINVAL:
      case ENOLCK:
      case EOPNOTSUPP:
        return 0;
      default:
        return errno;
    }
  }
  return 0;
}

}  // namespace dubsar

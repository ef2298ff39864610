// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/writers_turn.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "formats/folder_lock.h"

namespace dubsar {

Result<WritersTurn> WritersTurn::take(const std::filesystem::path& folder) {
  WritersTurn turn(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (const int error = turn.fd_ < 0 ? errno : lock_folder(turn.fd_, LOCK_EX); error != 0) {
    return fail(ErrorKind::kStorage, std::string("cannot lock the folder: ") + std::strerror(error),
                folder.string(), "choose a folder that can be written to");
  }
  return turn;
}

WritersTurn::WritersTurn(WritersTurn&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

WritersTurn::~WritersTurn() {
  if (fd_ >= 0) {
    ::close(fd_);
  }
}

}  // namespace dubsar

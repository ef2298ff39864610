// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/refusal.h"

#include <cerrno>
#include <cstring>

namespace dubsar {

std::string mend_of_refusal(int error, std::string_view otherwise) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "free some space on this disk and try again; what was stored before is untouched";
    case EFBIG:
      return "the file exceeds a size limit; store it on another disk or raise the limit";
    case EROFS:
    case EACCES:
    case EPERM:
      return "choose a folder that can be written to";
    case ENAMETOOLONG:
      return "choose a shorter name: what is added to it while it is written has to have room too";
    case EMFILE:
    case ENFILE:
      return "close other programs, or raise the limit on open files (ulimit -n)";
    default:
      return std::string(otherwise);
  }
}

std::unexpected<Error> refused(const std::filesystem::path& path, std::string_view doing, int error,
                               std::string_view otherwise) {
  return fail(ErrorKind::kStorage, std::string(doing) + ": " + std::strerror(error), path.string(),
              mend_of_refusal(error, otherwise));
}

}  // namespace dubsar

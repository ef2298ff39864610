// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/result.h"

namespace dubsar {

std::string Error::line() const {
  // A device that is named by its scheme alone ends in a colon of its own.
  std::string text = where.empty() ? what : where + (where.ends_with(':') ? " " : ": ") + what;
  if (!mend.empty()) {
    text += "; " + mend;
  }
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      c = '?';
    }
  }
  return text;
}

int exit_status(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
    case ErrorKind::kBadInput:
      return 2;
    case ErrorKind::kDevice:
      return 3;
    case ErrorKind::kCancelled:
      return 1;
    case ErrorKind::kStorage:
    case ErrorKind::kInternal:
      break;
  }
  return 4;
}

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <csetjmp>
#include <cstdio>

#include <jpeglib.h>  // wants cstdio before it

namespace dubsar {

/// libjpeg reports by a jump. Nothing with a destructor may live between the jump and where it lands: all of
/// that is the caller's.
struct JpegComplaint {
  jpeg_error_mgr manager;
  std::jmp_buf back;
  std::array<char, JMSG_LENGTH_MAX> text;

  /// For jpeg_error_mgr::error_exit.
  static void leave(j_common_ptr info) {
    auto* complaint = reinterpret_cast<JpegComplaint*>(info->err);
    (*info->err->format_message)(info, complaint->text.data());
    std::longjmp(complaint->back, 1);
  }
};

}  // namespace dubsar

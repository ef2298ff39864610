// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/gl/card_memory.h"

#include <epoxy/gl.h>

namespace dubsar::ui {

bool card_has_refused() {
  constexpr int kMostKinds = 16;  // each is kept once; a driver that lost the card may tell of it for ever
  bool refused = false;
  for (int k = 0; k < kMostKinds; ++k) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) {
      break;
    }
    refused = refused || error == GL_OUT_OF_MEMORY;
  }
  return refused;
}

}  // namespace dubsar::ui

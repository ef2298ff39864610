// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/gl/card_memory.h"

#include <epoxy/gl.h>

namespace dubsar::ui {

bool card_has_refused() {
  bool refused = false;
  for (GLenum error = glGetError(); error != GL_NO_ERROR; error = glGetError()) {
    refused = refused || error == GL_OUT_OF_MEMORY;
  }
  return refused;
}

}  // namespace dubsar::ui

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/window_title.h"

#include "core/utf8.h"
#include "station/session_name.h"

namespace dubsar::ui {

std::string window_title(const std::string& museum_number, const std::filesystem::path& session,
                         const std::string& device) {
  std::string title = one_line(museum_number);
  for (const std::string& part : {session_name(session), one_line(device)}) {
    title += (title.empty() || part.empty() ? "" : " – ") + part;
  }
  return title;
}

bool is_simulated(const std::string& device) {
  return device.starts_with("sim:");
}

}  // namespace dubsar::ui

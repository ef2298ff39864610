// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Who signed the verdict of a package, and whether that holds.

#include <algorithm>

#include "station/package_content.h"
#include "station/sign_off_words.h"

namespace dubsar {

std::string signature_words(const PackageContent& content) {
  if (const auto& checked = content.results().checklist.sign_off) {
    return sign_off_line(*checked);
  }
  const auto events = content.store.events();
  const bool any = events && std::ranges::any_of(
                                 *events, [](const SessionEvent& event) { return event.kind == "signed"; });
  return any ? "there is one that cannot be read, in session/events.json" : "unsigned";
}

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Who signed the verdict of a package, and whether that holds.

#include "station/package_content.h"
#include "station/sign_off_words.h"

namespace dubsar {

std::string signature_words(const PackageContent& content) {
  const auto events = content.store.events();
  bool any = false;
  bool described_since = false;
  for (const SessionEvent& event : events ? *events : std::vector<SessionEvent>()) {
    any = any || event.kind == "signed";
    described_since = event.kind == "tablet described" ? any : described_since && event.kind != "signed";
  }
  if (const auto& checked = content.results().checklist.sign_off) {
    return sign_off_line(*checked) +
           (described_since ? "; what tablet it is was said or changed after that (session/events.json)"
                            : "");
  }
  return any ? "there is one that cannot be read, in session/events.json" : "unsigned";
}

}  // namespace dubsar

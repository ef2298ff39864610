// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

namespace dubsar {

/// A name under a verdict. What was signed is a manifest of the session (docs/formats/sign_off.md), and the
/// digest is that of its text: it says that nothing has changed since, not who typed the name.
struct SignOff {
  int number = 0;  ///< from 1, in the order of signing
  std::string name;
  std::string role;
  std::string note;
  std::string when;  ///< ISO 8601, UTC
  bool conclusive = false;
  std::string incomplete;  ///< why it was signed though something is missing; empty otherwise
  std::string program;     ///< that worked out the verdict
  std::string digest;      ///< SHA-256 of the manifest, lower-case hexadecimal
};

/// A sign-off held against the session as it is now.
struct CheckedSignOff {
  SignOff sign_off;
  std::vector<std::string> changed;  ///< since it was signed, one line each; empty while it holds
  [[nodiscard]] bool holds() const { return changed.empty(); }
};

}  // namespace dubsar

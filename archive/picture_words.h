// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

namespace dubsar {

/// What a picture says of itself in its file, so that it is known where it travels alone: UTF-8 that people
/// typed. What is empty is left out.
struct PictureWords {
  std::string title{};        ///< "P123456, obverse, clay"
  std::string description{};  ///< what it shows, lines parted by line feeds
  std::string copyright{};    ///< whose it is, and its licence
};

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "formats/file_label.h"

namespace dubsar {

/// What a picture says of itself in its file, so that it is known where it travels alone: UTF-8 that people
/// typed. What is empty is left out.
struct PictureWords {
  std::string title{};        ///< "P123456, obverse, clay"
  std::string description{};  ///< what it shows, lines parted by line feeds
  std::string copyright{};    ///< whose it is, and its licence
};

/// What the tablet's label says, under a title of the picture's own.
[[nodiscard]] PictureWords picture_words(const FileLabel& label, const std::string& title);

/// As properties of the Dublin Core in RDF/XML: dc:title, dc:description, dc:rights; empty where nothing is
/// said. JPEG and PDF wrap them in XMP, SVG takes them as its metadata.
[[nodiscard]] std::string dublin_core(const PictureWords& words);
/// An rdf:RDF element with them; empty where nothing is said.
[[nodiscard]] std::string rdf_of(const PictureWords& words);

}  // namespace dubsar

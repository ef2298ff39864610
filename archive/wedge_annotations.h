// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "core/wedge.h"

namespace dubsar {

/// What annotations say of themselves.
struct AnnotationSource {
  std::string base_url;    ///< ids and the model's address begin with it; ends with a slash
  std::string page;        ///< the file of the annotations, relative to base_url: ids are addresses in it
  std::string model;       ///< the annotated mesh, relative to base_url; its numbers are millimetres
  std::string identifier;  ///< of the tablet, for people
  std::string program;     ///< "Dubsar 0.1.0"
  std::string when;        ///< ISO 8601
  std::string rights{};    ///< in words; what is no address has no place in an annotation
};

/// The wedges as one W3C AnnotationPage (Web Annotation Data Model, 2017; JSON-LD): the target of each is the
/// triangle of its outer edges on the model, a closed ring as WKT POLYGON Z; its body says in words what
/// was measured.
[[nodiscard]] std::string wedge_annotations(const std::vector<Wedge>& wedges, const AnnotationSource& source);

}  // namespace dubsar

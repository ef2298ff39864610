// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "core/wedge.h"

namespace dubsar {

/// What annotations say of themselves.
struct AnnotationSource {
  std::string base_url;     ///< ids and the model's address begin with it; ends with a slash
  std::string page;         ///< the file of the annotations, relative to base_url: ids are addresses in it
  std::string model;        ///< the annotated mesh, relative to base_url; its numbers are millimetres
  std::string identifier;   ///< of the tablet, for people
  std::string program;      ///< "Dubsar 0.1.0"
  std::string when;         ///< ISO 8601
  std::string rights{};     ///< in words; a W3C annotation has a place for an address in them only
  std::string simulated{};  ///< a sentence, where a program made the tablet up; empty of clay
};

/// "Wedge 7 on the obverse, line 2, number 3: 0.75 mm deep, …": what was measured, for people.
[[nodiscard]] std::string wedge_in_words(const Wedge& wedge);
/// What a page of annotations is called.
[[nodiscard]] std::string label_of_wedges(const AnnotationSource& source);

/// The wedges as one W3C AnnotationPage (Web Annotation Data Model, 2017; JSON-LD): the target of each is the
/// triangle of its outer edges on the model, a closed ring as WKT POLYGON Z; its body says in words what
/// was measured.
[[nodiscard]] std::string wedge_annotations(const std::vector<Wedge>& wedges, const AnnotationSource& source);

}  // namespace dubsar

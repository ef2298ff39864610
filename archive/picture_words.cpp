// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/picture_words.h"

#include "archive/html.h"

namespace dubsar {

namespace {

/// In the language that nobody has said; nothing where the text is empty.
std::string property(const std::string& name, const std::string& text) {
  return text.empty() ? std::string()
                      : "<dc:" + name + "><rdf:Alt><rdf:li xml:lang=\"x-default\">" + html_escaped(text) +
                            "</rdf:li></rdf:Alt></dc:" + name + ">\n";
}

}  // namespace

PictureWords picture_words(const FileLabel& label, const std::string& title) {
  std::string description;
  for (const auto& [name, value] : label.words) {
    description.append(description.empty() ? "" : "\n").append(label_value(name));
    description.append(": ").append(label_value(value));
  }
  return {.title = label_value(title),
          .description = std::move(description),
          .copyright = label_value(label.rights)};
}

std::string dublin_core(const PictureWords& words) {
  return property("title", words.title) + property("description", words.description) +
         property("rights", words.copyright);
}

std::string rdf_of(const PictureWords& words) {
  const std::string said = dublin_core(words);
  return said.empty() ? said
                      : "<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n"
                        "<rdf:Description rdf:about=\"\" xmlns:dc=\"http://purl.org/dc/elements/1.1/\">\n" +
                            said + "</rdf:Description></rdf:RDF>";
}

}  // namespace dubsar

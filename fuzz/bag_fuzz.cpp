// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The text files of a bag. The first byte says which one it is.
#include <algorithm>

#include "formats/bag_text.h"
#include "fuzz/fuzz_support.h"

using namespace dubsar;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  const std::string_view rest = text.substr(std::min<std::size_t>(1, text.size()));
  const auto inside = [](const std::string& path) {
    fuzz::require(!path.empty() && path.front() != '/' && !path.starts_with("../") &&
                  path.find("/../") == std::string::npos && path.find('\0') == std::string::npos);
  };
  switch (text.empty() ? '\0' : text.front()) {
    case 'd':
      (void)parse_bag_declaration(rest, "bagit.txt");
      break;
    case 'f':
      for (const BagDeclaration declaration : {BagDeclaration{1, 0}, BagDeclaration{0, 97}}) {
        if (const auto paths = parse_bag_fetch(rest, declaration, "fetch.txt")) {
          std::ranges::for_each(*paths, inside);
        }
      }
      break;
    case 'o':
      (void)parse_bag_oxum(rest, "bag-info.txt");
      break;
    default:
      for (const BagDeclaration declaration : {BagDeclaration{1, 0}, BagDeclaration{0, 97}}) {
        if (const auto lines = parse_bag_manifest(rest, declaration, "manifest-sha512.txt")) {
          for (const BagManifestLine& line : *lines) {
            inside(line.path);
            fuzz::require(!line.sum.empty());
          }
        }
      }
  }
  return 0;
}

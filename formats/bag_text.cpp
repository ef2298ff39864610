// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// BagIt 1.0: RFC 8493, sections 2.1 and 2.2.
#include "formats/bag_text.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <set>

#include "core/utf8.h"

namespace dubsar {

namespace {

/// Lines end with LF, CR or CRLF.
std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> out;
  while (!text.empty()) {
    const std::size_t end = text.find_first_of("\r\n");
    if (end == std::string_view::npos) {
      out.push_back(text);
      break;
    }
    out.push_back(text.substr(0, end));
    const std::size_t after = text.substr(end, 2) == "\r\n" ? end + 2 : end + 1;
    text.remove_prefix(after);
  }
  return out;
}

bool is_space(char c) {
  return c == ' ' || c == '\t';
}

template <class Number>
bool whole_number(std::string_view text, Number& out) {
  const auto [rest, problem] = std::from_chars(text.data(), text.data() + text.size(), out);
  return !text.empty() && problem == std::errc{} && rest == text.data() + text.size();
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::ranges::transform(out, out.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return out;
}

std::unexpected<Error> bad_line(const std::string& where, std::size_t line, const std::string& what) {
  return bad_input(where, "line " + std::to_string(line + 1) + " " + what,
                   "get the bag again from its source");
}

/// A path inside the bag in its plain form, or nothing where it leads elsewhere.
std::optional<std::string> plain_path(std::string_view encoded, const BagDeclaration& declaration) {
  const std::string decoded = decode_bag_path(encoded, declaration);
  const std::filesystem::path path(decoded);
  if (decoded.empty() || decoded.find('\0') != std::string::npos || decoded.front() == '~' ||
      path.is_absolute() || std::ranges::find(path, std::filesystem::path("..")) != path.end()) {
    return std::nullopt;
  }
  std::string plain = path.lexically_normal().generic_string();
  return plain == "." || plain.ends_with('/') ? std::nullopt : std::optional(std::move(plain));
}

}  // namespace

std::string decode_bag_path(std::string_view text, BagDeclaration declaration) {
  const bool percent = declaration.at_least(1, 0);
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string code = text[i] == '%' ? lower(text.substr(i + 1, 2)) : std::string();
    const char decoded = code == "0a" ? '\n' : code == "0d" ? '\r' : percent && code == "25" ? '%' : '\0';
    if (decoded != '\0') {
      out += decoded;
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

Result<BagDeclaration> parse_bag_declaration(std::string_view text, const std::string& where) {
  if (text.starts_with("\xef\xbb\xbf")) {
    return bad_input(where, "begins with a byte order mark", "get the bag again from its source");
  }
  const std::vector<std::string_view> lines = lines_of(text);
  constexpr std::string_view kVersion = "BagIt-Version: ";
  constexpr std::string_view kEncoding = "Tag-File-Character-Encoding: ";
  BagDeclaration out;
  if (lines.size() != 2 || !lines[0].starts_with(kVersion) || !lines[1].starts_with(kEncoding)) {
    return bad_input(where, "is not the declaration of a bag (BagIt-Version, Tag-File-Character-Encoding)",
                     "get the bag again from its source");
  }
  const std::string_view version = trimmed(lines[0].substr(kVersion.size()));
  const std::size_t point = std::min(version.find('.'), version.size());
  if (!whole_number(version.substr(0, point), out.major) ||
      !whole_number(version.substr(std::min(point + 1, version.size())), out.minor) || out.major < 0 ||
      out.minor < 0) {
    return bad_input(where, "the version of the bag is no version", "get the bag again from its source");
  }
  if (out.major > 1 || (out.major == 1 && out.minor > 0)) {
    return bad_input(where,
                     "a bag of version " + std::string(version) + "; versions up to 1.0 can be checked",
                     "get a newer Dubsar");
  }
  if (lower(trimmed(lines[1].substr(kEncoding.size()))) != "utf-8") {
    return bad_input(where, "its text files are not UTF-8", "have the bag made anew with UTF-8");
  }
  return out;
}

Result<std::vector<BagManifestLine>> parse_bag_manifest(std::string_view text,
                                                        const BagDeclaration& declaration,
                                                        const std::string& where) {
  std::vector<BagManifestLine> out;
  std::set<std::string> seen;
  const std::vector<std::string_view> lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (trimmed(lines[i]).empty()) {
      continue;
    }
    const std::size_t end = std::min(lines[i].find_first_of(" \t"), lines[i].size());
    BagManifestLine line{lower(lines[i].substr(0, end)), {}, i + 1};
    std::string_view path = lines[i].substr(end);
    while (!path.empty() && is_space(path.front())) {
      path.remove_prefix(1);
    }
    // Before 1.0, as md5sum writes it for binary files.
    if (!declaration.at_least(1, 0) && path.starts_with('*')) {
      path.remove_prefix(1);
    }
    const bool digits = !line.sum.empty() && std::ranges::all_of(line.sum, [](char c) {
      return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
    });
    if (!digits || path.empty()) {
      return bad_line(where, i, "is no checksum and path");
    }
    std::optional<std::string> plain = plain_path(path, declaration);
    if (!plain) {
      return bad_line(where, i, "names a place outside the bag: " + std::string(path.substr(0, 80)));
    }
    line.path = std::move(*plain);
    if (!seen.insert(line.path).second) {
      return bad_line(where, i, "names a file for the second time: " + line.path);
    }
    out.push_back(std::move(line));
  }
  return out;
}

Result<std::vector<std::string>> parse_bag_fetch(std::string_view text, const BagDeclaration& declaration,
                                                 const std::string& where) {
  std::vector<std::string> out;
  const std::vector<std::string_view> lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::string_view rest = trimmed(lines[i]);
    if (rest.empty()) {
      continue;
    }
    for (int word = 0; word < 2; ++word) {  // URL and length
      rest = trimmed(rest.substr(std::min(rest.find_first_of(" \t"), rest.size())));
    }
    std::optional<std::string> plain = plain_path(rest, declaration);
    if (!plain || !plain->starts_with("data/")) {
      return bad_line(where, i, "is no URL, length and path under data/");
    }
    out.push_back(std::move(*plain));
  }
  return out;
}

Result<std::optional<BagOxum>> parse_bag_oxum(std::string_view bag_info, const std::string& where) {
  std::optional<BagOxum> out;
  const std::vector<std::string_view> lines = lines_of(bag_info);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t colon = lines[i].find(':');
    if (colon == std::string_view::npos || is_space(lines[i].front()) ||
        lower(trimmed(lines[i].substr(0, colon))) != "payload-oxum") {
      continue;
    }
    const std::string_view value = trimmed(lines[i].substr(colon + 1));
    const std::size_t point = std::min(value.find('.'), value.size());
    BagOxum oxum;
    if (out || !whole_number(value.substr(0, point), oxum.bytes) ||
        !whole_number(value.substr(std::min(point + 1, value.size())), oxum.files)) {
      return bad_line(where, i,
                      out ? "gives Payload-Oxum for the second time" : "gives no Payload-Oxum (bytes.files)");
    }
    out = oxum;
  }
  return out;
}

}  // namespace dubsar

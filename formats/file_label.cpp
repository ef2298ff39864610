// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/file_label.h"

#include <algorithm>

#include "core/utf8.h"

namespace dubsar {

namespace {

constexpr std::string_view kContinued = "+ ";

/// The longest beginning of at most `bytes` that cuts no character apart.
std::string_view whole_characters(std::string_view text, std::size_t bytes) {
  if (text.size() <= bytes) {
    return text;
  }
  while (bytes > 0 && (static_cast<unsigned char>(text[bytes]) & 0xC0U) == 0x80U) {
    --bytes;
  }
  return text.substr(0, bytes);
}

/// Of the next line: up to a blank where there is one, else as much as fits.
std::string_view next_piece(std::string_view text, std::size_t room) {
  const std::string_view piece = whole_characters(text, room);
  const std::size_t blank = piece.size() < text.size() ? piece.rfind(' ') : std::string_view::npos;
  return blank == std::string_view::npos || blank < room / 2 ? piece : piece.substr(0, blank + 1);
}

/// Readers that look for these words anywhere would end the header there, or join the next line to it.
std::string without_commands(std::string text) {
  constexpr std::string_view kEnd = "end_header";
  for (std::size_t at = text.find(kEnd); at != std::string::npos; at = text.find(kEnd)) {
    text[at + 3] = ' ';
  }
  std::ranges::replace(text, '\\', '/');
  return text;
}

std::string in_ascii(std::string_view text) {
  std::string out;
  const std::string utf8 = one_line(text);
  for (std::string_view rest = utf8; !rest.empty();) {
    const CodePoint c = first_code_point(rest);
    constexpr std::uint32_t kCopyright = 0xA9;
    if (c.value == kCopyright) {
      out += "(c)";
    } else {
      out += c.value < 0x80 ? static_cast<char>(c.value) : '?';
    }
    rest.remove_prefix(c.bytes);
  }
  std::ranges::replace(out, '=', ':');  // "COLOR=" tells some readers of STL a colour
  return out;
}

}  // namespace

std::string label_value(std::string_view text) {
  constexpr std::string_view kCut = "…";
  std::string line = one_line(text);
  if (line.size() <= kMaxLabelBytes) {
    return line;
  }
  return std::string(whole_characters(line, kMaxLabelBytes - kCut.size())).append(kCut);
}

std::string label_lines(const FileLabel& label, std::string_view prefix) {
  std::string out;
  for (const auto& [name, value] : label.words) {
    const std::string text = without_commands(label_value(name) + ": " + label_value(value));
    std::string_view rest = text;
    for (bool first = true; first || !rest.empty(); first = false) {
      const std::string_view mark = first ? std::string_view() : kContinued;
      const std::string_view piece = next_piece(rest, kMaxLabelLineBytes - prefix.size() - mark.size() - 1);
      out.append(prefix).append(mark).append(piece).push_back('\n');
      rest.remove_prefix(piece.size());
    }
  }
  return out;
}

std::string mesh_line(const FileLabel& label, std::string_view prefix) {
  const std::string text =
      label.origin.empty() ? std::string(kMeshOfDubsar) : without_commands(label_value(label.origin));
  std::string line(prefix);
  line.append(whole_characters(text, kMaxLabelLineBytes - prefix.size() - 1)).push_back('\n');
  return line;
}

std::string label_in_ascii(const FileLabel& label, std::size_t bytes) {
  std::string out = label.simulated ? "SIMULATED; " : "";
  out += in_ascii(label.name);
  if (!label.rights.empty()) {
    out += (label.name.empty() ? "" : "; ") + in_ascii(label.rights);
  }
  constexpr std::string_view kCut = "...";
  if (out.size() > bytes) {
    out.resize(bytes - std::min(bytes, kCut.size()));
    out += kCut.substr(0, bytes);
  }
  return out;
}

}  // namespace dubsar

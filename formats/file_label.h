// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dubsar {

/// What a mesh or a scan says of itself, so that it is known where it travels without its package: any bytes
/// that people typed. An empty label without an origin changes no file.
struct FileLabel {
  std::string name{};      ///< what the tablet is called: "P123456, BM 12345"
  std::string rights{};    ///< a sentence, or empty
  bool simulated = false;  ///< a program made the tablet up
  std::vector<std::pair<std::string, std::string>>
      words{};  ///< everything, in order: "Collection", "A Museum"
  /// How a mesh came about that Dubsar wrote and did not make: "Converted by Dubsar from a.stl". Else empty.
  std::string origin{};

  [[nodiscard]] bool empty() const { return name.empty() && rights.empty() && !simulated && words.empty(); }
};

/// How the text at the head of a mesh begins that Dubsar made.
inline constexpr std::string_view kMeshOfDubsar = "Mesh of Dubsar";
/// The origin of a mesh that is a picture of another: what it says of itself is what that says.
inline constexpr std::string_view kColouredByDubsar = "Coloured by Dubsar";
/// More of one value than this goes into no file.
inline constexpr std::size_t kMaxLabelBytes = 2000;
/// No line of a header is longer: there are readers that take 256 bytes at most.
inline constexpr std::size_t kMaxLabelLineBytes = 200;

/// UTF-8 without control characters, of at most kMaxLabelBytes; "…" where it was longer.
[[nodiscard]] std::string label_value(std::string_view text);

/// For the header of a text format, each line begun with `prefix` and ended: "comment Rights: …\n". What does
/// not fit goes on in lines whose text begins with "+ ". No line can be taken for anything but a comment.
[[nodiscard]] std::string label_lines(const FileLabel& label, std::string_view prefix);

/// The line that says whose mesh it is, begun with `prefix` and ended: "Mesh of Dubsar" or the origin.
[[nodiscard]] std::string mesh_line(const FileLabel& label, std::string_view prefix);

/// As much as fits into `bytes` of ASCII, what matters most first; other characters are "?".
[[nodiscard]] std::string label_in_ascii(const FileLabel& label, std::size_t bytes);

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/file_label_reader.h"

#include <algorithm>
#include <array>

#include "formats/atomic_file.h"
#include "formats/byte_order.h"
#include "formats/mesh_formats.h"
#include "formats/ply_header.h"
#include "formats/text_scanner.h"

namespace dubsar {

namespace {

using Words = std::vector<std::pair<std::string, std::string>>;

constexpr std::size_t kHeadBytes = std::size_t{1} << 20U;
constexpr const char* kSimulated = "SIMULATED";
constexpr const char* kLabel = "Label";  ///< all that an STL has to say
constexpr const char* kRights = "Rights";
constexpr std::string_view kConverted = "Converted by Dubsar from ";
constexpr std::array kNames = {"CDLI number", "Museum number", "Session",    kLabel,
                               kSimulated,    "Collection",    "Scanned by", kRights};
/// By these a tablet is called; the others are said of it.
constexpr std::size_t kCallNames = 4;

bool is_known(std::string_view name) {
  return std::ranges::any_of(kNames, [&](const char* known) { return name == known; });
}

struct Said {
  bool ours = false;
  Words words{};
};

/// The lines that label_lines() wrote with that prefix, behind the one that says whose file it is, or how
/// Dubsar wrote it.
Said said_in_lines(std::string_view head, std::string_view prefix) {
  Said said;
  TextScanner text(head);
  bool begun = false;
  bool goes_on = false;  // the last line was a word's
  while (text.remaining() > 0) {
    std::string_view line = text.line();
    if (!line.starts_with(prefix)) {
      if (begun) {
        break;  // they stand together
      }
      if (line.starts_with("end_header") || line.starts_with("v ")) {
        break;
      }
      continue;
    }
    line.remove_prefix(prefix.size());
    if (!begun) {
      said.ours = line.starts_with(kMeshOfDubsar) || line.starts_with("Range grid of Dubsar");
      begun = said.ours || line.starts_with(kColouredByDubsar) || line.starts_with(kConverted);
      continue;
    }
    const std::size_t colon = line.find(": ");
    if (line.starts_with("+ ") && goes_on) {
      said.words.back().second.append(line.substr(2));
    } else if (goes_on = colon != std::string_view::npos && is_known(line.substr(0, colon)); goes_on) {
      said.words.emplace_back(line.substr(0, colon), line.substr(colon + 2));
    }
  }
  return said;
}

Words words_in_object(const JsonNode& object) {
  Words words;
  for (const char* name : kNames) {
    if (const auto value = object.find(name)) {
      words.emplace_back(name, value->text());
    }
  }
  return words;
}

Words words_in_glb(std::string_view head) {
  constexpr std::size_t kJsonAt = 20;
  constexpr std::size_t kSizeAt = 12;
  if (head.size() < kJsonAt) {
    return {};
  }
  const std::size_t size = load<std::uint32_t>(head.data() + kSizeAt);
  const auto document = size <= head.size() - kJsonAt
                            ? JsonDocument::parse(head.substr(kJsonAt, size), "GLB")
                            : fail(ErrorKind::kBadInput, "its JSON is longer than what is looked at");
  const auto asset = document ? document->root().find("asset") : std::nullopt;
  const auto generator = asset ? asset->find("generator") : std::nullopt;
  const auto extras = asset ? asset->find("extras") : std::nullopt;
  if (!generator || generator->text() != "Dubsar" || !extras) {
    return {};
  }
  Words words = words_in_object(*extras);
  return document->root().failed() ? Words{} : words;
}

Words words_in_stl(std::string_view head) {
  constexpr std::string_view kOurs = "Dubsar, mm; ";
  constexpr std::string_view kMadeUp = "SIMULATED; ";
  constexpr std::size_t kHeaderBytes = 80;
  std::string_view text = head.substr(0, kHeaderBytes);
  if (!text.starts_with(kOurs)) {
    return {};
  }
  text.remove_prefix(kOurs.size());
  text = text.substr(0, text.find_last_not_of(' ') + 1);
  Words words;
  if (text.starts_with(kMadeUp)) {
    words.emplace_back(kSimulated, "A program made up this tablet.");
    text.remove_prefix(kMadeUp.size());
  }
  words.emplace_back(kLabel, text);
  return words;
}

/// A GLB is known as ours by its words alone.
Said said_in(std::string_view head) {
  if (is_ply(head)) {
    return said_in_lines(head, "comment ");
  }
  if (!is_glb(head) && head.starts_with("# ")) {
    return said_in_lines(head, "# ");
  }
  Said said{.words = is_glb(head) ? words_in_glb(head) : words_in_stl(head)};
  said.ours = !said.words.empty() || head.starts_with(kMeshOfDubsar);
  return said;
}

}  // namespace

FileLabel label_of_words(Words words) {
  FileLabel label;
  const auto value_of = [&](std::string_view name) {
    const auto found = std::ranges::find(words, name, &Words::value_type::first);
    return found == words.end() ? std::string() : found->second;
  };
  for (std::size_t k = 0; k < kCallNames; ++k) {
    if (const std::string value = value_of(kNames[k]); !value.empty()) {
      label.name += (label.name.empty() ? "" : ", ") + value;
    }
  }
  label.rights = value_of(kRights);
  label.simulated = !value_of(kSimulated).empty();
  label.words = std::move(words);
  return label;
}

FileLabel label_in_object(const JsonNode& object) {
  return label_of_words(words_in_object(object));
}

FileLabel file_label_in(std::string_view head) {
  return label_of_words(said_in(head).words);
}

FileLabel read_file_label(const std::filesystem::path& file) {
  const Result<std::string> head = read_file_head(file, kHeadBytes);
  return head ? file_label_in(*head) : FileLabel{};
}

FileLabel read_mesh_label(const std::filesystem::path& file) {
  const Result<std::string> head = read_file_head(file, kHeadBytes);
  Said said = head ? said_in(*head) : Said{};
  FileLabel label = label_of_words(std::move(said.words));
  if (!said.ours) {
    label.origin = std::string(kConverted) + file.filename().string();
  }
  return label;
}

}  // namespace dubsar

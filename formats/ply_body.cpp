// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/ply_body.h"

#include <utility>

namespace dubsar {

namespace {

constexpr const char* kCutShort = "the file is cut short or mislabelled: copy or export it again";

/// The fewest bytes that one instance can take.
std::size_t least_bytes(const PlyElement& element, PlyFormat format) {
  std::size_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    bytes += format == PlyFormat::kAscii ? 2 : size_of(property.count_type.value_or(property.type));
  }
  return bytes;
}

}  // namespace

PlyBody::PlyBody(const PlyHeader& header, std::string_view file, std::string where, const JobContext* job)
    : format_(header.format),
      file_(file),
      where_(std::move(where)),
      job_(job),
      text_(file),
      at_(header.body_offset) {
  text_.seek(header.body_offset);
}

std::size_t PlyBody::remaining() const {
  return format_ == PlyFormat::kAscii ? text_.remaining() : file_.size() - at_;
}

Status PlyBody::check_claim(const PlyElement& element) const {
  if (element.count == 0) {
    return {};
  }
  const std::size_t least = least_bytes(element, format_);
  if (least == 0) {
    return bad_input(where_, "element " + element.name + " has no properties", kCutShort);
  }
  // The last blank of an ASCII file may be missing.
  if (element.count > (remaining() + 1) / least) {
    return bad_input(where_,
                     "claims " + std::to_string(element.count) + " of element " + element.name +
                         ", but only " + std::to_string(remaining()) + " bytes are left for them",
                     kCutShort);
  }
  return {};
}

Status PlyBody::skip(const PlyElement& element) {
  if (format_ != PlyFormat::kAscii && element.first_list() < 0) {
    if (Status claim = check_claim(element); !claim) {
      return claim;
    }
    const std::uint64_t bytes = element.count * least_bytes(element, format_);
    if (bytes > remaining()) {
      return row_error(element, element.count - 1);
    }
    at_ += bytes;
    return {};
  }
  return read(element, [](std::uint64_t, const PlyRow&) { return Status{}; });
}

bool PlyBody::next(const PlyElement& element, PlyRow& row) {
  return format_ == PlyFormat::kAscii ? next_ascii(element, row) : next_binary(element, row);
}

bool PlyBody::next_ascii(const PlyElement& element, PlyRow& row) {
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    if (!element.properties[p].count_type) {
      if (!text_.number(row.values[p])) {
        return false;
      }
      continue;
    }
    std::int64_t length = 0;
    if (!text_.integer(length) || length < 0 ||
        static_cast<std::uint64_t>(length) > (text_.remaining() + 1) / 2) {
      return false;
    }
    row.values[p] = static_cast<double>(length);
    row.lists[p].resize(static_cast<std::size_t>(length));
    for (double& item : row.lists[p]) {
      if (!text_.number(item)) {
        return false;
      }
    }
  }
  return true;
}

bool PlyBody::next_binary(const PlyElement& element, PlyRow& row) {
  const std::endian order = format_ == PlyFormat::kLittleEndian ? std::endian::little : std::endian::big;
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    const PlyProperty& property = element.properties[p];
    const PlyType first = property.count_type.value_or(property.type);
    if (size_of(first) > file_.size() - at_) {
      return false;
    }
    row.values[p] = load_as_double(file_.data() + at_, first, order);
    at_ += size_of(first);
    if (!property.count_type) {
      continue;
    }
    const std::size_t item_bytes = size_of(property.type);
    const std::size_t most_items = (file_.size() - at_) / item_bytes;
    if (row.values[p] < 0 || row.values[p] > static_cast<double>(most_items)) {
      return false;
    }
    row.lists[p].resize(static_cast<std::size_t>(row.values[p]));
    for (double& item : row.lists[p]) {
      item = load_as_double(file_.data() + at_, property.type, order);
      at_ += item_bytes;
    }
  }
  return true;
}

std::unexpected<Error> PlyBody::error_at(const PlyElement& element, std::uint64_t index,
                                         const std::string& what, const std::string& mend) const {
  std::string place = element.name + " " + std::to_string(index);
  if (format_ == PlyFormat::kAscii) {
    place += " (line " + std::to_string(text_.line_number()) + ")";
  }
  return bad_input(where_, place + ": " + what, mend);
}

std::unexpected<Error> PlyBody::row_error(const PlyElement& element, std::uint64_t index) {
  if (format_ == PlyFormat::kAscii) {
    if (const std::string word = text_.word_here(); !word.empty()) {
      return error_at(element, index, in_quotes(word) + " is not what belongs here", "export it again");
    }
  }
  return bad_input(
      where_,
      "ends within " + element.name + " " + std::to_string(index) + " of " + std::to_string(element.count),
      kCutShort);
}

}  // namespace dubsar

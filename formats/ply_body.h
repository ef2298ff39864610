// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/job.h"
#include "core/result.h"
#include "formats/byte_order.h"
#include "formats/ply_header.h"
#include "formats/text_scanner.h"

namespace dubsar {

/// The number at `from`, which need not be aligned.
[[nodiscard]] inline double load_as_double(const char* from, PlyType type, std::endian order) {
  switch (type) {
    case PlyType::kInt8:
      return load<std::int8_t>(from, order);
    case PlyType::kUint8:
      return load<std::uint8_t>(from, order);
    case PlyType::kInt16:
      return load<std::int16_t>(from, order);
    case PlyType::kUint16:
      return load<std::uint16_t>(from, order);
    case PlyType::kInt32:
      return load<std::int32_t>(from, order);
    case PlyType::kUint32:
      return load<std::uint32_t>(from, order);
    case PlyType::kFloat32:
      return static_cast<double>(load<float>(from, order));
    case PlyType::kFloat64:
      break;
  }
  return load<double>(from, order);
}

/// One instance of an element while it is read.
struct PlyRow {
  std::vector<double> values;              ///< [properties]; for a list its length
  std::vector<std::vector<double>> lists;  ///< [properties], empty for scalars

  /// The scalar at `property`, or `otherwise` when there is none (-1).
  [[nodiscard]] double value(int property, double otherwise = 0.0) const {
    return property < 0 ? otherwise : values[static_cast<std::size_t>(property)];
  }
};

/// Reads the elements of a PLY file in the order of its header, ASCII or binary of either byte order. Takes
/// no more memory than a fixed multiple of the bytes that are there, whatever the header claims.
class PlyBody {
 public:
  /// `file` is the whole file; both it and the header must outlive this. read() ends with kCancelled soon
  /// after the job is cancelled.
  PlyBody(const PlyHeader& header, std::string_view file, std::string where, const JobContext* job = nullptr);

  /// Calls visit(index, row) -> Status for each instance of the next element. Elements must be read (or
  /// skipped) in header order.
  template <class Visit>
  [[nodiscard]] Status read(const PlyElement& element, const Visit& visit) {
    if (Status claim = check_claim(element); !claim) {
      return claim;
    }
    PlyRow row;
    row.values.resize(element.properties.size());
    row.lists.resize(element.properties.size());
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (i % kAskEvery == 0 && job_ != nullptr && job_->cancelled()) {
        return fail(ErrorKind::kCancelled, "reading was stopped", where_);
      }
      if (!next(element, row)) {
        return row_error(element, i);
      }
      if (Status seen = visit(i, std::as_const(row)); !seen) {
        return seen;
      }
    }
    return {};
  }
  [[nodiscard]] Status skip(const PlyElement& element);

  /// The next `bytes` bytes of a binary file, for a reader that takes many instances at once; empty where the
  /// file is none or holds fewer.
  [[nodiscard]] std::string_view ahead(std::uint64_t bytes) const {
    return format_ == PlyFormat::kAscii || bytes > file_.size() - at_
               ? std::string_view()
               : file_.substr(at_, static_cast<std::size_t>(bytes));
  }
  [[nodiscard]] std::endian byte_order() const {
    return format_ == PlyFormat::kBigEndian ? std::endian::big : std::endian::little;
  }
  void pass(std::string_view read) { at_ += read.size(); }
  /// What was not read or skipped.
  [[nodiscard]] std::string_view rest() const { return file_.substr(file_.size() - remaining()); }

  /// An error at an instance of the element that was just read: "vertex 12 (line 34): what".
  [[nodiscard]] std::unexpected<Error> error_at(const PlyElement& element, std::uint64_t index,
                                                const std::string& what, const std::string& mend) const;

  /// An element may not claim more instances than its bytes can hold.
  [[nodiscard]] Status check_claim(const PlyElement& element) const;

 private:
  [[nodiscard]] bool next(const PlyElement& element, PlyRow& row);
  [[nodiscard]] bool next_ascii(const PlyElement& element, PlyRow& row);
  [[nodiscard]] bool next_binary(const PlyElement& element, PlyRow& row);
  [[nodiscard]] std::unexpected<Error> row_error(const PlyElement& element, std::uint64_t index);
  [[nodiscard]] std::size_t remaining() const;

  static constexpr std::uint64_t kAskEvery = 4096;  ///< instances
  PlyFormat format_;
  std::string_view file_;
  std::string where_;
  const JobContext* job_;
  TextScanner text_;    ///< over the whole file, so that line numbers are the file's
  std::size_t at_ = 0;  ///< of the next byte, binary
};

}  // namespace dubsar

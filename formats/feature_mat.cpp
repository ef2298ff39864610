// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/feature_mat.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "formats/atomic_file.h"

namespace dubsar {
namespace {

constexpr std::size_t kVerticesAPart = 1U << 14U;
constexpr std::size_t kPartsAtOnce = 16;

template <class... Form>
void append(std::string& text, Form... form) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, form...);
  text.append(digits, end.ptr);
}

std::string lines(std::span<const float> value, std::size_t per_vertex, std::size_t begin, std::size_t end) {
  std::string text;
  text.reserve((end - begin) * (9 + per_vertex * 11));
  for (std::size_t v = begin; v < end; ++v) {
    append(text, v);
    for (std::size_t k = 0; k < per_vertex; ++k) {
      const float f = value[v * per_vertex + k];
      text.push_back(' ');
      append(text, std::isfinite(f) ? f : 0.0F, std::chars_format::general, 6);
    }
    text.push_back('\n');
  }
  return text;
}

std::string commented(std::string_view comment) {
  std::string text;
  while (!comment.empty()) {
    const std::size_t end = std::min(comment.find('\n'), comment.size());
    text.append("# ").append(comment.substr(0, end)).push_back('\n');
    comment.remove_prefix(std::min(end + 1, comment.size()));
  }
  return text;
}

}  // namespace

Status write_feature_mat(const std::filesystem::path& path, std::span<const float> value,
                         std::size_t per_vertex, std::string_view comment) {
  if (per_vertex == 0 || value.size() % per_vertex != 0) {
    return fail(ErrorKind::kInternal, "values do not come in whole vertices", path.string());
  }
  const std::size_t vertices = value.size() / per_vertex;
  return write_file_atomically(path, [&](const ByteSink& sink) -> Status {
    const auto put = [&](const std::string& text) { return sink(std::as_bytes(std::span(text))); };
    if (const Status written = put(commented(comment)); !written) {
      return written;
    }
    for (std::size_t first = 0; first < vertices; first += kVerticesAPart * kPartsAtOnce) {
      const std::size_t count = std::min(kVerticesAPart * kPartsAtOnce, vertices - first);
      std::vector<std::string> parts((count + kVerticesAPart - 1) / kVerticesAPart);
      parallel_chunks(count, kVerticesAPart, [&](std::size_t begin, std::size_t end) {
        parts[begin / kVerticesAPart] = lines(value, per_vertex, first + begin, first + end);
      });
      for (const std::string& part : parts) {
        if (const Status written = put(part); !written) {
          return written;
        }
      }
    }
    return {};
  });
}

}  // namespace dubsar

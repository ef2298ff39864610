// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Desktops know files without a name by how they begin: what they are told (packaging/dubsar-mime.xml) is how
// the program begins them.

#include <fstream>
#include <iterator>

#include "build_paths.h"
#include "formats/grid_file.h"
#include "formats/search_index.h"
#include "tests/formats/format_support.h"

namespace dubsar {
namespace {

/// With the escapes of the file ("\x89", "\r", "\n") as the bytes that they stand for.
std::string bytes_meant(std::string_view value) {
  std::string out;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (value[i] != '\\') {
      out += value[i];
    } else if (value[++i] == 'x') {
      out += static_cast<char>(std::stoi(std::string(value.substr(i + 1, 2)), nullptr, 16));
      i += 2;
    } else {
      out += value[i] == 'r' ? '\r' : '\n';
    }
  }
  return out;
}

/// How a file of that type begins; empty where nothing is said.
std::string told_beginning(const std::string& type) {
  std::ifstream file(DUBSAR_SOURCE_DIR "/packaging/dubsar-mime.xml");
  const std::string all{std::istreambuf_iterator<char>(file), {}};
  const std::size_t begin = all.find("<mime-type type=\"" + type + "\">");
  if (begin == std::string::npos) {
    return {};
  }
  const std::string one = all.substr(begin, all.find("</mime-type>", begin) - begin);
  const std::string mark = "offset=\"0\" value=\"";
  const std::size_t at = one.find(mark);
  return at == std::string::npos
             ? std::string()
             : bytes_meant(one.substr(at + mark.size(), one.find('"', at + mark.size()) - at - mark.size()));
}

TEST(MimeTypes, AreKnownByHowTheProgramBeginsTheirFiles) {
  const std::vector<std::byte> grid = encode_grid(testing::sample_grid(3, 4, false));
  EXPECT_EQ(told_beginning("application/x-dubsar-grid"),
            std::string(reinterpret_cast<const char*>(grid.data()), kGridMagic.size()));
  EXPECT_EQ(told_beginning("application/x-dubsar-search-index"), search_index_to_bytes({}).substr(0, 8));
}

}  // namespace
}  // namespace dubsar

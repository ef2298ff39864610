// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/scan_folder.h"

#include <filesystem>

#include "formats/atomic_file.h"
#include "formats/grid_file.h"
#include "formats/grid_reader.h"

#include "tests/formats/format_support.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::line_of;
using testing::ScratchFolder;

std::string points(std::size_t count) {
  std::string text;
  for (std::size_t k = 0; k < count; ++k) {
    text += std::to_string(k) + " 2.5 3\n";
  }
  return text;
}

std::vector<std::string> names_of(const std::vector<fs::path>& paths) {
  std::vector<std::string> names;
  for (const fs::path& path : paths) {
    names.push_back(path.filename().string());
  }
  return names;
}

class ScanFolderTest : public ::testing::Test {
 protected:
  void write(const char* name, const std::string& bytes) {
    ASSERT_TRUE(write_file_atomically(folder_ / name, bytes));
  }
  ScanFolder look() {
    auto found = look_into_folder(folder_ / ".");
    EXPECT_TRUE(found);
    return found ? *found : ScanFolder{};
  }
  ScratchFolder folder_;
};

TEST_F(ScanFolderTest, WhatCannotBeReadIsCountedAmongTheScans) {
  RangeGrid grid;
  grid.allocate(2, 2);
  ASSERT_TRUE(write_grid_file(folder_ / "a.grid", grid));
  std::string damaged = *read_whole_file(folder_ / "a.grid");
  damaged[0] = static_cast<char>(damaged[0] ^ 1);
  write("b.grid", damaged);
  write("c.ptx", "");
  write("d.xyz", "");
  write("e.xyz", "<html>404 not found</html>");
  write("f.ply", "PK\x03\x04 not a ply at all");
  write("g.pts", "\n\n");
  fs::create_symlink("gone.ply", folder_ / "h.ply");
  write("i.ptx", "words");
  EXPECT_THAT(names_of(look().scans),
              ElementsAre("a.grid", "b.grid", "c.ptx", "d.xyz", "e.xyz", "f.ply", "g.pts", "h.ply", "i.ptx"));
  for (const fs::path& scan : look().scans) {
    EXPECT_EQ(read_scan_file(scan).has_value(), scan.filename() == "a.grid") << scan;
  }
  EXPECT_THAT(line_of(read_scan_file(folder_ / "h.ply")),
              HasSubstr("h.ply: a link to a file that is not there; copy the file itself here"));
}

TEST_F(ScanFolderTest, OtherFilesAreLeftAlone) {
  write("notes.txt", "Scanned on a Monday.\nTen scans.\n");
  write("empty.txt", "");
  write("scans.conf", "bmesh a.ply 0 0 0 0 0 0 1\n");
  write("a.ply.asc", "-----BEGIN PGP SIGNATURE-----\niQIz\n");
  write("picture.jpg", "");
  write(".hidden.ply", "");
  write("mesh.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  fs::create_symlink("gone.jpg", folder_ / "link.jpg");
  fs::create_directory(folder_ / "folder.ply");
  const ScanFolder found = look();
  EXPECT_THAT(names_of(found.scans), IsEmpty());
  EXPECT_THAT(names_of(found.subfolders), ElementsAre("folder.ply"));
  EXPECT_EQ(found.other_files, 6U);
  EXPECT_EQ(found.passed_over(), "");
}

TEST_F(ScanFolderTest, TextOfFewPointsIsPassedOverAndSaid) {
  write("camera.txt", "1200 640 480\n");
  write("pose.xyz", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  write("scan.txt", "x y z\n" + points(kLeastPointLines));
  write("short.asc", points(kLeastPointLines - 1));
  const ScanFolder found = look();
  EXPECT_THAT(names_of(found.scans), ElementsAre("scan.txt"));
  EXPECT_THAT(names_of(found.few_points), ElementsAre("camera.txt", "pose.xyz", "short.asc"));
  EXPECT_THAT(found.passed_over(),
              HasSubstr("hardly a scan: camera.txt, pose.xyz, short.asc; name such a file"));
  EXPECT_FALSE(looks_like_scan(folder_ / "camera.txt"));
  EXPECT_EQ(count_scans(folder_ / "camera.txt").value(), 1) << "named itself";
}

TEST_F(ScanFolderTest, AnEmptyTxtCountsBesideOthersThatAreScans) {
  write("b.txt", "");
  EXPECT_THAT(look().scans, IsEmpty());
  write("a.txt", points(kLeastPointLines));
  EXPECT_THAT(names_of(look().scans), ElementsAre("a.txt", "b.txt"));
}

TEST_F(ScanFolderTest, ALargeFileOfPointsThatBreaksOffIsDamaged) {
  const std::string garbage(std::size_t{1} << 17U, '!');
  write("a.xyz", points(40) + garbage);
  write("log.txt", "2025 11 27\n" + garbage);
  const ScanFolder found = look();
  EXPECT_THAT(names_of(found.scans), ElementsAre("a.xyz"));
  EXPECT_THAT(names_of(found.few_points), ElementsAre("log.txt"));
}

TEST_F(ScanFolderTest, TablesAndArchivesAreNoted) {
  write("a.csv", "1,2,3\n");
  write("b.ply.gz", "\x1f\x8b");
  EXPECT_TRUE(look().tables);
  EXPECT_TRUE(look().packed);
  EXPECT_FALSE(look_into_folder(folder_ / "nowhere"));
}

TEST(ScanFiles, ProseIsNoScan) {
  const ScratchFolder folder;
  ASSERT_TRUE(write_file_atomically(folder / "notes.txt", "Scanned on a Monday.\nTen scans.\n"));
  ASSERT_TRUE(write_file_atomically(folder / "a.asc", "\xEF\xBB\xBF" + points(kLeastPointLines)));
  std::string report;  // a table far down in a text
  for (int line = 0; line < 80; ++line) {
    report += "A word of the report.\n";
  }
  ASSERT_TRUE(write_file_atomically(folder / "report.txt", report + points(kLeastPointLines)));
  EXPECT_FALSE(looks_like_scan(folder / "report.txt"));
  EXPECT_FALSE(looks_like_scan(folder / "notes.txt"));
  EXPECT_TRUE(looks_like_scan(folder / "a.asc"));
  EXPECT_FALSE(looks_like_scan(folder / "none.ply"));
  EXPECT_THAT(line_of(count_scans(folder / "notes.txt")), HasSubstr("not a scan"));
}

TEST(ScanFiles, AGarbledPlyIsNotTakenForSomethingElse) {
  const ScratchFolder folder;
  for (const char* bytes : {"", "ply\nformat ascii 1.0\nelement ver", "PK\x03\x04 not a ply at all"}) {
    ASSERT_TRUE(write_file_atomically(folder / "scan.ply", bytes));
    EXPECT_TRUE(looks_like_scan(folder / "scan.ply")) << bytes;
    EXPECT_FALSE(read_scan_file(folder / "scan.ply")) << bytes;
  }
  ASSERT_TRUE(write_file_atomically(folder / "mesh.ply",
                                    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                                    "property float y\nproperty float z\nelement face 1\n"
                                    "property list uchar int vertex_indices\nend_header\n"
                                    "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
  EXPECT_FALSE(looks_like_scan(folder / "mesh.ply"));
}

}  // namespace
}  // namespace dubsar

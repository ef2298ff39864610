// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/loader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/xattr.h>
#include <unistd.h>

#include <fstream>

#include "build_paths.h"
#include "drivers/driver.h"
#include "drivers/trust.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const fs::path kPlugins = fs::path(DUBSAR_BINARY_DIR) / "lib/dubsar/test_drivers";

std::string line_about(const DriverRegistry& registry, const std::string& file) {
  for (const Error& error : registry.rejected()) {
    if (fs::path(error.where).filename() == file) {
      return error.line();
    }
  }
  return {};
}

TEST(Loader, LoadsADriverWrittenInC) {
  const DriverRegistry registry({kPlugins / "good"});
  ASSERT_EQ(registry.drivers().size(), 1U);
  EXPECT_TRUE(registry.rejected().empty());
  const Driver& driver = registry.drivers().front();
  EXPECT_EQ(driver.scheme(), "odd");
  EXPECT_EQ(driver.description(), "a driver for tests");
  const auto options = driver.options();
  ASSERT_TRUE(options);
  ASSERT_EQ(options->size(), 1U);
  EXPECT_EQ(options->front().key, "mode");
  EXPECT_EQ(options->front().type, SettingType::kChoice);
  EXPECT_EQ(options->front().choices.size(), 16U);
  EXPECT_FALSE(options->front().range);
  const auto found = driver.discover();
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 1U);
  EXPECT_EQ(found->front().uri, "odd:1");
}

TEST(Loader, RejectsEachBadLibraryWithOneLineAndGoesOn) {
  test::TemporaryFolder folder;
  for (const fs::path& file :
       {kPlugins / "bad/wrong_abi.so", kPlugins / "bad/small_struct.so", kPlugins / "bad/hollow.so",
        kPlugins / "bad/no_symbol.so", kPlugins / "good/odd.so"}) {
    fs::copy_file(file, folder.path() / file.filename());
  }
  std::ofstream(folder.path() / "text.so") << "This is no library.\n";
  std::ofstream(folder.path() / "notes.txt") << "Not looked at.\n";
  const DriverRegistry registry({folder.path()});
  ASSERT_EQ(registry.drivers().size(), 1U);
  EXPECT_EQ(registry.rejected().size(), 5U);
  EXPECT_THAT(line_about(registry, "wrong_abi.so"), HasSubstr("version 42"));
  EXPECT_THAT(line_about(registry, "wrong_abi.so"), HasSubstr("newer Dubsar"));
  EXPECT_THAT(line_about(registry, "small_struct.so"), HasSubstr("24 bytes"));
  EXPECT_THAT(line_about(registry, "hollow.so"), HasSubstr("lacks a function"));
  EXPECT_THAT(line_about(registry, "no_symbol.so"), HasSubstr("not a Dubsar driver"));
  EXPECT_THAT(line_about(registry, "text.so"), HasSubstr("cannot be loaded"));
  for (const Error& error : registry.rejected()) {
    EXPECT_THAT(error.line(), Not(HasSubstr("\n")));
  }
}

TEST(Loader, LeavesOutWhatEverybodyMayWriteTo) {
  test::TemporaryFolder folder;
  fs::copy_file(kPlugins / "good/odd.so", folder.path() / "odd.so");
  fs::permissions(folder.path() / "odd.so", fs::perms::others_write, fs::perm_options::add);
  const DriverRegistry writable_file({folder.path()});
  EXPECT_TRUE(writable_file.drivers().empty());
  EXPECT_THAT(line_about(writable_file, "odd.so"), HasSubstr("everybody may write"));

  fs::permissions(folder.path() / "odd.so", fs::perms::others_write, fs::perm_options::remove);
  EXPECT_EQ(DriverRegistry({folder.path()}).drivers().size(), 1U);
  fs::permissions(folder.path(), fs::perms::others_write, fs::perm_options::add);
  EXPECT_TRUE(DriverRegistry({folder.path()}).drivers().empty());
}

TEST(Loader, TrustsWhatOnlyTheUserAndRootCanChange) {
  test::TemporaryFolder folder;
  const fs::path real = folder.path() / "real";
  const fs::path linked = folder.path() / "linked";
  fs::create_directories(real);
  fs::create_directories(linked);
  fs::copy_file(kPlugins / "good/odd.so", real / "odd.so");
  fs::create_symlink(real / "odd.so", linked / "odd.so");
  const uid_t me = ::geteuid();
  EXPECT_EQ(trusted_file(linked / "odd.so", me).value(), fs::canonical(real / "odd.so"));

  // What a link leads to counts, not what the link lies in.
  fs::permissions(real, fs::perms::others_write, fs::perm_options::add);
  EXPECT_THAT(trusted_file(linked / "odd.so", me).error().line(), HasSubstr("everybody may write to"));
  EXPECT_TRUE(DriverRegistry({linked}).drivers().empty());
  fs::permissions(real, fs::perms::others_write, fs::perm_options::remove);

  // A folder further up: its sticky bit is as good, as in /tmp.
  fs::permissions(folder.path(), fs::perms(0777));
  EXPECT_FALSE(trusted_file(real / "odd.so", me));
  fs::permissions(folder.path(), fs::perms(01777));
  EXPECT_TRUE(trusted_file(real / "odd.so", me));

  // One that a group may write to, without it: a member could put another folder in its place.
  if (me == 0) {
    fs::permissions(folder.path(), fs::perms(0775));
    ASSERT_EQ(::chown(folder.path().c_str(), 0, 4242), 0);
    EXPECT_THAT(trusted_file(real / "odd.so", me).error().line(), HasSubstr("a group (4242) may write to"));
    fs::permissions(folder.path(), fs::perms(01775));
    EXPECT_TRUE(trusted_file(real / "odd.so", me));
    ASSERT_EQ(::chown(folder.path().c_str(), 0, 0), 0);
  }
  fs::permissions(folder.path(), fs::perms(0755));

  // Whom an access list names the mode does not tell: here user 4242, to read and write.
  constexpr unsigned char kList[] = {2,  0, 0, 0,                           // version
                                     1,  0, 6, 0, 0xff, 0xff, 0xff, 0xff,   // owner
                                     2,  0, 6, 0, 0x92, 0x10, 0,    0,      // 4242
                                     4,  0, 4, 0, 0xff, 0xff, 0xff, 0xff,   // group
                                     16, 0, 6, 0, 0xff, 0xff, 0xff, 0xff,   // mask
                                     32, 0, 4, 0, 0xff, 0xff, 0xff, 0xff};  // others
  if (::setxattr((real / "odd.so").c_str(), "system.posix_acl_access", kList, sizeof kList, 0) == 0) {
    EXPECT_THAT(trusted_file(real / "odd.so", me).error().line(), HasSubstr("an access list"));
    ASSERT_EQ(::removexattr((real / "odd.so").c_str(), "system.posix_acl_access"), 0);
    fs::permissions(real / "odd.so", fs::perms::group_write, fs::perm_options::remove);
    EXPECT_TRUE(trusted_file(real / "odd.so", me));
  }

  if (me == 0) {
    ASSERT_EQ(::chown((real / "odd.so").c_str(), 4242, 0), 0);
    EXPECT_THAT(trusted_file(real / "odd.so", me).error().line(), HasSubstr("another user (4242) owns it"));
    EXPECT_TRUE(trusted_file(real / "odd.so", 4242)) << "the user's own";
    ASSERT_EQ(::chown((real / "odd.so").c_str(), 0, 4242), 0);
    fs::permissions(real / "odd.so", fs::perms::group_write, fs::perm_options::add);
    EXPECT_THAT(trusted_file(real / "odd.so", me).error().line(),
                HasSubstr("a group (4242) may write to it"));
    EXPECT_THAT(line_about(DriverRegistry({real}), "odd.so"), HasSubstr("chmod g-w"));
  } else {
    EXPECT_THAT(trusted_file(real / "odd.so", me + 1).error().line(), HasSubstr("another user"));
  }
}

TEST(Loader, TheFirstOfTwoDriversForOneSchemeWins) {
  test::TemporaryFolder folder;
  fs::copy_file(kPlugins / "good/odd.so", folder.path() / "odd_too.so");
  const DriverRegistry registry({kPlugins / "good", kPlugins / "missing", folder.path(), kPlugins / "good"});
  ASSERT_EQ(registry.drivers().size(), 1U);
  EXPECT_EQ(registry.drivers().front().path().filename(), "odd.so");
  EXPECT_EQ(registry.rejected().size(), 1U);
  EXPECT_THAT(line_about(registry, "odd_too.so"), HasSubstr("there already"));
}

TEST(Loader, TheSearchPathHasTheEnvironmentFirst) {
  ::setenv("DUBSAR_DRIVER_PATH", "/one::/two", 1);
  ::setenv("XDG_DATA_HOME", "/data", 1);
  const auto path = DriverRegistry::default_search_path();
  ::unsetenv("DUBSAR_DRIVER_PATH");
  ::unsetenv("XDG_DATA_HOME");
  EXPECT_THAT(path, ElementsAre(fs::path("/one"), fs::path("/two"),
                                fs::path(DUBSAR_BINARY_DIR) / "lib/dubsar/drivers",
                                fs::path("/data/dubsar/drivers")));
}

TEST(Loader, NamesTheSchemesAndOptionsThatThereAre) {
  const DriverRegistry registry({kPlugins / "good"});
  const auto none = registry.find("even");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(none.error().line(), HasSubstr("odd:"));
  const auto driver = registry.find("odd");
  ASSERT_TRUE(driver);
  const auto device = (*driver)->open("1", {{"speed", "9"}});
  ASSERT_FALSE(device);
  EXPECT_EQ(device.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(device.error().line(), HasSubstr("takes mode"));
  const auto gone = (*driver)->open("gone", {});
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().kind, ErrorKind::kDevice);
  EXPECT_EQ(gone.error().line(), "odd:gone: no such device; plug it in");

  const DriverRegistry empty(std::vector<fs::path>{kPlugins / "missing"});
  EXPECT_THAT(empty.find("sim").error().line(), HasSubstr("DUBSAR_DRIVER_PATH"));
}

}  // namespace
}  // namespace dubsar

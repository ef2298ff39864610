// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar export where a package lies already: nothing is replaced unasked, and nothing of others is lost.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "formats/sha2.h"
#include "tests/station/support/exported.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::files_below;
using test::Outcome;
using test::run_command;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

TEST_F(Export, NeverOverwritesUnasked) {
  const Outcome refused = export_to("bag", {});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.complaints(), SizeIs(1));
  EXPECT_THAT(refused.err, HasSubstr("--force"));

  fs::create_directories(at("precious"));
  std::ofstream(at("precious") / "thesis.txt") << "all of it";
  const Outcome precious = export_to("precious", {});
  EXPECT_EQ(precious.status, 2);
  EXPECT_THAT(precious.err, Not(HasSubstr("--force"))) << "which would not do it";
  EXPECT_EQ(export_to("precious", {"--force"}).status, 2) << "that is no package";
  EXPECT_EQ(bytes_of(at("precious") / "thesis.txt"), "all of it");

  fs::create_symlink("nowhere", at("dangling"));
  const Outcome dangling = export_to("dangling", {});
  EXPECT_EQ(dangling.status, 2);
  EXPECT_THAT(dangling.err, AllOf(HasSubstr("a link to what is not there"), Not(HasSubstr("--force"))));

  const std::vector<std::string> small{"--without", "renderings,features,wedges,grid-ply"};
  ASSERT_EQ(export_to("twice", small).status, 0);
  std::ofstream(at("twice") / "data" / "left.txt") << "of the first";
  std::vector<std::string> forced = small;
  forced.emplace_back("--force");
  ASSERT_EQ(export_to("twice", forced).status, 0);
  EXPECT_FALSE(fs::exists(at("twice") / "data" / "left.txt"));
}

TEST_F(Export, SaysWhatLiesThereAndWhatIsToBeDone) {
  const fs::path session = at("told");
  const fs::path bag = at("told_bag");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  const auto again = [&] {
    return run_command({"export", session.string(), "--to", bag.string(), "--without",
                        "renderings,features,wedges,grid-ply"});
  };
  ASSERT_EQ(again().status, 0);
  ASSERT_EQ(run_command({"session", "describe", session.string(), "--notes", "later"}).status, 0);
  const Outcome earlier = again();
  EXPECT_EQ(earlier.status, 2);
  EXPECT_THAT(earlier.complaints(), SizeIs(1));
  EXPECT_THAT(earlier.err, HasSubstr("a package of this session, of an earlier state"));
  EXPECT_THAT(earlier.err, HasSubstr("--update"));
  std::ofstream(bag / "data/README.txt", std::ios::app) << "x";
  const Outcome damaged = again();
  EXPECT_EQ(damaged.status, 2);
  EXPECT_THAT(damaged.complaints(), SizeIs(1));
  EXPECT_THAT(damaged.err, HasSubstr("is not what was written (data/README.txt: "));
  fs::remove(at("told_bag.done"));
  const Outcome both = again();
  EXPECT_THAT(both.err, HasSubstr("is not what was written (data/README.txt: "));
  fs::remove_all(bag);
  ASSERT_EQ(again().status, 0);
  fs::remove(at("told_bag.done"));
  const Outcome unstamped = again();
  EXPECT_EQ(unstamped.status, 2);
  EXPECT_THAT(unstamped.err, HasSubstr("without the stamp that belongs to it"));
}

TEST_F(Export, KeepsWhatOthersPutIntoThePackageThatItReplaces) {
  const std::vector<std::string> small{"--without", "renderings,features,wedges,grid-ply"};
  std::vector<std::string> forced = small;
  forced.emplace_back("--force");
  const fs::path bag = at("lent");
  ASSERT_EQ(export_to("lent", small).status, 0);
  const Outcome nothing = export_to("lent", forced);
  ASSERT_EQ(nothing.status, 0) << nothing.err;
  EXPECT_FALSE(nothing.json().contains("kept")) << nothing.out;
  EXPECT_FALSE(fs::exists(at("lent.kept-1"))) << "the package's own files are not";
  std::ofstream(bag / "data/notes.txt") << "of a curator";
  std::ofstream(bag / "letter.txt") << "beside the payload";
  std::ofstream(bag / "tagmanifest-notes.txt") << "named as if it were a manifest";
  std::ofstream(bag / "tagmanifest-md5.txt") << "of a program that knows no other";
  fs::create_directories(bag / "data/photos");
  std::ofstream(bag / "data/photos/one.jpg") << "a photograph";
  fs::create_symlink("/nowhere", bag / "data/photos/link");
  std::ofstream(bag / "data/README.txt", std::ios::app) << "a remark of mine";
  const std::string remarked = bytes_of(bag / "data/README.txt");
  const Outcome replaced = export_to("lent", forced);
  ASSERT_EQ(replaced.status, 0) << replaced.err;
  const fs::path kept = at("lent.kept-1");
  EXPECT_THAT(replaced.complaints(), SizeIs(1));
  EXPECT_THAT(replaced.err, HasSubstr(kept.string()));
  EXPECT_EQ(replaced.json()["kept"]["folder"], kept.string());
  EXPECT_EQ(replaced.json()["kept"]["files"], 7);
  EXPECT_THAT(files_below(kept), ElementsAre("data/README.txt", "data/notes.txt", "data/photos/one.jpg",
                                             "letter.txt", "tagmanifest-md5.txt", "tagmanifest-notes.txt"));
  EXPECT_EQ(fs::read_symlink(kept / "data/photos/link"), "/nowhere");
  EXPECT_EQ(bytes_of(kept / "data/notes.txt"), "of a curator");
  EXPECT_EQ(bytes_of(kept / "data/README.txt"), remarked);
  EXPECT_EQ(run_command({"verify", bag.string()}).status, 0);
  EXPECT_FALSE(fs::exists(bag / "letter.txt"));
  std::ofstream(bag / "letter.txt") << "another";
  ASSERT_EQ(export_to("lent", forced).status, 0);
  EXPECT_EQ(bytes_of(at("lent.kept-2") / "letter.txt"), "another");
  EXPECT_EQ(bytes_of(kept / "letter.txt"), "beside the payload");
}

/// The lines of a manifest over files below `folder`.
std::string manifest_of(const fs::path& bag, const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += sha512_hex(bytes_of(bag / name)) + "  " + name + "\n";
  }
  return text;
}

/// As programs for bags do it after files were added: manifests and Payload-Oxum say what is there.
void bag_anew(const fs::path& bag) {
  std::uintmax_t bytes = 0;
  std::vector<std::string> payload = files_below(bag / "data");
  for (std::string& name : payload) {
    name.insert(0, "data/");
    bytes += fs::file_size(bag / name);
  }
  std::string info = bytes_of(bag / "bag-info.txt");
  const std::size_t at = info.find("Payload-Oxum: ");
  info.replace(at, info.find('\n', at) - at,
               "Payload-Oxum: " + std::to_string(bytes) + "." + std::to_string(payload.size()));
  std::ofstream(bag / "bag-info.txt") << info;
  std::ofstream(bag / "manifest-sha512.txt") << manifest_of(bag, payload);
  std::ofstream(bag / "tagmanifest-sha512.txt")
      << manifest_of(bag, {"bag-info.txt", "bagit.txt", "manifest-sha512.txt"});
}

TEST_F(Export, KeepsWhatAnArchivistAddedAsTheStandardHasIt) {
  const fs::path session = at("conserved");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  const fs::path bag = at("catalogued");
  const auto export_with = [&](const char* option) {
    return run_command({"export", session.string(), "--to", bag.string(), option, "--without",
                        "renderings,features,wedges,grid-ply"});
  };
  const auto add = [&] {
    std::ofstream(bag / "data/condition.txt") << "a crack on the reverse";
    std::ofstream(bag / "bag-info.txt", std::ios::app) << "Contact-Email: archive@example.org\n";
    bag_anew(bag);
    ASSERT_EQ(run_command({"verify", bag.string()}).status, 0);
  };
  ASSERT_EQ(export_with("--update").status, 0);
  add();
  ASSERT_EQ(run_command({"session", "describe", session.string(), "--notes", "cleaned"}).status, 0);
  const Outcome updated = export_with("--update");
  ASSERT_EQ(updated.status, 0) << updated.err;
  EXPECT_FALSE(fs::exists(bag / "data/condition.txt"));
  EXPECT_THAT(updated.err, HasSubstr("catalogued.kept-1"));
  ASSERT_THAT(
      files_below(at("catalogued.kept-1")),
      ElementsAre("bag-info.txt", "data/condition.txt", "manifest-sha512.txt", "tagmanifest-sha512.txt"));
  EXPECT_EQ(bytes_of(at("catalogued.kept-1") / "data/condition.txt"), "a crack on the reverse");
  EXPECT_THAT(bytes_of(at("catalogued.kept-1") / "bag-info.txt"), HasSubstr("Contact-Email"));
  // Without its stamp the package's own list tells what was written.
  add();
  fs::remove(at("catalogued.done"));
  const Outcome forced = export_with("--force");
  ASSERT_EQ(forced.status, 0) << forced.err;
  ASSERT_THAT(files_below(at("catalogued.kept-2")), ElementsAre("bag-info.txt", "data/condition.txt"));
}

TEST_F(Export, ReplacesNoBagOfOthers) {
  const std::vector<std::string> forced{"--without", "renderings,features,wedges,grid-ply", "--force"};
  const fs::path photos = at("photos");
  fs::create_directories(photos / "data");
  std::ofstream(photos / "data/p.jpg") << "a photograph";
  std::ofstream(photos / "bagit.txt") << "BagIt-Version: 1.0\nTag-File-Character-Encoding: UTF-8\n";
  std::ofstream(photos / "bag-info.txt") << "Bag-Software-Agent: bagit.py v1.8.1\nPayload-Oxum: 0.0\n";
  bag_anew(photos);
  ASSERT_EQ(run_command({"verify", photos.string()}).status, 0);
  const Outcome refused = export_to("photos", forced);
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.complaints(), SizeIs(1));
  EXPECT_THAT(refused.err, HasSubstr("no package of Dubsar"));
  EXPECT_EQ(bytes_of(photos / "data/p.jpg"), "a photograph");
  EXPECT_FALSE(fs::exists(at("photos.kept-1")));
  fs::create_symlink("nowhere", at("shortcut"));
  EXPECT_EQ(export_to("shortcut", forced).status, 2) << "a link that leads nowhere is somebody's too";
  EXPECT_TRUE(fs::is_symlink(at("shortcut")));
}

TEST_F(Export, ReplacesNoPackageOfAnotherSession) {
  const std::vector<std::string> small{"--without", "renderings,features,wedges,grid-ply"};
  std::vector<std::string> forced = small;
  forced.emplace_back("--force");
  const fs::path session = at("of_another_tablet");
  ASSERT_TRUE(SessionStore::open_or_create(session)->add_grid(test::bumpy_scan(0, 17, 1.0)));
  const auto export_other = [&](const char* option) {
    return run_command({"export", session.string(), "--to", at("other").string(), option, "--without",
                        "renderings,features,wedges,grid-ply"});
  };
  ASSERT_EQ(export_other("--update").status, 0);
  const Outcome refused = export_to("other", forced);
  EXPECT_EQ(refused.status, 2) << refused.err;
  EXPECT_THAT(refused.complaints(), SizeIs(1));
  EXPECT_THAT(refused.err, HasSubstr("of another session"));
  EXPECT_EQ(run_command({"verify", at("other").string()}).status, 0);
  // A session whose record had to be made anew is known by its scans.
  for (const char* name : {"session.sqlite", "session.backup.sqlite", "session.sums"}) {
    fs::remove(session / name);
  }
  EXPECT_EQ(export_other("--force").status, 0);
}

// The system follows the link before it goes up; what is checked is where the package goes.
TEST_F(Export, GoesWhereALinkAndTheFolderAboveItLead) {
  const fs::path session = at("linked_from");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  fs::create_directories(at("elsewhere/x"));
  fs::create_directory_symlink(at("elsewhere/x"), session / "out");
  const std::string to = (session / "out" / ".." / "package").string();
  const Outcome made = run_command(
      {"export", session.string(), "--to", to, "--without", "renderings,features,wedges,grid-ply"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_FALSE(fs::exists(session / "package"));
  EXPECT_TRUE(fs::exists(at("elsewhere/package/bagit.txt")));
  EXPECT_TRUE(fs::exists(at("elsewhere/package.done")));
}

TEST_F(Export, FindsAPackageDoneOnlyWhileItsPayloadIsWhatWasWritten) {
  const auto pack = [&](const char* how = nullptr) {
    std::vector<std::string> words{"--without", "renderings,features,wedges,grid-ply"};
    if (how != nullptr) {
      words.emplace_back(how);
    }
    return export_to("added_to", words);
  };
  ASSERT_EQ(pack().status, 0);
  std::ofstream(at("added_to") / "catalogue.txt") << "what the standard allows beside the payload";
  ASSERT_EQ(pack().json()["done_before"], true);
  std::ofstream(at("added_to") / "data" / "NOTE.txt") << "a note of mine";
  for (const Outcome& refused : {pack(), pack("--update")}) {
    EXPECT_EQ(refused.status, 2) << refused.out;
    EXPECT_THAT(refused.err, HasSubstr("data/NOTE.txt: somebody added it"));
  }
  EXPECT_EQ(bytes_of(at("added_to") / "data" / "NOTE.txt"), "a note of mine");
  ASSERT_EQ(pack("--force").status, 0);
  EXPECT_FALSE(fs::exists(at("added_to") / "data" / "NOTE.txt"));
  EXPECT_EQ(pack().json()["done_before"], true);
}

TEST_F(Export, ReplacesAPackageOfAnEarlierStateOfItsSessionWhenAsked) {
  const fs::path session = at("scanned_further");
  fs::copy(at("session"), session, fs::copy_options::recursive);
  const auto update = [&](const char* name) {
    return run_command({"export", session.string(), "--to", at(name).string(), "--json", "--update",
                        "--without", "renderings,features,wedges,grid-ply"});
  };
  ASSERT_EQ(update("renewed").status, 0) << "nothing lies there yet";
  EXPECT_EQ(update("renewed").json()["done_before"], true);
  ASSERT_EQ(run_command({"session", "drop", session.string(), "2", "--why", "hand in view"}).status, 0);
  const Outcome asked = run_command({"export", session.string(), "--to", at("renewed").string(), "--without",
                                     "renderings,features,wedges,grid-ply"});
  EXPECT_EQ(asked.status, 2) << "never unasked";
  const Outcome renewed = update("renewed");
  ASSERT_EQ(renewed.status, 0) << renewed.err;
  EXPECT_THAT(bytes_of(at("renewed") / "data" / "scans" / "scans.json"), HasSubstr("hand in view"));
  EXPECT_EQ(update("renewed").json()["done_before"], true);
  // Killed between stamp and package: the stamp says more than lies there, and it is replaced all the same.
  std::string stamp = bytes_of(at("renewed.done"));
  stamp[stamp.find("\"program\": \"") + 12] = '9';
  stamp[stamp.rfind("\"xxh128\": \"") + 11] = 'x';
  std::ofstream(at("renewed.done")) << stamp;
  const Outcome again = update("renewed");
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_FALSE(again.json().contains("done_before"));
  // What a person changed is kept, and so is what is of another session or has lost its stamp.
  std::ofstream(at("renewed") / "data" / "README.txt", std::ios::app) << "a note of mine";
  const Outcome changed = update("renewed");
  EXPECT_EQ(changed.status, 2);
  EXPECT_THAT(changed.err, HasSubstr("README.txt: not the bytes that manifest-sha512.txt says"));
  EXPECT_THAT(bytes_of(at("renewed") / "data" / "README.txt"), HasSubstr("a note of mine"));
  fs::remove_all(at("renewed"));
  ASSERT_EQ(update("renewed").status, 0);
  stamp = bytes_of(at("renewed.done"));
  const std::size_t grid = stamp.find(".grid\"");
  std::string other = stamp;
  other[stamp.find("\"xxh128\": \"", grid) + 11] = 'z';
  std::ofstream(at("renewed.done")) << other;
  EXPECT_EQ(update("renewed").status, 2) << "of another session";
  fs::remove(at("renewed.done"));
  EXPECT_EQ(update("renewed").status, 2) << "without a stamp";
}

// A disk that lost the session must not take the package along that is the only copy then.
TEST_F(Export, DoesNotReplaceAPackageThatHoldsMoreThanADamagedSession) {
  const fs::path session = at("failing");
  const auto update = [&] {
    return run_command({"export", session.string(), "--to", at("only_copy").string(), "--update", "--without",
                        "renderings,features,wedges,grid-ply"});
  };
  const auto expect_kept = [&](const char* why) {
    const Outcome refused = update();
    EXPECT_EQ(refused.status, 2) << refused.out;
    EXPECT_THAT(refused.err, HasSubstr(why));
    EXPECT_THAT(refused.err, HasSubstr("the package that lies here holds it"));
    EXPECT_THAT(bytes_of(at("only_copy") / "data/session/events.json"), HasSubstr("\"finished\""));
  };
  fs::copy(at("session"), session, fs::copy_options::recursive);
  ASSERT_EQ(update().status, 0);
  const std::string grid = bytes_of(session / "grids/001.grid");
  std::ofstream(session / "grids/001.grid", std::ios::trunc) << "cut";
  expect_kept("001.grid");
  std::ofstream(session / "grids/001.grid", std::ios::trunc | std::ios::binary) << grid;
  EXPECT_EQ(update().status, 0);
  std::ofstream(session / "session.sqlite", std::ios::trunc);
  expect_kept("missing or empty");
  // Mended without a copy it is put together from what is left: whole again, and poorer.
  fs::remove(session / "session.backup.sqlite");
  EXPECT_EQ(run_command({"session", "describe", session.string(), "--notes", "what is left"}).status, 2);
  ASSERT_EQ(run_command({"verify", session.string(), "--repair"}).status, 1);
  expect_kept("lost of its record: scan stored");
}

}  // namespace
}  // namespace dubsar

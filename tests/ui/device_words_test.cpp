// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What devices say, and registration of the units of what comes from them, in the words of the window.

#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <string>

#include "core/result.h"
#include "registration/unit_check.h"
#include "tests/ui/support/refusals.h"
#include "ui/shell/engine_words.h"
#include "ui/shell/text_table.h"

namespace dubsar::ui {
namespace {

TEST(DeviceWords, NoRefusalOfADeviceIsHalfGerman) {
  const std::set<std::string> no_sentence{" x ",    " to ",      ", from 0", "it has ",     " from ", " at ",
                                          " bytes", ", camera ", "at most ", "laser plane", ", not "};
  const int sentences = test::expect_german({"drivers/v4l2/camera.cpp",
                                             "drivers/v4l2/camera_mode.cpp",
                                             "drivers/v4l2/controls.cpp",
                                             "drivers/v4l2/modes.cpp",
                                             "drivers/v4l2/node.cpp",
                                             "drivers/v4l2/region.cpp",
                                             "drivers/v4l2/stream.cpp",
                                             "drivers/v4l2/v4l2_driver.cpp",
                                             "drivers/aravis/aravis_driver.cpp",
                                             "drivers/aravis/camera.cpp",
                                             "drivers/aravis/camera_setup.cpp",
                                             "drivers/aravis/connection.cpp",
                                             "drivers/aravis/features.cpp",
                                             "drivers/aravis/glib.h",
                                             "drivers/aravis/profiles.cpp",
                                             "drivers/usb_stage/banner.cpp",
                                             "drivers/usb_stage/controller.cpp",
                                             "drivers/usb_stage/grbl_firmware.cpp",
                                             "drivers/usb_stage/guard.cpp",
                                             "drivers/usb_stage/horus_firmware.cpp",
                                             "drivers/usb_stage/tmcl_firmware.cpp",
                                             "drivers/usb_stage/usb_link.cpp",
                                             "drivers/usb_stage/usb_stage_driver.cpp",
                                             "drivers/replay/scan_files.cpp",
                                             "acquisition/range_source.cpp",
                                             "acquisition/fresh_frame.cpp",
                                             "acquisition/stripe_stream.cpp",
                                             "acquisition/stage_watch.cpp",
                                             "acquisition/rig_scan.cpp",
                                             "acquisition/rig_sweep.cpp"},
                                            no_sentence);
  EXPECT_GT(sentences, 150);
}

TEST(DeviceWords, HelpOfSettingsIsGerman) {
  std::string said;
  for (const char* file :
       {"drivers/v4l2/v4l2_driver.cpp", "drivers/v4l2/controls.cpp", "drivers/aravis/features.cpp",
        "drivers/replay/replay_driver.cpp", "drivers/usb_stage/usb_stage_driver.cpp"}) {
    said += test::source_of(file);
  }
  for (const EnginePhrase& help : engine_settings()) {
    EXPECT_NE(said.find('"' + std::string(help.english) + '"'), std::string::npos) << help.english;
    EXPECT_EQ(translated(help.english, Language::kGerman), help.german);
  }
}

/// Every option of every driver, and the driver itself.
TEST(DeviceWords, HelpOfOptionsIsGerman) {
  std::string said;
  for (const char* file :
       {"drivers/sim/sim_options.cpp", "drivers/sim/sim_driver.cpp", "drivers/replay/replay_driver.cpp",
        "drivers/v4l2/v4l2_driver.cpp", "drivers/aravis/options.cpp", "drivers/aravis/aravis_driver.cpp",
        "drivers/usb_stage/options.cpp", "drivers/usb_stage/usb_stage_driver.cpp",
        "station/offered_devices.cpp"}) {
    said += test::source_of(file);
  }
  static const std::regex kSaid(
      R"re((?:\{DUBSAR_TYPE_[A-Z]+,\s*"[a-z_]+",\s*|description = |\{"rig", |info, "sim:", )"([^"]+)")re");
  int helps = 0;
  for (std::sregex_iterator one(said.begin(), said.end(), kSaid), end; one != end; ++one) {
    const std::string english = (*one)[1];
    EXPECT_NE(translated(english, Language::kGerman), english);
    ++helps;
  }
  EXPECT_GT(helps, 45);
  for (const EnginePhrase& help : engine_options()) {
    EXPECT_NE(said.find('"' + std::string(help.english) + '"'), std::string::npos) << help.english;
    EXPECT_EQ(translated(help.english, Language::kGerman), help.german);
  }
}

TEST(DeviceWords, AnErrorOfADeviceIsGermanAndItsNameStays) {
  const Error gone{ErrorKind::kDevice, "the camera was unplugged or has stopped answering",
                   "v4l2:/dev/the camera is gone 0.5 mm", "plug it in again, then go on"};
  EXPECT_EQ(
      translated(gone, Language::kGerman),
      "v4l2:/dev/the camera is gone 0.5 mm: die Kamera ist abgesteckt oder antwortet nicht mehr; wieder "
      "anstecken, dann weiter");
  EXPECT_EQ(translated(gone, Language::kEnglish), gone.line());
  const Error blocked{ErrorKind::kDevice, "the stage stands 3.125 mm short of its target", "2341:0043",
                      "see what holds it up, then home it"};
  EXPECT_EQ(translated(blocked, Language::kGerman),
            "2341:0043: der Tisch steht, es fehlen 3,125 mm zum Ziel; nachsehen, was ihn aufhält, dann "
            "Referenzfahrt");
}

TEST(DeviceWords, AStopThatWasNotObeyedIsGerman) {
  const Error deaf{ErrorKind::kDevice,
                   "the emergency stop was pressed, but laser and motors may still be on: the controller "
                   "cannot be reached, and its laser or its motor was on",
                   "2341:0043", "pull the plugs of laser and stage, or switch off their power"};
  EXPECT_EQ(
      translated(deaf, Language::kGerman),
      "2341:0043: der Not-Halt wurde gedrückt, aber Laser und Motoren können noch an sein: die Steuerung "
      "ist nicht zu erreichen, und ihr Laser oder ihr Motor war an; die Stecker von Laser und Tisch "
      "ziehen, oder ihren Strom abschalten");
}

TEST(DeviceWords, OtherUnitsAreSaidInGermanAndWithoutCommands) {
  const ScanSize metres{.scale_mm = 0.05, .spacing_mm = 0.0001};
  const ScanSize before{.scale_mm = 50, .spacing_mm = 0.1};
  EXPECT_EQ(translated(other_unit(metres, before), Language::kGerman),
            "nach seinen Zahlen ist er 1000-mal kleiner als die Scans davor: sie sind in einer anderen "
            "Einheit und sehen nach Metern aus; seine Einheit angeben: ?unit=m hinter dem Ordner, oder "
            "`obj_info unit m` in seinem Kopf; eine Sitzung behält ihre Einheit: damit in eine neue scannen");
  EXPECT_EQ(translated(other_unit(metres, before), Language::kEnglish),
            "by its numbers it is 1000 times smaller than the scans before it: they are in another unit and "
            "look like metres; give its unit: ?unit=m behind the folder, or `obj_info unit m` in its "
            "header; a session keeps its unit: scan into a new one with that");
  EXPECT_EQ(translated(impossible_size({.scale_mm = 0.0525, .spacing_mm = 0}, 2, 2000), Language::kGerman),
            "er wäre 0,0525 mm groß: seine Einheit ist 1000-mal größer als angegeben; richtig wäre ?unit=m "
            "(Meter) statt mm, oder ?unit=mm statt um (im Kopf einer Datei: `obj_info unit`); eine "
            "Sitzung behält ihre Einheit: damit in eine neue scannen");
  EXPECT_EQ(translated(perhaps_other_unit(metres, before), Language::kGerman),
            "nach seinen Zahlen ist er ungefähr 1000-mal kleiner als die Scans davor, an Größe und Abstand: "
            "wenn sie Meter sind, ist das die falsche Einheit; seine Einheit angeben: ?unit=m hinter dem "
            "Ordner, oder `obj_info unit m` in seinem Kopf; eine Sitzung behält ihre Einheit: damit in eine "
            "neue scannen");
}

TEST(DeviceWords, WhatASessionHasAlreadyIsSaidInGerman) {
  const auto german = [](const char* what, const char* mend) {
    return translated(Error{ErrorKind::kBadInput, what, "scan_1.ply", mend}, Language::kGerman);
  };
  EXPECT_EQ(
      german("the session has this scan in another unit, 1000 times smaller: it is left out, and so are "
             "all others of which that holds",
             "begin a new session in the right unit, or take those scans out of this one"),
      "scan_1.ply: die Sitzung hat diesen Scan in einer anderen Einheit, 1000-mal kleiner: er bleibt weg, "
      "wie alle anderen, für die das gilt; eine neue Sitzung in der richtigen Einheit beginnen, oder jene "
      "Scans aus dieser entfernen");
  EXPECT_EQ(german("the session has another scan of this name: this is stored as one more",
                   "take the other one out if this is to take its place"),
            "scan_1.ply: die Sitzung hat einen anderen Scan dieses Namens: dieser kommt dazu; den anderen "
            "entfernen, falls dieser an seine Stelle tritt");
  const char* mend = "give them in the frame of that scan, in millimetres";
  EXPECT_EQ(
      german("its pins cannot be right: 3 of them lie farther outside of it than it is large", mend),
      "scan_1.ply: seine Nadeln können nicht stimmen: 3 davon liegen weiter außerhalb, als er groß ist; sie "
      "im Koordinatensystem dieses Scans angeben, in Millimetern");
  EXPECT_EQ(german("its pins cannot be right: none of them lies within 4 mm of its samples", mend),
            "scan_1.ply: seine Nadeln können nicht stimmen: keine davon liegt näher als 4 mm an seinen "
            "Messpunkten; sie im Koordinatensystem dieses Scans angeben, in Millimetern");
}

}  // namespace
}  // namespace dubsar::ui

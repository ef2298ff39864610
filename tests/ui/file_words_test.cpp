// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What drivers do wrong, and what is said of files, sessions and calibrations that cannot be used, in the
// words of the window.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <utility>

#include "acquisition/session_store.h"
#include "acquisition/setting_words.h"
#include "core/shell_word.h"
#include "drivers/abi.h"
#include "formats/json_node.h"
#include "formats/mesh_io.h"
#include "formats/pins_json.h"
#include "station/wedge_doubts.h"
#include "station/wedge_histogram.h"
#include "tests/support/temporary_folder.h"
#include "tests/ui/support/refusals.h"
#include "ui/shell/text_table.h"

namespace dubsar::ui {
namespace {

/// Before and behind numbers and names: the sentences below have them in German.
const std::set<std::string> kAround{
    " belong",      " belongs",   " bytes",       " cannot be '",   " elements",  " entries",
    " in it",       " is",        " is ",         " is not ",       " levels",    " lies ",
    " numbers",     " of ",       " on",          " samples",       " samples)",  " takes ",
    " to ",         " to change", " to read",     " vertices",      ", not ",     ", out",
    "a direction",  "a length",   "a number",     "a whole number", "axis ",      "chunk ",
    "claims ",      "element ",   "facet ",       "format ",        "has ",       "header line ",
    "holds ",       "is ",        "is missing",   "is not ",        "is text",    "it has ",
    "lies ",        "line ",      "more than ",   "no scan ",       "obj_info ",  "obj_info unit is ",
    "one of ",      "option ",    "rate '",       "sample ",        "scan again", "setting ",
    "the document", "there are ", "there is no ", "three numbers",  "unit '",     "vertex ",
    "write "};

std::set<std::string> and_these(std::set<std::string> more) {
  more.insert(kAround.begin(), kAround.end());
  return more;
}

TEST(FileWords, NoFaultOfADriverIsHalfGerman) {
  const int sentences = test::expect_german(
      {"drivers/abi.cpp", "drivers/abi_frames.cpp", "drivers/loader.cpp", "drivers/trust.cpp",
       "drivers/device.cpp", "drivers/device_frames.cpp", "drivers/device_stage.cpp",
       "drivers/sim/sim_driver.cpp", "drivers/replay/replay_driver.cpp", "acquisition/setting_words.cpp",
       "acquisition/device_uri.cpp"},
      kAround);
  EXPECT_GT(sentences, 60);
}

TEST(FileWords, NoRefusalOfAReaderIsHalfGerman) {
  const int sentences = test::expect_german(
      {"formats/json_node.cpp",     "formats/toml_document.cpp",    "formats/self_checked.cpp",
       "formats/atomic_file.cpp",   "formats/hint_json.cpp",        "formats/pins_json.cpp",
       "formats/ply_header.cpp",    "formats/ply_body.cpp",         "formats/ply_scan.cpp",
       "formats/ply_scan_info.cpp", "formats/point_text.cpp",       "formats/ptx.cpp",
       "formats/scan_samples.cpp",  "formats/place_precision.cpp",  "formats/grid_file.cpp",
       "formats/grid_header.cpp",   "formats/grid_reader.cpp",      "formats/glb_container.cpp",
       "formats/mesh_glb.cpp",      "formats/mesh_io.cpp",          "formats/mesh_obj.cpp",
       "formats/mesh_ply.cpp",      "formats/mesh_stl.cpp",         "formats/gray_file.cpp",
       "formats/gray_jpeg.cpp",     "formats/calibration_json.cpp", "formats/calibration_set.cpp",
       "formats/artefact_toml.cpp", "formats/corrections_json.cpp", "formats/selections_json.cpp",
       "formats/rig_json.cpp",      "formats/rig_toml.cpp",         "formats/rig_limits_json.cpp",
       "formats/red_map_json.cpp",  "formats/wedge_json.cpp",       "formats/search_index.cpp",
       "formats/sha2.cpp",          "formats/writers_turn.cpp",     "formats/seen_side.cpp",
       "acquisition/resample.cpp",  "formats/refusal.cpp",          "formats/draco_decode.cpp",
       "formats/draco_encode.cpp",  "formats/gltf_primitive.cpp",   "formats/mesh_glb_writer.cpp",
       "formats/comma_use.cpp",     "formats/ptx_samples.cpp",      "formats/scan_folder.cpp"},
      and_these({"`obj_info dubsar_direction "}));
  EXPECT_GT(sentences, 150);
}

TEST(FileWords, NothingSaidOfASessionIsHalfGerman) {
  const int sentences = test::expect_german(
      {"acquisition/session_files.cpp", "acquisition/session_lock.cpp", "acquisition/session_log.cpp",
       "acquisition/session_open.cpp", "acquisition/session_rebuild.cpp", "acquisition/session_records.cpp",
       "acquisition/session_repair.cpp", "acquisition/session_links.cpp", "acquisition/session_store.cpp",
       "acquisition/session_tables.cpp", "acquisition/session_verify.cpp", "acquisition/sqlite_db.cpp",
       "acquisition/sign_off_log.cpp", "acquisition/operator_log.cpp", "acquisition/pose_json.cpp"},
      and_these({"scan stored", "dubsar verify --repair ", "dubsar sign-off 1\\n", "dubsar sign-off 2\\n",
                 "pose hint", "pose hint withdrawn", "scan locked", "scan unlocked", "signed ",
                 "scan dropped", "scan restored", "PRAGMA wal_checkpoint(TRUNCATE)",
                 "SELECT id, file, bytes, hash FROM scans ORDER BY id",
                 "SELECT -1, path, bytes, hash FROM files ORDER BY path"}));
  EXPECT_GT(sentences, 70);
}

TEST(FileWords, NothingSaidOfACalibrationIsHalfGerman) {
  const int sentences = test::expect_german(
      {"acquisition/range_rig.cpp", "acquisition/rig_device.cpp", "acquisition/rig_parts.cpp",
       "acquisition/board.cpp", "acquisition/calibration.cpp", "acquisition/calibration_folder.cpp",
       "acquisition/calibration_intrinsics.cpp", "acquisition/calibration_joint.cpp",
       "acquisition/calibration_laser.cpp", "acquisition/calibration_stage.cpp",
       "acquisition/camera_region.cpp", "acquisition/live_calibration.cpp",
       "acquisition/live_calibration_taking.cpp", "acquisition/artefact.cpp", "acquisition/rig_view.cpp"},
      and_these({"laser plane", " day ago"}));
  EXPECT_GT(sentences, 70);
}

TEST(FileWords, NothingSaidOfARunOrOfTheViewerIsHalfGerman) {
  const int sentences = test::expect_german(
      {"station/calibration_run.cpp", "station/engine_motion.cpp", "station/operator_hint.cpp",
       "station/outward_faces.cpp", "station/package_content.cpp", "station/section_file.cpp",
       "station/selection_store.cpp", "station/tablet_record.cpp", "station/verification.cpp",
       "station/wedge_doubts.cpp", "analysis/cross_section.cpp", "registration/registrar.cpp"},
      and_these(
          {"its pictures are of a ", " stage, this is of a ", " one", "point ", "scan ", "point pair "}));
  EXPECT_GT(sentences, 50);
}

std::string german(const Error& error) {
  return translated(error, Language::kGerman);
}

TEST(FileWords, WhatIsDoubtedInWedgesIsGerman) {
  WedgeFile file;
  file.text_from_model = RigidTransform();
  file.wedges.resize(12);
  EXPECT_EQ(
      german(doubts_of(file, {}).at(0)),
      "keine Schreibrichtung zeigt sich in den 12 gefundenen Keilen: die Sicherheit wurde an "
      "beschrifteten Tafeln gelernt, und Vertiefungen in rauem Ton können als Keile durchgehen: ansehen, "
      "bevor man sie zählt");
  file.wedges.resize(1);
  EXPECT_TRUE(german(doubts_of(file, {}).at(0))
                  .starts_with("in dem einen gefundenen Keil zeigt sich keine Schreibrichtung: die "));
  file.text_certainty = 1;
  file.wedges[0].roundness = 0.1;
  EXPECT_EQ(german(doubts_of(file, {}).at(0)),
            "die meisten Keile sind abgerieben (die Kanten sind gerundet: 1): Tiefen und Winkel sind die des "
            "Tons, wie er ist, nicht die des Eindrucks; sie weglassen, um Hände zu vergleichen");
  file.wedges.resize(2);
  file.wedges[0].roundness = 0;
  file.wedges[1].intact = 0.5;
  EXPECT_EQ(translated(histogram_of(file.wedges, kWedgeLengths, 3).note, Language::kGerman),
            "1 / 2: Winkel werden abgelesen, wo ein Keil sicher ganz und scharf ist");
}

TEST(FileWords, AFileOfPinsIsRefusedInGerman) {
  const auto refused = [](const char* text) { return german(parse_pins(text, "/a/pins.json").error()); };
  EXPECT_EQ(
      refused("{\"tip_diameter_mm\":\"x\"}"),
      "/a/pins.json: tip_diameter_mm ist Text, keine Zahl; Nadeln so angeben wie in docs/formats/pins.md");
  EXPECT_EQ(refused("{\"tip_diameter_mm\":900}"),
            "/a/pins.json: tip_diameter_mm ist 900, außerhalb des Bereichs; Nadeln so angeben wie in "
            "docs/formats/pins.md");
  EXPECT_EQ(refused("{}"),
            "/a/pins.json: tip_diameter_mm fehlt; Nadeln so angeben wie in docs/formats/pins.md");
  EXPECT_EQ(refused("[]"),
            "/a/pins.json: das Dokument ist eine Liste, kein Objekt; nachsehen, was für eine Datei es ist");
  EXPECT_EQ(refused("{\n]"),
            "/a/pins.json: Zeile 2: kein JSON ab Byte 3; die Datei berichtigen oder neu schreiben");
}

TEST(FileWords, AMeshIsRefusedInGerman) {
  const dubsar::test::TemporaryFolder folder;
  const auto refused = [&](const std::string& name, const std::string& bytes) {
    const std::filesystem::path file = folder.path() / name;
    std::ofstream(file, std::ios::binary) << bytes;
    const std::string line = german(read_mesh(file).error());
    EXPECT_TRUE(line.starts_with(file.string() + ": ")) << line;
    return line.substr(std::min(line.size(), file.string().size() + 2));
  };
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  EXPECT_EQ(refused("a.ply", head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n"),
            "Fläche 0 (Zeile 13): Punkt 7 ist keiner der 3 Punkte; das Netz noch einmal ausgeben");
  EXPECT_EQ(refused("b.ply", "ply\nformat ascii 1.0\nelement vertex many\nend_header\n"),
            "Kopfzeile 3: Element 'vertex' hat keine Anzahl, sondern 'many'; noch einmal ausgeben");
  EXPECT_EQ(refused("c.obj", "v 1 2 x\n"),
            "Zeile 1: 'x' ist keine Koordinate; das Netz noch einmal ausgeben");
  const dubsar::test::TemporaryFolder other;
  const std::string none = german(read_mesh(other.path() / "none.ply").error());
  EXPECT_EQ(none, (other.path() / "none.ply").string() +
                      ": nicht lesbar: keine solche Datei, kein solcher Ordner; den Namen prüfen");
}

TEST(FileWords, ADriverAndItsSettingsAreGerman) {
  EXPECT_EQ(
      german(abi::faulty("eye:1", "told a rig with a depth range of 5000 mm, beyond 2000 mm")),
      "eye:1: der Treiber meldet ein Gerät mit einem Tiefenbereich von 5000 mm, jenseits von 2000 mm; den "
      "Treiber erneuern, oder den Fehler seinen Machern melden");
  EXPECT_EQ(
      german(abi::faulty("eye:1", "told a range of its tilt that is none")),
      "eye:1: der Treiber meldet einen unmöglichen Bereich für seine Neigung; den Treiber erneuern, oder "
      "den Fehler seinen Machern melden");
  SettingInfo exposure;
  exposure.key = "exposure";
  exposure.unit = "ms";
  exposure.type = SettingType::kNumber;
  exposure.range = {1, 5};
  EXPECT_EQ(german(setting_value(exposure, "long", "eye:1").error()),
            "eye:1: exposure kann nicht sein: 'long'; zulässig ist eine Zahl von 1 bis 5 ms");
  EXPECT_EQ(translated("setting exposure takes a number from 1 to 5 ms", Language::kGerman),
            "Einstellung exposure: zulässig ist eine Zahl von 1 bis 5 ms");
}

TEST(FileWords, WhatStandsAroundNamesAndNumbersIsGerman) {
  for (const auto& [english, german] :
       {std::pair{"there is no scan 7", "es gibt keinen Scan 7"},
        {"obj_info dubsar_direction is not a direction", "obj_info dubsar_direction ist keine Richtung"},
        {"obj_info unit is 'yard', not m, cm, mm, um or in",
         "obj_info unit ist 'yard', nicht m, cm, mm, um oder in"},
        {"line 3: has 2 numbers where 3 belong", "Zeile 3: hat 2 Zahlen statt 3"},
        {"none of the 2 files in the folder is a scan; unpack the packed files, rename .csv to .xyz where "
         "the "
         "lines are points, name a file by itself if it is a scan of fewer than 100 points",
         "kein Scan unter den 2 Dateien im Ordner; die gepackten Dateien auspacken, .csv in .xyz umbenennen, "
         "wo "
         "die Zeilen Punkte sind, eine Datei selbst nennen, wenn sie ein Scan aus weniger als 100 Punkten "
         "ist"},
        {"a.ptx#1 beside it has no samples and is passed over",
         "a.ptx#1 daneben hat keine Messpunkte und wird übergangen"},
        {"claims 12 of element vertex, but only 7 bytes are left for them",
         "nennt 12 vom Element vertex, aber nur 7 Byte sind dafür da"},
        {"ends within vertex 3 of 10", "endet mitten in Punkt 3 von 10"},
        {"scans[2].id has 4 entries, not 3 numbers", "scans[2].id hat 4 Einträge, nicht 3 Zahlen"},
        {"the document has 'tip', and knows unit, scans", "das Dokument hat 'tip', bekannt ist: unit, scans"},
        {"option speed is given twice", "die Option speed steht zweimal da"},
        {"another user (4242) owns it", "ein anderer Benutzer (4242) besitzt sie"},
        {"it takes one of linear, turntable", "zulässig ist eins von linear, turntable"},
        {"there are sim, replay", "es gibt sim, replay"}}) {
    EXPECT_EQ(translated(english, Language::kGerman), german);
  }
}

// A phrase that is part of another sentence must not make half of it German.
TEST(FileWords, WordsAloneAreLeftInOtherSentences) {
  for (const char* sentence : {"no pose in it is of one of these scans", "the lamp needs a direction",
                               "register the scan again", "there is no mast"}) {
    EXPECT_EQ(translated(sentence, Language::kGerman), sentence);
  }
}

TEST(FileWords, ASessionThatCannotBeOpenedSaysSoInGerman) {
  const dubsar::test::TemporaryFolder folder;
  std::ofstream(folder.path() / "letter.txt") << "not a session";
  EXPECT_EQ(german(SessionStore::open_or_create(folder.path()).error()),
            folder.path().string() +
                ": der Ordner enthält anderes und keine Sitzung; einen neuen oder leeren Ordner nennen");
}

TEST(FileWords, WhatMendsADamagedSessionIsTypedAsItStands) {
  const dubsar::test::TemporaryFolder folder;
  const std::filesystem::path session = folder.path() / "BM 1";
  RangeGrid grid;
  grid.allocate(2, 2);
  ASSERT_TRUE(SessionStore::open_or_create(session)->add_grid(grid));
  std::filesystem::remove(session / "grids/000.grid");
  const Result<SessionStore> opened = SessionStore::open(session, SessionStore::Access::kReadOnly);
  ASSERT_TRUE(opened);
  ASSERT_EQ(opened->opening().damage.size(), 1U);
  // As the window gets it.
  const std::string notice = "damaged: " + opened->opening().damage.front().line();
  const std::string word = shell_word(session.string());
  EXPECT_EQ(
      translated(notice, Language::kEnglish),
      "damaged: grids/000.grid: missing; bring it back from a copy (dubsar verify --repair --from COPY " +
          word + ") or scan again");
  EXPECT_EQ(
      translated(notice, Language::kGerman),
      "beschädigt: grids/000.grid: fehlt; aus einer Kopie zurückholen (dubsar verify --repair --from KOPIE " +
          word + "), oder neu scannen");
}

}  // namespace
}  // namespace dubsar::ui

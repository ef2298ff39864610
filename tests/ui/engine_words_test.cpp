// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/engine_words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "build_paths.h"
#include "ui/shell/text_table.h"

namespace dubsar::ui {
namespace {

std::string joined(const std::string& source) {
  return std::regex_replace(source, std::regex("\"\\s*\\n\\s*\""), "");
}

/// The sources of the engine and of its drivers, adjacent string literals joined.
std::string words_of_the_engine() {
  std::string all;
  for (const char* folder : {"station", "registration", "planning", "triangulation", "archive", "analysis",
                             "acquisition", "formats", "drivers", "drivers/v4l2", "drivers/aravis",
                             "drivers/usb_stage", "drivers/replay", "drivers/sim"}) {
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(DUBSAR_SOURCE_DIR) / folder)) {
      if (entry.path().extension() == ".cpp" || entry.path().extension() == ".h") {
        std::ifstream in(entry.path());
        all.append(std::istreambuf_iterator<char>(in), {});
      }
    }
  }
  return joined(all);
}

/// What the first group of a pattern holds, wherever it is found in a file of the engine or in all of it.
std::vector<std::string> said_by(const std::string& source, const char* pattern) {
  std::vector<std::string> out;
  const std::regex wanted(pattern);
  for (std::sregex_iterator at(source.begin(), source.end(), wanted), end; at != end; ++at) {
    out.push_back((*at)[1]);
  }
  return out;
}

std::string source_of(const char* file) {
  std::ifstream in(std::filesystem::path(DUBSAR_SOURCE_DIR) / file);
  return joined({std::istreambuf_iterator<char>(in), {}});
}

/// A format string without what is put in, a piece a line.
std::vector<std::string> pieces_of(const std::string& sentence) {
  const std::regex holes("\\{[^}]*\\}");
  std::vector<std::string> out;
  for (std::sregex_token_iterator at(sentence.begin(), sentence.end(), holes, -1), end; at != end; ++at) {
    if (at->str().find_first_of("abcdefghijklmnopqrstuvwxyz") != std::string::npos) {
      out.push_back(*at);
    }
  }
  return out;
}

TEST(EngineWords, EveryPhraseIsStillSaidByTheEngine) {
  const std::string said = words_of_the_engine();
  ASSERT_GT(said.size(), 100000U);
  for (const EnginePhrase& phrase : engine_sentences()) {
    std::string english = phrase.english;
    // Where to turn and to push is put together of the face's name, where an arm goes likewise, and what a
    // scan can do on an overlap of a word. "missing" alone may be a file's name: it is known by what a line
    // has around it.
    if (english.starts_with("turn the ") || english.starts_with("arm to the side of ") ||
        english.starts_with(", by way of ") || english.starts_with("the corner between ") ||
        english.starts_with(" mm from its middle towards ") || english == ": missing; ") {
      continue;
    }
    for (const char* word : {"turn on it", "slide on it"}) {
      english = english.substr(0, english.find(word));
    }
    const std::size_t first = english.find_first_not_of(' ');
    EXPECT_NE(said.find(english.substr(first)), std::string::npos) << english;
  }
}

TEST(EngineWords, EveryStageThatIsSaidHasAPhrase) {
  const std::vector<std::string> said = said_by(words_of_the_engine(), R"re(progress\(\s*"([^"]+)")re");
  EXPECT_GT(said.size(), 40U);
  for (const std::string& stage : said) {
    EXPECT_NE(translated(stage, Language::kGerman), stage);
  }
  const std::string all = words_of_the_engine();
  for (const EnginePhrase& stage : engine_stages()) {
    EXPECT_NE(all.find('"' + std::string(stage.english) + '"'), std::string::npos) << stage.english;
  }
  // All that is said, or nothing: a file may have such a name.
  EXPECT_EQ(translated("board", Language::kGerman), "Muster wird gesucht");
  EXPECT_EQ(translated("calibration/board_01.png", Language::kGerman), "calibration/board_01.png");
}

TEST(EngineWords, EveryRefusalAndAdviceThatIsShownHasAPhrase) {
  struct Said {
    const char* file;
    const char* pattern;
    std::size_t at_least;
  };
  // Why a correction is not made, why an artefact fails, what a calibration lacks.
  constexpr Said kSaid[] = {
      {"analysis/wedge_corrections.cpp", R"re(unexpected\(\s*(?:fmt::format\(\s*)?"([^"]+)")re", 10},
      {"analysis/hollow_measure.cpp", R"re((?:unexpected\(|constexpr const char\* k\w+ = )"([^"]+)")re", 3},
      {"analysis/wedge_faces.cpp", R"re((?:unexpected\(|return |wrong = )"([^"]+)")re", 7},
      {"acquisition/artefact.cpp", R"re((?:failed\.\w+\(|over\()"([^"]+)")re", 6},
      {"acquisition/calibration_mirror.cpp", R"re([=+]\s*"([^"]+)")re", 6},
      {"acquisition/calibration_advice.cpp", R"re("([a-z ][^"]{6,}[^"h])"[,;})\s])re", 17}};
  for (const Said& one : kSaid) {
    const std::vector<std::string> sentences = said_by(source_of(one.file), one.pattern);
    EXPECT_GE(sentences.size(), one.at_least) << one.file;
    for (const std::string& sentence : sentences) {
      for (const std::string& piece : pieces_of(sentence)) {
        EXPECT_NE(translated(piece, Language::kGerman), piece) << one.file << ": " << sentence;
      }
    }
  }
}

TEST(EngineWords, WhyAPlaceIsExcusedIsGerman) {
  int sentences = 0;
  for (const char* file : {"planning/excuse_specks.cpp", "planning/excuse_unneeded.cpp"}) {
    for (const std::string& reason : said_by(source_of(file), R"re("([^"\n]*)")re")) {
      const bool has_words = reason.find(' ') != std::string::npos &&
                             reason.find_first_of("abcdefghijklnopqrstuvwxyz") != std::string::npos;
      if (has_words) {  // no name of a file, nor " µm"
        ++sentences;
        EXPECT_NE(translated(reason, Language::kGerman), reason) << file;
      }
    }
  }
  EXPECT_GE(sentences, 10);
  EXPECT_EQ(
      translated("gap of 0.52 mm; its surroundings bend by 7 µm from a quadric, interpolation good to 22 µm",
                 Language::kGerman),
      "Lücke von 0,52 mm; ihre Umgebung weicht um 7 µm von einer Quadrik ab, gefüllt auf 22 µm");
}

TEST(EngineWords, RefusalsOfCorrectionsAndArtefactsAreGerman) {
  EXPECT_EQ(translated("stopped: it is noted, and made with the next one or when the mesh is opened again",
                       Language::kGerman),
            "angehalten: es ist vermerkt und wird mit der nächsten gemacht, oder wenn das Netz wieder "
            "geöffnet wird");
  EXPECT_EQ(translated("no unit makes a tablet of it: it is 1952 mm; look what its numbers are, and make "
                       "millimetres of them",
                       Language::kGerman),
            "keine Einheit macht eine Tafel daraus: es sind 1952 mm; nachsehen, was seine Zahlen sind, und "
            "Millimeter daraus machen");
  EXPECT_EQ(translated("no wedge is measured there: too shallow", Language::kGerman),
            "dort lässt sich kein Keil messen: zu flach");
  EXPECT_EQ(translated("one of the parts is not measured as a wedge, number 2: too few faces of the mesh",
                       Language::kGerman),
            "einer der Teile lässt sich nicht als Keil messen, Nummer 2: zu wenige Flächen des Netzes");
  EXPECT_EQ(translated("not all balls were found: 3, and the artefact has 5", Language::kGerman),
            "nicht alle Kugeln wurden gefunden: 3, und der Prüfkörper hat 5");
  EXPECT_EQ(
      translated("off the plane: 60000 samples within its outline, of 241001, by up to 517.9 µm; three in a "
                 "thousand may be",
                 Language::kGerman),
      "nicht auf der Ebene: 60000 Messpunkte in ihrem Umriss, von 241001, um bis zu 517,9 µm; drei von "
      "tausend dürfen es sein");
  EXPECT_EQ(
      translated("off ball 1: 1600 samples before its face, of 7000, by up to 400 µm; three in a thousand "
                 "may be",
                 Language::kGerman),
      "nicht auf Kugel 1: 1600 Messpunkte vor ihrer Stirnseite, von 7000, um bis zu 400 µm; drei von "
      "tausend dürfen es sein");
  EXPECT_EQ(
      translated("seen of ball 1: 8 parts of its face, of 24, and at least 18 have to be", Language::kGerman),
      "gesehen von Kugel 1: 8 Felder ihrer Stirnseite, von 24, und mindestens 18 müssen es sein");
  EXPECT_EQ(translated("the scan is of camera A7, the calibration of camera B8", Language::kGerman),
            "der Scan ist von Kamera A7, die Kalibrierung von Kamera B8");
  EXPECT_EQ(translated("the scan is of 2025-12-29T09:20:00Z, the calibration was made later, on "
                       "2026-01-02T03:04:05Z",
                       Language::kGerman),
            "der Scan ist von 2025-12-29T09:20:00Z, die Kalibrierung ist später entstanden, am "
            "2026-01-02T03:04:05Z");
  EXPECT_EQ(translated("show the laser on the board 12 mm nearer to the camera", Language::kGerman),
            "den Laser auf dem Muster zeigen, 12 mm näher an der Kamera");
}

/// The string literals of a source that are more than a word.
std::vector<std::string> sentences_in(const char* file) {
  const std::string source = std::regex_replace(source_of(file), std::regex("//[^\\n]*|#include[^\\n]*"), "");
  std::vector<std::string> out = said_by(source, R"re("([^"\n]*)")re");
  std::erase_if(out,
                [](const std::string& one) { return one.size() < 10 || one.find(' ') == std::string::npos; });
  return out;
}

/// Every sentence of what the window shows of a run, and of why nothing is signed.
TEST(EngineWords, NothingOfARunIsHalfGerman) {
  const std::vector<std::string> no_sentence{
      "a command of pace came among those to the registrar",
      "no session there",
      "name the folder that a scan was stored in",
      "pins labelled",
      "labels of scan ",
      " (red map)",
      "arm to the side of ",
      "Bag-Software-Agent: Dubsar ",  // it is looked for
      "\\nBag-Software-Agent: Dubsar ",
      " + text_of(event, ",
      "something was said of its scans",  // on a page, not in the window
      "the disk refused"};
  for (const char* file :
       {"station/earlier_package.cpp", "archive/staged_folder.cpp", "archive/kept_files.cpp",
        "acquisition/session_links.cpp", "station/engine_misses.cpp", "station/engine_commands.cpp",
        "station/signing.cpp", "station/plan_again.cpp", "planning/motor_placements.cpp",
        "registration/pin_advice.cpp", "registration/pin_contradiction.cpp", "registration/scan_motion.cpp",
        "registration/scan_stretch.cpp", "registration/second_body.cpp"}) {
    int sentences = 0;
    for (const std::string& sentence : sentences_in(file)) {
      if (std::ranges::find(no_sentence, sentence) != no_sentence.end()) {
        continue;
      }
      ++sentences;
      for (const std::string& piece : pieces_of(sentence)) {
        const std::string said = " " + piece;  // after the scan's number
        const bool is_number = std::regex_match(piece, std::regex(" ?scans? "));
        EXPECT_TRUE(is_number || translated(said, Language::kGerman) != said) << file << ": " << sentence;
      }
    }
    EXPECT_GE(sentences, 2) << file;
  }
}

TEST(EngineWords, AdviceOnPinsIsGerman) {
  EXPECT_EQ(
      translated("too few pins are seen, 2, and needed are 6 (fewer when they are labelled): set more at "
                 "the left edge",
                 Language::kGerman),
      "zu wenige Nadeln sind zu sehen, 2, nötig sind 6 (weniger, wenn sie benannt sind): mehr setzen am "
      "linken Rand");
  EXPECT_EQ(
      translated("the pins stand nearly in one line; to be moved to the top edge: pin 3", Language::kGerman),
      "die Nadeln stehen fast in einer Linie; zu versetzen zum oberen Rand: Nadel 3");
  EXPECT_EQ(
      translated("a pin at the bottom edge stands too close to pin 4 (0.8 mm): move it to the right edge",
                 Language::kGerman),
      "eine Nadel am unteren Rand steht zu nah an Nadel 4 (0,8 mm): sie versetzen zum rechten Rand");
}

/// A file's name is left as it is.
TEST(EngineWords, AWordAloneIsNotReplacedAnywhere) {
  EXPECT_EQ(translated("/data/new rows/scan.ply", Language::kGerman), "/data/new rows/scan.ply");
  EXPECT_EQ(translated("the half scan is kept, rows: 41", Language::kGerman),
            "der halbe Scan ist aufgehoben, Zeilen: 41");
}

TEST(EngineWords, WhoSetsAScanAsideSaysItInOneLanguage) {
  const std::string said =
      "something was in the way of scan 3: 12 % of it, where scan 2 looked too, stands in the air; it is set "
      "aside (session restore puts it back)";
  EXPECT_EQ(translated(said, Language::kGerman),
            "etwas war im Weg von Scan 3: 12 % davon stehen in der Luft, wo auch Scan 2 hinsah; er ist "
            "beiseitegelegt (ein Klick holt ihn zurück)");
  EXPECT_EQ(translated(said, Language::kEnglish),
            "something was in the way of scan 3: 12 % of it, where scan 2 looked too, stands in the air; it "
            "is set aside (a click on it puts it back)");
  EXPECT_EQ(
      translated(
          "something was in the way of scan 3: 12 mm² of it are left out (looked through by scans 1, 2 and "
          "5); 30 mm² may be of it or of the tablet and stay red until another scan tells",
          Language::kGerman),
      "etwas war im Weg von Scan 3: 12 mm² davon sind weggelassen (es sahen hindurch: Scans 1, 2 und 5); "
      "30 mm² können davon oder von der Tafel sein und bleiben rot, bis ein anderer Scan es zeigt");
  EXPECT_EQ(translated("scans 1, 2 and 5 fit each other and not scan 0", Language::kGerman),
            "Scans 1, 2 und 5 passen zueinander und nicht zu Scan 0");
}

TEST(EngineWords, GroupsApartAreToldInOneLanguage) {
  EXPECT_EQ(
      translated(
          "scans 2 to 4 and 6 fit one another, and not scans 0 and 1; to join them lay the tablet as "
          "for scan 1, turn the right edge towards the camera, 25°, scan, and scan twice more, each "
          "time turned on by 45° over that edge; or scan both sides again with the same pins standing, "
          "or click three places that a scan of each shows; take out what is of another tablet",
          Language::kGerman),
      "Scans 2 bis 4 und 6 passen zueinander, und nicht zu Scans 0 und 1; um sie zu verbinden, die Tafel "
      "hinlegen wie bei Scan 1, den rechten Rand zur Kamera drehen, 25°, scannen, und noch zweimal scannen, "
      "jedes Mal um 45° weiter über diesen Rand gedreht; oder beide Seiten mit denselben stehenden Nadeln "
      "neu "
      "scannen, oder drei Stellen anklicken, die je ein Scan von beiden zeigt; herausnehmen, was von einer "
      "anderen Tafel ist");
  EXPECT_EQ(
      translated("scans 5 to 8 fit one another, and not scan 1; to join them scan the edge between them, "
                 "held so that both sides are in view",
                 Language::kGerman),
      "Scans 5 bis 8 passen zueinander, und nicht zu Scan 1; um sie zu verbinden, den Rand zwischen "
      "ihnen scannen, so gehalten, dass beide Seiten zu sehen sind");
}

TEST(EngineWords, AdviceOfPinsIsGermanWithThemAndWithout) {
  EXPECT_EQ(
      translated("the overlap is too even: the scan can slide on it; scan again with an edge or more "
                 "relief in the overlap, or use pins",
                 Language::kGerman),
      "die Überlappung ist zu eben: der Scan kann darauf gleiten; neu scannen, mit einer Kante oder mehr "
      "Relief in der Überlappung, oder mit Nadeln");
  EXPECT_EQ(
      translated("the overlap is too even: the scan can turn on it; scan again with an edge or more "
                 "relief in the overlap; its pins, put back by hand, hold it no better",
                 Language::kGerman),
      "die Überlappung ist zu eben: der Scan kann sich darauf drehen; neu scannen, mit einer Kante oder "
      "mehr Relief in der Überlappung; seine Nadeln, von Hand zurückgestellt, halten ihn nicht besser");
  EXPECT_EQ(
      translated("too little is written or broken in the overlap to tell this pose from others; scan "
                 "again with more overlap, use pins, or click one point on both scans",
                 Language::kGerman),
      "in der Überlappung ist zu wenig geschrieben oder gebrochen, um diese Lage von anderen zu "
      "unterscheiden; mit mehr Überlappung neu scannen, Nadeln nehmen, oder eine Stelle in beiden Scans "
      "anklicken");
}

TEST(EngineWords, WhatOpeningASessionPutRightIsGerman) {
  const auto german = [](const char* said) { return translated(said, Language::kGerman); };
  EXPECT_EQ(german("took in grids/007.grid, which was stored and not yet listed"),
            "aufgenommen: grids/007.grid, gespeichert und noch nicht verzeichnet");
  EXPECT_EQ(
      german("took in grids/007.grid, whose row was lost: taken out, as its record says"),
      "aufgenommen: grids/007.grid, dessen Zeile verloren war: herausgenommen, wie es aufgezeichnet ist");
  EXPECT_EQ(german("took in grids/007.grid, whose row was lost; it may have been taken out"),
            "aufgenommen: grids/007.grid, dessen Zeile verloren war; vielleicht war er herausgenommen");
  EXPECT_EQ(german("half-written files removed: 2"), "halb geschriebene Dateien entfernt: 2");
  EXPECT_EQ(german("kept the damaged log as session.sqlite.damaged-1-wal"),
            "das beschädigte Protokoll ist aufgehoben als session.sqlite.damaged-1-wal");
  EXPECT_EQ(german("kept the damaged database as session.sqlite.damaged-1"),
            "die beschädigte Datenbank ist aufgehoben als session.sqlite.damaged-1");
}

TEST(EngineWords, NobodyInTheWindowIsToldToGiveACommand) {
  for (const char* file :
       {"station/earlier_package.cpp", "archive/staged_folder.cpp", "station/engine_misses.cpp",
        "station/engine_motion.cpp", "station/signing.cpp", "registration/unit_check.cpp",
        "acquisition/rig_device.cpp", "drivers/v4l2/node.cpp", "drivers/usb_stage/usb_link.cpp"}) {
    for (const std::string& sentence : sentences_in(file)) {
      for (const Language language : {Language::kEnglish, Language::kGerman}) {
        const std::string shown = translated(sentence, language);
        for (const char* of_commands : {"command again", "dubsar verify", "session restore", "session drop",
                                        "--", "run dubsar", "dubsar drivers"}) {
          EXPECT_EQ(shown.find(of_commands), std::string::npos) << file << ": " << shown;
        }
      }
    }
  }
}

TEST(EngineWords, NoPhraseHidesALongerOneBehindIt) {
  const std::vector<EnginePhrase>& phrases = engine_sentences();
  for (std::size_t a = 0; a < phrases.size(); ++a) {
    for (std::size_t b = a + 1; b < phrases.size(); ++b) {
      EXPECT_EQ(std::string(phrases[b].english).find(phrases[a].english), std::string::npos)
          << phrases[a].english << " stands before " << phrases[b].english;
    }
  }
}

TEST(EngineWords, WhatIsSaidOfPosesThatDoNotFitIsGerman) {
  EXPECT_EQ(
      translated(
          "scans 2 and 5 lie 0.31 mm apart where they overlap, more than noise explains; the mesh is less "
          "reliable, and may have a scan where the others fit it, not where its pose puts it; register "
          "them again",
          Language::kGerman),
      "die Scans 2 und 5 liegen 0,31 mm auseinander, wo sie sich überdecken, mehr als das Rauschen erklärt; "
      "das "
      "Netz ist weniger verlässlich und hat einen Scan vielleicht dort, wo die anderen zu ihm passen, nicht "
      "wo "
      "seine Lage ihn hinstellt; neu registrieren");
  EXPECT_EQ(
      translated(
          "3 of 12 pairs of scans lie apart where they overlap, by up to 0.31 mm, more than noise "
          "explains; the mesh is less reliable, and may have a scan where the others fit it, not where "
          "its pose puts it; register them again; at fault seem: a.ply (apart from 3 others, 0.30 mm off)",
          Language::kGerman),
      "3 von 12 Paaren von Scans liegen auseinander, wo sie sich überdecken, um bis zu 0,31 mm, mehr als das "
      "Rauschen erklärt; das Netz ist weniger verlässlich und hat einen Scan vielleicht dort, wo die anderen "
      "zu "
      "ihm passen, nicht wo seine Lage ihn hinstellt; neu registrieren; schuld sind wohl: a.ply (neben 3 "
      "anderen, 0,30 mm daneben)");
}

TEST(EngineWords, SentencesOfUnsureScansAreGerman) {
  EXPECT_EQ(
      translated("the surfaces agree in only 41 % of the overlap; scan again with more overlap, or click "
                 "three points on both scans",
                 Language::kGerman),
      "die Flächen stimmen überein in nur 41 % der Überlappung; mit mehr Überlappung neu scannen, oder "
      "drei Stellen in beiden Scans anklicken");
  EXPECT_EQ(
      translated("it contradicts the stage's pose; check that the tablet did not move between the scans",
                 Language::kGerman),
      "er widerspricht der Stellung des Tisches; nachsehen, ob sich die Tafel zwischen den Scans bewegt "
      "hat");
  EXPECT_EQ(
      translated("the tablet or the scanner moved during the scan, after about 52 % of it, by 0.2 degrees "
                 "and 0.15 mm; drop it and scan again",
                 Language::kGerman),
      "die Tafel oder der Scanner hat sich beim Scannen bewegt, nach etwa 52 % davon, um 0,2 Grad und 0,15 "
      "mm; "
      "ihn entfernen und neu scannen");
  EXPECT_EQ(translated("scan 4 is taken out", Language::kGerman), "Scan 4 ist entfernt");
  EXPECT_EQ(translated("the pins of scan 2 have no labels by hand any more", Language::kGerman),
            "die Nadeln von Scan 2 haben keine Namen von Hand mehr");
  EXPECT_EQ(translated("what can be read of that scan is stored; all of its files stay in "
                       "grids/unfinished/1.damaged-1",
                       Language::kGerman),
            "was von diesem Scan lesbar ist, ist gespeichert; alle seine Dateien bleiben in "
            "grids/unfinished/1.damaged-1");
}

}  // namespace
}  // namespace dubsar::ui

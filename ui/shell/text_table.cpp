// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/text_table.h"

#include <iterator>

namespace dubsar::ui {

namespace {

struct Row {
  Text text;
  const char* english;
  const char* german;
};

constexpr Row kRows[] = {
    {Text::kTitle, "Dubsar", "Dubsar"},
    {Text::kLayTablet, "Lay the tablet before the scanner, then scan",
     "Tafel vor den Scanner legen, dann scannen"},
    {Text::kChooseDevice, "Choose a scanner", "Scanner wählen"},
    {Text::kReading, "Reading the session", "Sitzung wird gelesen"},
    {Text::kOpening, "Opening the scanner", "Scanner wird geöffnet"},
    {Text::kMoving, "Hands off: the scanner moves", "Hände weg: der Scanner fährt"},
    {Text::kScanning, "Hands off: scanning", "Hände weg: es wird gescannt"},
    {Text::kJudging, "Working out where this scan belongs", "Es wird ermittelt, wohin dieser Scan gehört"},
    {Text::kFinishing, "Nearly done: mesh, wedges and pages are made",
     "Fast fertig: Netz, Keile und Seiten entstehen"},
    {Text::kSigning, "Checking every byte, then signing", "Jedes Byte wird geprüft, dann unterschrieben"},
    {Text::kStillRed, "{:.1f} mm2 are still red: scan on", "{:.1f} mm2 sind noch rot: weiter scannen"},
    {Text::kStoredScans, "{} scans are stored: go on", "{} Scans sind gespeichert: weiter"},
    {Text::kConclusive, "Conclusive: nothing is missing. Sign it",
     "Vollständig: nichts fehlt. Unterschreiben"},
    {Text::kSigned, "Signed by {}", "Unterschrieben von {}"},
    {Text::kSignedNext, "The tablet can go back into its box.", "Die Tafel kann zurück in ihre Schachtel."},
    {Text::kStopped, "Stopped", "Angehalten"},
    {Text::kUnsureScan, "Scan {} is unsure", "Scan {} ist unsicher"},
    {Text::kUnsureHow, "Show the same places in two scans, or scan on.",
     "Gleiche Stellen in zwei Scans zeigen, oder weiter scannen."},
    {Text::kTurnThenScan, "Turn the tablet as shown, then scan.",
     "Die Tafel wie gezeigt drehen, dann scannen."},
    {Text::kScanAsItLies, "The tablet stays as it lies.", "Die Tafel bleibt liegen."},
    {Text::kScan, "Scan", "Scannen"},
    {Text::kUndo, "Undo", "Zurück"},
    {Text::kSign, "Sign", "Unterschreiben"},
    {Text::kFinish, "Finish", "Abschließen"},
    {Text::kStop, "Stop", "Anhalten"},
    {Text::kGoOn, "Go on", "Weiter"},
    {Text::kHandsOff, "Hands off", "Hände weg"},
    {Text::kChecklist, "Checklist", "Prüfliste"},
    {Text::kObverse, "Obverse", "Vorderseite"},
    {Text::kReverse, "Reverse", "Rückseite"},
    {Text::kLeft, "Left edge", "Linker Rand"},
    {Text::kRight, "Right edge", "Rechter Rand"},
    {Text::kTop, "Top edge", "Oberer Rand"},
    {Text::kBottom, "Bottom edge", "Unterer Rand"},
    {Text::kRedArea, "{:.1f} mm2 red", "{:.1f} mm2 rot"},
    {Text::kExcused, "{:.1f} mm2 excused", "{:.1f} mm2 entschuldigt"},
    {Text::kRedRim, "red at its rim", "rot am Rand"},
    {Text::kNoArea, "not seen yet", "noch nicht gesehen"},
    {Text::kModel, "Model so far", "Modell bis jetzt"},
    {Text::kScanGrowing, "Scan", "Scan"},
    {Text::kNextPose, "Next", "Als Nächstes"},
    {Text::kScans, "Scans", "Scans"},
    {Text::kRegistered, "fits", "passt"},
    {Text::kUnsure, "unsure", "unsicher"},
    {Text::kFailed, "no place", "ohne Platz"},
    {Text::kDropped, "taken out", "entfernt"},
    {Text::kDamaged, "damaged", "beschädigt"},
    {Text::kJudged, "...", "..."},
    {Text::kLocked, "locked", "fest"},
    {Text::kDrop, "Take out", "Entfernen"},
    {Text::kRestore, "Put back", "Zurückholen"},
    {Text::kRescan, "Scan again", "Neu scannen"},
    {Text::kLock, "Lock", "Festhalten"},
    {Text::kUnlock, "Unlock", "Lösen"},
    {Text::kPointPairs, "Show same places", "Gleiche Stellen zeigen"},
    {Text::kWithdraw, "Withdraw hint", "Hinweis zurückziehen"},
    {Text::kTablet, "Tablet", "Tafel"},
    {Text::kMuseumNumber, "Museum number", "Museumsnummer"},
    {Text::kCdli, "CDLI number", "CDLI-Nummer"},
    {Text::kCollection, "Collection", "Sammlung"},
    {Text::kOperator, "Operator", "Bearbeiter"},
    {Text::kNotes, "Notes", "Notizen"},
    {Text::kCdliWrong, "a P and six digits, such as P123456", "ein P und sechs Ziffern, etwa P123456"},
    {Text::kKept, "Everything is kept as soon as it is said: there is no Save.",
     "Alles wird sofort aufgehoben: Speichern gibt es nicht."},
    {Text::kDevice, "Scanner", "Scanner"},
    {Text::kSettings, "Settings", "Einstellungen"},
    {Text::kView, "Viewer", "Betrachter"},
    {Text::kClose, "Close", "Schließen"},
    {Text::kUse, "Use this scanner", "Diesen Scanner nehmen"},
    {Text::kLookAgain, "Look again", "Neu suchen"},
    {Text::kFound, "Found", "Gefunden"},
    {Text::kNothingFound, "nothing is plugged in", "nichts angeschlossen"},
    {Text::kAddress, "Address", "Adresse"},
    {Text::kLanguage, "Language", "Sprache"},
    {Text::kDark, "Dark", "Dunkel"},
    {Text::kFontSize, "Size of text", "Schriftgröße"},
    {Text::kColourBlind, "Blue in place of red", "Blau statt Rot"},
    {Text::kSound, "Tones when done or failed", "Töne, wenn fertig oder misslungen"},
    {Text::kClickSamePlace,
     "Click the same place in both pictures, three times or more. One or two choose among the fits.",
     "Dieselbe Stelle in beiden Bildern anklicken, dreimal oder öfter. Eine oder zwei wählen unter den "
     "Lagen."},
    {Text::kInUnsure, "Scan {} (unsure)", "Scan {} (unsicher)"},
    {Text::kInOther, "Scan {} (fits)", "Scan {} (passt)"},
    {Text::kPairsDone, "Use these places", "Diese Stellen nehmen"},
    {Text::kPairsClear, "Start again", "Von vorn"},
    {Text::kPairCount, "{} pairs", "{} Paare"},
    {Text::kLabelPins, "Label pins", "Nadeln benennen"},
    {Text::kLabelPinsHow,
     "Choose a number, then click the tip of that pin in each picture. Letters are for places on the rim "
     "that "
     "you know again. Three that two scans share tell how they lie.",
     "Eine Nummer wählen, dann die Spitze dieser Nadel in jedem Bild anklicken. Buchstaben stehen für "
     "Stellen "
     "am Rand, die man wiedererkennt. Drei gemeinsame sagen, wie zwei Scans liegen."},
    {Text::kUseLabels, "Use these labels", "Diese Namen nehmen"},
    {Text::kTipDiameter, "Tip, mm", "Spitze, mm"},
    {Text::kPinsLabelled, "{} pins labelled", "{} Nadeln benannt"},
    {Text::kCamera, "Camera", "Kamera"},
    {Text::kNoPicture, "No picture comes now. While a scan runs the camera is the scan's.",
     "Gerade kommt kein Bild. Während ein Scan läuft, gehört ihm die Kamera."},
    {Text::kHatchLegend, "Orange hatch, rising: saturated. Blue hatch, falling: too dark.",
     "Orange schraffiert, steigend: übersteuert. Blau, fallend: zu dunkel."},
    {Text::kStripeGood, "exposure good: {:.1f} percent of the stripe saturated, {:.1f} percent weak",
     "Belichtung gut: {:.1f} Prozent des Streifens übersteuert, {:.1f} Prozent schwach"},
    {Text::kStripeTooLong, "exposure too long: {:.1f} percent of the stripe saturated",
     "zu lange belichtet: {:.1f} Prozent des Streifens übersteuert"},
    {Text::kStripeTooShort, "exposure too short: {:.1f} percent of the stripe too weak",
     "zu kurz belichtet: {:.1f} Prozent des Streifens zu schwach"},
    {Text::kPhotographGood, "exposure good, no stripe in view: {:.1f} percent of the picture saturated",
     "Belichtung gut, kein Streifen im Bild: {:.1f} Prozent des Bildes übersteuert"},
    {Text::kPhotographTooLong, "exposure too long: {:.1f} percent of the picture saturated",
     "zu lange belichtet: {:.1f} Prozent des Bildes übersteuert"},
    {Text::kPhotographTooShort, "exposure too short, or no light: the picture is dark",
     "zu kurz belichtet, oder kein Licht: das Bild ist dunkel"},
    {Text::kPutSetting, "Set", "Setzen"},
    {Text::kNoSettings, "The device has nothing to set.", "An dem Gerät ist nichts einzustellen."},
    {Text::kSettingsKept, "What is set is kept with the session, and put again when it goes on.",
     "Was gesetzt ist, bleibt bei der Sitzung und gilt wieder, wenn sie weitergeht."},
    {Text::kMeasuring, "Hands off: it is being measured", "Hände weg: es wird gemessen"},
    {Text::kVerifyFirst, "The rig was not measured today: first measure the artefact (Calibration).",
     "Das Gerät wurde heute nicht geprüft: zuerst den Prüfkörper messen (Kalibrierung)."},
    {Text::kNeverVerified, "never measured with this calibration", "mit dieser Kalibrierung nie geprüft"},
    {Text::kVerifiedBadly, "failed when last measured", "bei der letzten Prüfung durchgefallen"},
    {Text::kVerifiedLongAgo, "last measured {:.0f} days ago: due",
     "zuletzt vor {:.0f} Tagen geprüft: fällig"},
    {Text::kVerifiedToday, "measured {:.0f} hours ago", "vor {:.0f} Stunden geprüft"},
    {Text::kVerifyPage, "Measure the artefact", "Prüfkörper messen"},
    {Text::kCalibratePage, "Calibrate", "Kalibrieren"},
    {Text::kVerifyHow,
     "Every day before the first tablet: lay the artefact where tablets lie and measure it. One scan is "
     "judged by its certificate, and the outcome goes into the log of the calibration.",
     "Jeden Tag vor der ersten Tafel: den Prüfkörper an die Stelle der Tafeln legen und messen. Ein Scan "
     "wird "
     "an seinem Zertifikat gemessen, das Ergebnis kommt ins Protokoll der Kalibrierung."},
    {Text::kArtefactFile, "Artefact (artefact.toml)", "Prüfkörper (artefact.toml)"},
    {Text::kVerifyScan, "Scanner, or a scan of it", "Scanner, oder ein Scan davon"},
    {Text::kCalibrationFile, "Calibration (calibration.json)", "Kalibrierung (calibration.json)"},
    {Text::kVerifyNow, "Measure", "Messen"},
    {Text::kBallLine, "ball {}: form {:.1f} um, size {:+.1f} um, {} samples",
     "Kugel {}: Form {:.1f} um, Größe {:+.1f} um, {} Messpunkte"},
    {Text::kSpacingLine, "balls {} and {}: spacing {:+.1f} um", "Kugeln {} und {}: Abstand {:+.1f} um"},
    {Text::kFlatnessLine, "plane: flatness {:.1f} um", "Ebene: Ebenheit {:.1f} um"},
    {Text::kVerifyPassed, "passed", "bestanden"},
    {Text::kVerifyFailed, "FAILED", "DURCHGEFALLEN"},
    {Text::kCalibrateHow,
     "For each pose of the board, which stays where it is: one picture of it lit, one with the laser on, one "
     "with the laser off. Then the board on the stage, at several positions. Then work it out: what is next "
     "stands below.",
     "Für jede Lage der Tafel mit dem Muster, die liegen bleibt: ein Bild beleuchtet, eines mit Laser, eines "
     "ohne. Dann das Muster auf dem Tisch, an mehreren Stellungen. Dann auswerten: was als Nächstes kommt, "
     "steht unten."},
    {Text::kPictureFolder, "Folder of the pictures", "Ordner der Bilder"},
    {Text::kBoard, "Board (chessboard:9x6:25, charuco:9x7:5:3.7)",
     "Muster (chessboard:9x6:25, charuco:9x7:5:3.7)"},
    {Text::kShotBoard, "Board", "Muster"},
    {Text::kShotLaser, "Laser on", "Laser an"},
    {Text::kShotDark, "Laser off", "Laser aus"},
    {Text::kShotStop, "On the stage, at", "Auf dem Tisch, bei"},
    {Text::kCalibrateNow, "Work it out", "Auswerten"},
    {Text::kCalibrateKeep, "Keep", "Aufheben"},
    {Text::kCameraLine, "camera: corners off by {:.3f} px, {:.1f} um on the board, from {} pictures",
     "Kamera: Ecken auf {:.3f} px, {:.1f} um auf dem Muster, aus {} Bildern"},
    {Text::kLaserLine, "laser: stripe off by {:.3f} px, {:.1f} um, from {} pictures",
     "Laser: Streifen auf {:.3f} px, {:.1f} um, aus {} Bildern"},
    {Text::kVolumeLine, "points known to {:.1f} um against each other",
     "Punkte zueinander auf {:.1f} um bekannt"},
    {Text::kStageLine, "stage: board off by {:.1f} um at {} positions",
     "Tisch: Muster auf {:.1f} um an {} Stellungen"},
    {Text::kSignName, "Name", "Name"},
    {Text::kSignRole, "As", "Als"},
    {Text::kSignIncomplete, "Signed although incomplete, because", "Unvollständig unterschrieben, weil"},
    {Text::kSignNow, "Sign", "Unterschreiben"},
    {Text::kSignHint, "The session is read to the last byte and the verdict worked out anew.",
     "Die Sitzung wird bis zum letzten Byte gelesen und das Urteil neu ermittelt."},
    {Text::kStore, "Session", "Sitzung"},
    {Text::kStoreWhole, "whole", "unversehrt"},
    {Text::kStoreDamaged, "damaged or not checked", "beschädigt oder ungeprüft"},
    {Text::kDiskFree, "{:.0f} GiB free", "{:.0f} GiB frei"},
    {Text::kCalibration, "Calibration", "Kalibrierung"},
    {Text::kDaysOld, "{:.0f} days old", "{:.0f} Tage alt"},
    {Text::kNoCalibration, "the scanner tells none", "der Scanner nennt keine"},
    {Text::kNoModelYet, "The model grows here.", "Hier wächst das Modell."},
    {Text::kNoScanYet, "The scan grows here.", "Hier wächst der Scan."},
    {Text::kSamples, "{} samples", "{} Messpunkte"},
    {Text::kProfiles, "{} profiles", "{} Profile"},
    {Text::kTimeLeft, "about {:.0f} s left", "noch etwa {:.0f} s"},
    {Text::kUncertainty, "place good to {:.0f} um", "Lage auf {:.0f} um genau"},
    {Text::kLookClay, "Light", "Licht"},
    {Text::kOverlay, "Colours", "Farben"},
    {Text::kLamp, "Raking lamp (right drag)", "Streiflicht (rechts ziehen)"},
    {Text::kShadows, "Shadows", "Schatten"},
    {Text::kOcclusion, "Ambient occlusion", "Umgebungsverdeckung"},
    {Text::kRadiance, "Radiance scaling", "Radiance Scaling"},
    {Text::kDepthShading, "Depth shading", "Tiefenschattierung"},
    {Text::kFlat, "Flat faces", "Flache Dreiecke"},
    {Text::kOverlayClay, "Clay", "Ton"},
    {Text::kOverlayColours, "Own colours", "Eigene Farben"},
    {Text::kOverlayReliability, "Reliability", "Zuverlässigkeit"},
    {Text::kOverlayScans, "Scans that agree", "Übereinstimmende Scans"},
    {Text::kOverlayFlags, "Sparse and filled", "Dünn und gefüllt"},
    {Text::kOverlayCurvature, "Mean curvature, 1/mm", "Mittlere Krümmung, 1/mm"},
    {Text::kOverlayHeight, "Height over the free surface, mm", "Höhe über der freien Fläche, mm"},
    {Text::kOverlayOpenness, "Openness", "Offenheit"},
    {Text::kOverlaySigma, "Uncertainty, mm", "Unsicherheit, mm"},
    {Text::kOverlayMsii, "Integral invariant", "Integralinvariante"},
    {Text::kWedges, "Wedges", "Keile"},
    {Text::kNoWedges, "No wedges are known of this mesh.", "Von diesem Netz sind keine Keile bekannt."},
    {Text::kMeasure, "Measure", "Messen"},
    {Text::kMeasureHint, "Click two places.", "Zwei Stellen anklicken."},
    {Text::kPicture, "Keep a picture", "Bild aufheben"},
    {Text::kDpi, "dpi", "dpi"},
    {Text::kPictureKept, "kept: {}", "aufgehoben: {}"},
    {Text::kSixViews, "Views", "Ansichten"},
    {Text::kAnalyse, "Find wedges", "Keile suchen"},
    {Text::kAnalysing, "Looking for wedges", "Keile werden gesucht"},
    {Text::kFaces, "{} faces", "{} Dreiecke"},
    {Text::kVertices, "{} vertices", "{} Punkte"},
    {Text::kLeftOut, "{} broken faces are not drawn", "{} kaputte Dreiecke fehlen im Bild"},
    {Text::kGraphicsMemory, "{:.0f} MB of graphics memory", "{:.0f} MB Grafikspeicher"},
    {Text::kDepth, "Depth", "Tiefe"},
    {Text::kLength, "Length", "Länge"},
    {Text::kSelect, "Select", "Auswählen"},
    {Text::kSelectHint, "Draw a polygon; double click closes it.",
     "Vieleck zeichnen; Doppelklick schließt es."},
    {Text::kSelected, "{} faces, {:.1f} mm2", "{} Dreiecke, {:.1f} mm2"},
    {Text::kUnion, "Add", "Dazu"},
    {Text::kIntersect, "Both", "Beide"},
    {Text::kSubtract, "Without", "Ohne"},
    {Text::kVisibleOnly, "Only what is seen", "Nur Sichtbares"},
    {Text::kClear, "Clear", "Leeren"},
    {Text::kKeepSelection, "Keep as mesh", "Als Netz aufheben"},
    {Text::kBackToScan, "Back to scanning", "Zurück zum Scannen"},
    {Text::kOpenMesh, "The mesh is read", "Das Netz wird gelesen"},
    {Text::kSection, "Profile", "Profil"},
    {Text::kSectionHint, "Click two places: the surface is cut between them, straight down.",
     "Zwei Stellen anklicken: dazwischen wird senkrecht geschnitten."},
    {Text::kSectionLine, "{:.3f} mm long, {:.3f} mm deep", "{:.3f} mm lang, {:.3f} mm tief"},
    {Text::kSectionTimes, "heights drawn {:g} times", "Höhen {:g}-fach gezeichnet"},
    {Text::kKeepSection, "Keep CSV and SVG", "CSV und SVG aufheben"},
    {Text::kMove, "Turn", "Drehen"},
    {Text::kOrder, "Line", "Zeile"},
};

constexpr bool in_order() {
  for (std::size_t k = 0; k < std::size(kRows); ++k) {
    if (static_cast<std::size_t>(kRows[k].text) != k) {
      return false;
    }
  }
  return std::size(kRows) == static_cast<std::size_t>(Text::kCount);
}
static_assert(in_order(), "a row for each text, in the order of the enumeration");

}  // namespace

std::optional<Language> language_of(std::string_view code) {
  if (code == "en") {
    return Language::kEnglish;
  }
  return code == "de" ? std::optional(Language::kGerman) : std::nullopt;
}

const char* code_of(Language language) {
  return language == Language::kGerman ? "de" : "en";
}

const char* text_of(Text text, Language language) {
  const Row& row = kRows[static_cast<std::size_t>(text)];
  return language == Language::kGerman ? row.german : row.english;
}

}  // namespace dubsar::ui

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the engine says, in other languages: phrase by phrase, for its sentences are put together of them. The
// test engine_words holds every phrase against the source that says it.
#include "ui/shell/engine_words.h"

#include <array>

#include "ui/shell/text_table.h"

namespace dubsar::ui {

namespace {

/// Where one phrase holds another it stands first.
constexpr EnginePhrase kPhrases[] = {
    // where to turn the tablet
    {"turn the obverse towards the camera", "die Vorderseite zur Kamera drehen"},
    {"turn the reverse towards the camera", "die Rückseite zur Kamera drehen"},
    {"turn the left edge towards the camera", "den linken Rand zur Kamera drehen"},
    {"turn the right edge towards the camera", "den rechten Rand zur Kamera drehen"},
    {"turn the top edge towards the camera", "den oberen Rand zur Kamera drehen"},
    {"turn the bottom edge towards the camera", "den unteren Rand zur Kamera drehen"},
    {"; then ", "; dann "},
    {"turntable to", "Drehteller auf"},
    {"tilt to", "Neigung auf"},
    // the emergency stop
    {"the emergency stop was pressed: lasers are off and nothing moves",
     "der Not-Halt wurde gedrückt: die Laser sind aus, nichts bewegt sich"},
    {"see that all is clear, then scan: a stage with switches is homed first",
     "nachsehen, dass alles frei ist, dann scannen: ein Tisch mit Schaltern fährt sie zuerst an"},
    // why a scan is unsure
    {"no overlap with the registered scans was found; scan again with at least 30 % overlap",
     "keine Überlappung mit den eingepassten Scans gefunden; mit mindestens 30 % Überlappung neu scannen"},
    {" of it overlaps the registered scans; scan again with at least 30 % overlap",
     " davon überlappen die eingepassten Scans; mit mindestens 30 % Überlappung neu scannen"},
    {"the surfaces lie farther apart than noise explains; scan again with more overlap, or check that "
     "nothing "
     "moved during the scan",
     "die Flächen liegen weiter auseinander, als Rauschen erklärt; mit mehr Überlappung neu scannen, oder "
     "nachsehen, ob sich beim Scannen etwas bewegt hat"},
    {"the surfaces agree in only ", "die Flächen stimmen überein in nur "},
    {" of the overlap; scan again with more overlap, or click three points on both scans",
     " der Überlappung; mit mehr Überlappung neu scannen, oder drei Stellen in beiden Scans anklicken"},
    {" of it would stand where another scan saw through; click three points on both scans, or take away what "
     "moved",
     " davon stünden, wo ein anderer Scan hindurchsah; drei Stellen in beiden Scans anklicken, oder "
     "wegnehmen, "
     "was sich bewegt hat"},
    {" of the surface that one scan shows is missing from another that looked there; scan again with more "
     "overlap, or click three points on both scans",
     " der Fläche, die ein Scan zeigt, fehlen einem anderen, der dort hinsah; mit mehr Überlappung neu "
     "scannen, "
     "oder drei Stellen in beiden Scans anklicken"},
    {"the overlap is too even: the scan can turn on it",
     "die Überlappung ist zu eben: der Scan kann sich darauf drehen"},
    {"the overlap is too even: the scan can slide on it",
     "die Überlappung ist zu eben: der Scan kann darauf gleiten"},
    {"; scan again with an edge or more relief in the overlap, or use pins",
     "; neu scannen, mit einer Kante oder mehr Relief in der Überlappung, oder mit Nadeln"},
    {"two poses fit, ", "zwei Lagen passen, um "},
    {" degrees apart; click one point on both scans",
     " Grad verschieden; eine Stelle in beiden Scans anklicken"},
    {"nothing in it resembles the registered scans; scan again with at least 30 % overlap, or click three "
     "points "
     "on both scans",
     "nichts darin gleicht den eingepassten Scans; mit mindestens 30 % Überlappung neu scannen, oder drei "
     "Stellen in beiden Scans anklicken"},
    {"too little is written or broken in the overlap to tell this pose from others; scan again with more "
     "overlap, use pins, or click one point on both scans",
     "in der Überlappung ist zu wenig geschrieben oder gebrochen, um diese Lage von anderen zu "
     "unterscheiden; "
     "mit mehr Überlappung neu scannen, Nadeln nehmen, oder eine Stelle in beiden Scans anklicken"},
    {"it fits other scans, but not the largest group; scan what connects them, with at least 30 % overlap",
     "er passt zu anderen Scans, aber nicht zur größten Gruppe; scannen, was sie verbindet, mit mindestens "
     "30 % "
     "Überlappung"},
    {"it connects scans that contradict each other; one of them moved while it was scanned, or lies wrong: "
     "take "
     "that one out, or scan again what connects them",
     "er verbindet Scans, die sich widersprechen; einer davon hat sich beim Scannen bewegt oder liegt "
     "falsch: "
     "diesen entfernen, oder neu scannen, was sie verbindet"},
    {"the scan has no surface in it; scan it again", "im Scan ist keine Fläche; neu scannen"},
    {"too few of its samples can be matched; scan it again, nearer or with more of the surface in view",
     "zu wenige seiner Messpunkte lassen sich zuordnen; neu scannen, näher oder mit mehr Fläche im Blick"},
    {"the hint led to no certain pose: ", "der Hinweis führte zu keiner sicheren Lage: "},
    {"it was not tried; run registration again", "er wurde nicht versucht; die Einpassung neu starten"},
    {"no pin's tip is seen: check the tips' diameter, and that pins stand clear of the tablet",
     "keine Nadelspitze ist zu sehen: den Durchmesser prüfen, und ob die Nadeln frei von der Tafel stehen"},
    {"the pins stand nearly in one line", "die Nadeln stehen fast in einer Linie"},
    {" of its pins can be told to be those of an earlier scan: leave at least ",
     " seiner Nadeln sind als die eines früheren Scans zu erkennen: mindestens "},
    {" pins standing from scan to scan, put back where they were",
     " Nadeln von Scan zu Scan stehen lassen, wieder an ihren Platz gestellt"},
    // what happened
    {"what is said of the tablet is kept", "was zur Tafel gesagt ist, ist aufgehoben"},
    {" is taken out", " ist entfernt"},
    {" is put back", " ist zurückgeholt"},
    {" has no hint any more", " hat keinen Hinweis mehr"},
    {" has a hint", " hat einen Hinweis"},
    {" is unlocked", " ist gelöst"},
    {" is locked", " ist festgehalten"},
    {"the pins of scan ", "die Nadeln von Scan "},
    {" are labelled", " sind benannt"},
    {"there is no scan to undo", "es gibt keinen Scan zurückzunehmen"},
    {" scans are there, as many as were to be taken; --max-scans allows more",
     " Scans sind da, so viele, wie zu machen waren; --max-scans erlaubt mehr"},
    {"the half scan is kept: ", "der halbe Scan ist aufgehoben: "},
    {" is not taken up: ", " wird nicht aufgenommen: "},
    {"; the same view is scanned once more", "; dieselbe Ansicht wird noch einmal gescannt"},
    {"; the next view shows more of what is known",
     "; die nächste Ansicht zeigt mehr von dem, was bekannt ist"},
    {"; it is set aside (session restore puts it back)",
     "; er ist beiseitegelegt (ein Klick holt ihn zurück)"},
    {"something was in the way of scan ", "etwas war im Weg von Scan "},
    {"something was in the way", "etwas war im Weg"},
    {"the scan has no sample at all: nothing stands before the scanner",
     "der Scan hat keinen Messpunkt: nichts steht vor dem Scanner"},
    {"see that the tablet lies in the measuring field, then give the same command again",
     "nachsehen, ob die Tafel im Messfeld liegt, dann weiter"},
    {"see that it is the right tablet, that no hand is in view and that nothing moved, then give the same "
     "command again",
     "nachsehen, ob es die richtige Tafel ist, keine Hand im Bild ist und sich nichts bewegt hat, dann "
     "weiter"},
    {"take the wrong ones out (session drop), then give the same command again",
     "die falschen entfernen, dann weiter"},
    {" scans in a row are not taken up, scan ", " Scans nacheinander werden nicht aufgenommen, Scan "},
    {" because ", ", denn "},
    {"kept: ", "aufgehoben: "},
    // why a package is not made
    {"something lies there already", "dort liegt schon etwas"},
    {"choose another folder, or replace it with --force", "einen anderen Ordner wählen"},
    {"a session keeps a checksum of every file in it; nothing else is written there",
     "eine Sitzung hat eine Prüfsumme für jede ihrer Dateien; anderes wird nicht hineingeschrieben"},
    {"write it beside the session: ", "neben die Sitzung schreiben: "},
    // why a wedge is not what somebody says
    {"no wedge lies at ", "kein Keil liegt bei "},
    {" any more", " mehr"},
    {"these are one wedge already", "das ist schon ein Keil"},
    {"they are not measured as one wedge: ", "sie lassen sich nicht als ein Keil messen: "},
    {"no one wedge holds them all: wedge ", "kein Keil enthält sie alle: Keil "},
    {" stays outside", " bleibt draußen"},
    {"one of the places does not lie in the wedge: number ", "eine der Stellen liegt nicht im Keil: Nummer "},
    {"one of the parts is not measured as a wedge, number ",
     "einer der Teile lässt sich nicht als Keil messen, Nummer "},
    {"other wedges lie there: delete or split them first",
     "dort liegen andere Keile: zuerst sie entfernen oder teilen"},
    {"no wedge is measured there: ", "dort lässt sich kein Keil messen: "},
    {"too few vertices of the mesh", "zu wenige Punkte des Netzes"},
    {"too few faces of the mesh", "zu wenige Flächen des Netzes"},
    {"nothing of the clay lies on its faces", "auf seinen Flächen liegt nichts vom Ton"},
    {"too large a hollow", "die Vertiefung ist zu groß"},
    {"too shallow", "zu flach"},
    {"no free surface above it", "keine freie Oberfläche darüber"},
    {"its faces do not close to a pit", "seine Flächen schließen sich nicht zu einer Grube"},
    {"an opening angle is out of bounds", "ein Öffnungswinkel liegt außerhalb der Grenzen"},
    {"an inner edge does not rise", "eine innere Kante steigt nicht an"},
    {"its normals do not gather in three faces", "seine Normalen sammeln sich nicht in drei Flächen"},
    {"one of its faces has no vertices", "eine seiner Flächen hat keine Punkte"},
    {"one of its faces is too small", "eine seiner Flächen ist zu klein"},
    // why an artefact fails
    {"not all balls were found: ", "nicht alle Kugeln wurden gefunden: "},
    {", and the artefact has ", ", und der Prüfkörper hat "},
    {"the plane was not found", "die Ebene wurde nicht gefunden"},
    {"the plane was seen over ", "die Ebene wurde gesehen über "},
    {" mm only, and it has ", " mm, und sie hat "},
    {"probing error (form) of ball ", "Antastabweichung (Form) der Kugel "},
    {"probing error (size) of ball ", "Antastabweichung (Größe) der Kugel "},
    {"sphere spacing error of balls ", "Abstandsabweichung der Kugeln "},
    {"flatness error", "Ebenheitsabweichung"},
    {", the limit ", ", die Grenze "},
    // what a calibration lacks
    {"tilt the board by 25 to 40° so that its right side in the picture comes nearer",
     "das Muster um 25 bis 40° neigen, sodass seine rechte Seite im Bild näher kommt"},
    {"tilt the board by 25 to 40° so that its left side in the picture comes nearer",
     "das Muster um 25 bis 40° neigen, sodass seine linke Seite im Bild näher kommt"},
    {"tilt the board by 25 to 40° so that its lower side in the picture comes nearer",
     "das Muster um 25 bis 40° neigen, sodass seine untere Seite im Bild näher kommt"},
    {"tilt the board by 25 to 40° so that its upper side in the picture comes nearer",
     "das Muster um 25 bis 40° neigen, sodass seine obere Seite im Bild näher kommt"},
    {"show the board in the upper left corner of the picture",
     "das Muster in der oberen linken Ecke des Bildes zeigen"},
    {"show the board in the upper edge of the picture", "das Muster am oberen Rand des Bildes zeigen"},
    {"show the board in the upper right corner of the picture",
     "das Muster in der oberen rechten Ecke des Bildes zeigen"},
    {"show the board in the left edge of the picture", "das Muster am linken Rand des Bildes zeigen"},
    {"show the board in the middle of the picture", "das Muster in der Mitte des Bildes zeigen"},
    {"show the board in the right edge of the picture", "das Muster am rechten Rand des Bildes zeigen"},
    {"show the board in the lower left corner of the picture",
     "das Muster in der unteren linken Ecke des Bildes zeigen"},
    {"show the board in the lower edge of the picture", "das Muster am unteren Rand des Bildes zeigen"},
    {"show the board in the lower right corner of the picture",
     "das Muster in der unteren rechten Ecke des Bildes zeigen"},
    {"show the laser on the board at the upper side of the picture",
     "den Laser auf dem Muster oben im Bild zeigen"},
    {"show the laser on the board at the lower side of the picture",
     "den Laser auf dem Muster unten im Bild zeigen"},
    {"show the laser on the board at the left side of the picture",
     "den Laser auf dem Muster links im Bild zeigen"},
    {"show the laser on the board at the right side of the picture",
     "den Laser auf dem Muster rechts im Bild zeigen"},
    {"show the laser on the board at different distances and tilts",
     "den Laser auf dem Muster in verschiedenen Abständen und Neigungen zeigen"},
    {"show the laser on the board ", "den Laser auf dem Muster zeigen, "},
    {" mm nearer to the camera", " mm näher an der Kamera"},
    {" mm farther from the camera", " mm weiter von der Kamera"},
    {"take pictures with the laser on the board, bright but not saturated",
     "Bilder mit dem Laser auf dem Muster aufnehmen, hell, aber nicht übersteuert"},
    {"take pictures with the laser on the board", "Bilder mit dem Laser auf dem Muster aufnehmen"},
    {"take more pictures of the board, each tilted another way: ",
     "mehr Bilder des Musters aufnehmen, jedes anders geneigt: "},
    {"take more pictures of the board: see which poses are asked for",
     "mehr Bilder des Musters aufnehmen: welche Lagen fehlen, steht da"},
    {"take more pictures of the board: tilted to each side, near and far, in every corner",
     "mehr Bilder des Musters aufnehmen: nach jeder Seite geneigt, nah und fern, in jeder Ecke"},
    {"let the mirror go from ", "den Spiegel gehen lassen von "},
    {"°, as far as the stripe stays in the picture, and show the board where the stripe is: ",
     "°, so weit der Streifen im Bild bleibt, und das Muster zeigen, wo der Streifen ist: "},
    {" poses, by turns at both ends and in the middle (the axis is known to ",
     " Lagen, abwechselnd an beiden Enden und in der Mitte (die Achse ist bekannt auf "},
    {"° are wanted)", "° sind nötig)"},
    {"° to ", "° bis "},
    {": too few corners", ": zu wenige Ecken"},
    {": its corners are off by ", ": seine Ecken weichen ab um "},
    {" px, those of the others by ", " px, die der anderen um "},
    {"too few corners of the board were found, ", "zu wenige Ecken des Musters gefunden, "},
    {"the picture is overexposed", "das Bild ist überbelichtet"},
    {"the picture is dark", "das Bild ist dunkel"},
    {"the picture is blurred", "das Bild ist unscharf"},
    {"the board is not the one that was named, or not wholly in sight",
     "das Muster ist nicht das genannte, oder nicht ganz zu sehen"},
    {"the stripe points all lie on one line", "die Punkte des Laserstreifens liegen alle auf einer Linie"},
    {"the stripe points nearly lie on one line, which leaves the laser plane open",
     "die Punkte des Laserstreifens liegen fast auf einer Linie, was die Laserebene offen lässt"},
    // a mesh of others
    {"it lies ", "es liegt "},
    {" mm from the origin of its numbers, where places are good to ",
     " mm vom Ursprung seiner Zahlen, wo Orte so genau sind: "},
    {"export it again with its middle at the origin", "noch einmal mit der Mitte im Ursprung ausgeben"},
    {" mm large, perhaps its numbers are metres", " mm groß, vielleicht sind seine Zahlen Meter"},
    {"dubsar mesh convert --unit m makes millimetres of them",
     "dubsar mesh convert --unit m macht Millimeter daraus"},
};

/// What is under way. Single words, some of them: they are replaced where they are all that is said, for
/// within a sentence they may be a file's name.
constexpr EnginePhrase kStages[] = {
    {"reading scans", "Scans werden gelesen"},
    {"reading the session", "Sitzung wird gelesen"},
    {"registering", "Scans werden eingepasst"},
    {"relax", "Lagen werden ausgeglichen"},
    {"red map", "Rote Stellen werden gesucht"},
    {"clearing", "Rote Stellen werden geprüft"},
    {"pins: views", "Nadeln: Ansichten"},
    {"pins: search", "Nadeln: Suche"},
    {"pins: counting", "Nadeln: Zählung"},
    {"pins: proof", "Nadeln: Probe"},
    {"stitching", "Netz wird genäht"},
    {"pair samples", "Messpunkte werden gepaart"},
    {"average samples", "Messpunkte werden gemittelt"},
    {"assign primary scans", "Flächen werden den Scans zugeteilt"},
    {"cover what is left", "Reste werden bedeckt"},
    {"triangulate grids", "Raster werden vernetzt"},
    {"join patches", "Stücke werden verbunden"},
    {"close seams", "Nähte werden geschlossen"},
    {"repair intersections", "Durchdringungen werden behoben"},
    {"finish mesh", "Netz wird fertig"},
    {"surface fields", "Flächenmaße entstehen"},
    {"ambient occlusion", "Umgebungsverdeckung entsteht"},
    {"watershed", "Keile werden gesucht"},
    {"wedges", "Keile werden gemessen"},
    {"judging", "Keile werden beurteilt"},
    {"integral invariants", "Integralinvarianten entstehen"},
    {"drawing views", "Ansichten werden gezeichnet"},
    {"drawing fatcrosses", "Tafelbilder werden gezeichnet"},
    {"drawing the rollout", "Abrollung wird gezeichnet"},
    {"pictures", "Bilder entstehen"},
    {"packing scans", "Scans werden gepackt"},
    {"packing the model", "Modell wird gepackt"},
    {"writing results", "Ergebnisse werden geschrieben"},
    {"checksums", "Prüfsummen"},
    {"verify", "Dateien werden geprüft"},
    {"repair", "Dateien werden wiederhergestellt"},
    {"board", "Muster wird gesucht"},
    {"stage", "Tisch fährt"},
};

}  // namespace

std::span<const EnginePhrase> engine_stages() {
  return kStages;
}

std::span<const EnginePhrase> engine_phrases() {
  return kPhrases;
}

std::string translated(const std::string& english, Language language) {
  if (language == Language::kEnglish) {
    return english;
  }
  for (const auto& [from, to] : kStages) {
    if (english == from) {
      return to;
    }
  }
  std::string out = english;
  for (const auto& [from, to] : kPhrases) {
    for (std::size_t at = out.find(from); at != std::string::npos; at = out.find(from, at)) {
      out.replace(at, std::string_view(from).size(), to);
      at += std::string_view(to).size();
    }
  }
  return out;
}

}  // namespace dubsar::ui

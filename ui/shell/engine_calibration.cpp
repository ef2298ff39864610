// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is said of calibrations and of certified artefacts, in other languages; phrase by phrase, as in
// engine_words.cpp.
#include "ui/shell/engine_words.h"

namespace dubsar::ui {

namespace {

constexpr EnginePhrase kCalibration[] = {
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
};

}  // namespace

std::span<const EnginePhrase> engine_calibration() {
  return kCalibration;
}

}  // namespace dubsar::ui

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What readers remark on the files of others, and what else is remarked, in other languages; phrase by
// phrase, as in engine_words.cpp.
#include "ui/shell/engine_words.h"

namespace dubsar::ui {

namespace {

constexpr EnginePhrase kRemarks[] = {
    // scans whose poses the mesh does not agree with
    {" overlaps no other scan where its pose puts it; look whether that pose is right",
     " überdeckt keinen anderen Scan, wo seine Lage ihn hinstellt; prüfen, ob diese Lage stimmt"},
    {" pairs of scans lie apart where they overlap, by up to ",
     " Paaren von Scans liegen auseinander, wo sie sich überdecken, um bis zu "},
    {" mm apart where they overlap, ", " mm auseinander, wo sie sich überdecken, "},
    {"more than noise explains; the mesh is less reliable, and may have a scan where the others fit it, not "
     "where its pose puts it; register them again",
     "mehr als das Rauschen erklärt; das Netz ist weniger verlässlich und hat einen Scan vielleicht dort, wo "
     "die anderen zu ihm passen, nicht wo seine Lage ihn hinstellt; neu registrieren"},
    {"; at fault seem: ", "; schuld sind wohl: "},
    {" mm off)", " mm daneben)"},
    // what is to be doubted in the wedges of a mesh
    {"several bodies in one mesh: each is measured as if it were alone, and place.body tells them apart; "
     "which side is which is told of all together",
     "mehrere Körper in einem Netz: jeder ist gemessen, als wäre er allein, und place.body hält sie "
     "auseinander; welche Seite welche ist, gilt für alle zusammen"},
    {"give each a file of its own where they do not lie alike",
     "jedem eine eigene Datei geben, wo sie nicht gleich liegen"},
    {"no direction of writing shows in the one wedge that was found",
     "in dem einen gefundenen Keil zeigt sich keine Schreibrichtung"},
    {"no direction of writing shows in the ", "keine Schreibrichtung zeigt sich in den "},
    {" wedges that were found", " gefundenen Keilen"},
    {": confidence was learnt on inscribed tablets, and hollows of rough clay may pass for wedges: look at "
     "them before you count them",
     ": die Sicherheit wurde an beschrifteten Tafeln gelernt, und Vertiefungen in rauem Ton können als Keile "
     "durchgehen: ansehen, bevor man sie zählt"},
    {"most of the wedges are worn (their edges are rounded: ",
     "die meisten Keile sind abgerieben (die Kanten sind gerundet: "},
    {"): depths and angles are those of the clay as it is, not of what was pressed",
     "): Tiefen und Winkel sind die des Tons, wie er ist, nicht die des Eindrucks"},
    {"leave them out to compare hands", "sie weglassen, um Hände zu vergleichen"},
    // how many of the wedges a distribution is of
    {"angles are read where a wedge is known to be whole and sharp",
     "Winkel werden abgelesen, wo ein Keil sicher ganz und scharf ist"},
    {"of the others the mesh ends before the edge does", "bei den anderen endet das Netz vor der Kante"},
    // what the reading of a scan remarks
    {" bytes follow what the header tells of and are passed over; export it again if something is missing",
     " Bytes folgen auf das, was der Kopf angibt, und werden übergangen; neu ausgeben, wenn etwas fehlt"},
    {"its header says a spacing of ", "sein Kopf nennt einen Punktabstand von "},
    {" mm, but its samples lie ", " mm, aber seine Messpunkte liegen "},
    {" mm, but neighbours in its rows lie ", " mm, aber Nachbarn in seinen Zeilen liegen "},
    {" mm apart: its rows and columns do not fit its samples; look at num_cols and num_rows",
     " mm auseinander: Zeilen und Spalten passen nicht zu den Messpunkten; num_cols und num_rows prüfen"},
    {" mm apart, which is taken; mend or remove `obj_info dubsar_spacing_mm`",
     " mm auseinander, und das gilt; `obj_info dubsar_spacing_mm` berichtigen oder entfernen"},
    {"the scanner would stand at 0 0 0, in the scanned surface: which way it looked is taken from the "
     "outline; better export it in the scanner's own frame",
     "der Scanner stünde bei 0 0 0, in der gescannten Fläche: wohin er sah, ist dem Umriss entnommen; besser "
     "im Rahmen des Scanners ausgeben"},
    {"its outline and the order of its rows and columns show that it was seen along ",
     "Umriss und Folge der Zeilen und Spalten zeigen, dass er so gesehen wurde: "},
    {", and so it is read; if that is wrong, write ", ", und so ist er gelesen; ist das falsch, schreiben: "},
    {"its outline rises towards the scanner: if z is measured away from the scanner, export z negated, or "
     "where only the order of its rows or columns is reversed write ",
     "sein Umriss steigt zum Scanner an: wird z vom Scanner weg gemessen, mit -z ausgeben; ist nur die Folge "
     "der Zeilen oder Spalten verkehrt, schreiben: "},
    {" in its header; else write ", " in seinen Kopf; sonst: "},
    {"its rows and columns show that its frame is not the scanner's: it is read as seen along ",
     "seine Zeilen und Spalten zeigen, dass sein Rahmen nicht der des Scanners ist: gelesen ist er entlang "},
    {"the scanner would stand at 0 0 0, but its rows and columns were not seen from there: which way it "
     "looked is taken from them; better export it in the scanner's own frame",
     "der Scanner stünde bei 0 0 0, aber seine Zeilen und Spalten wurden nicht von dort gesehen: wohin er "
     "sah, "
     "ist ihnen entnommen; besser im Rahmen des Scanners ausgeben"},
    {", though no outline settles from which side", ", wobei kein Umriss entscheidet, von welcher Seite"},
    {"; better export it in the scanner's own frame, or write ",
     "; besser im Rahmen des Scanners ausgeben, oder schreiben: "},
    {" in its header, with the direction from the scanner to the object",
     " in seinen Kopf, mit der Richtung vom Scanner zum Gegenstand"},
    {"its rows and columns run as if it was seen along ",
     "seine Zeilen und Spalten laufen wie gesehen entlang "},
    {", and no outline settles it: it is read as seen along ",
     ", und kein Umriss entscheidet es: gelesen ist er entlang "},
    {"; write one of them in its header: ", "; eins davon in seinen Kopf schreiben: "},
    {" in its header", " in seinen Kopf"},
    // what its device lost of it
    {"not all of it came as it was measured: ", "nicht alles kam so an, wie es gemessen wurde: "},
    {"rows lost: ", "verlorene Zeilen: "},
    {"rows that came twice: ", "doppelte Zeilen: "},
    {"rows of another length: ", "Zeilen anderer Länge: "},
    {"samples that are no places: ", "Messpunkte ohne Ort: "},
    // what its numbers are
    {"by its numbers it is about ", "nach seinen Zahlen ist er ungefähr "},
    {"by its numbers it is ", "nach seinen Zahlen ist er "},
    {" times smaller than the scans before it", "-mal kleiner als die Scans davor"},
    {" times larger than the scans before it", "-mal größer als die Scans davor"},
    {": they are in another unit", ": sie sind in einer anderen Einheit"},
    {" and look like metres", " und sehen nach Metern aus"},
    {"are metres, that is the wrong unit", "Meter sind, ist das die falsche Einheit"},
    {" and look like inches", " und sehen nach Zoll aus"},
    {"are inches, that is the wrong unit", "Zoll sind, ist das die falsche Einheit"},
    {" and look like centimetres", " und sehen nach Zentimetern aus"},
    {"are centimetres, that is the wrong unit", "Zentimeter sind, ist das die falsche Einheit"},
    {" and look like micrometres", " und sehen nach Mikrometern aus"},
    {"are micrometres, that is the wrong unit", "Mikrometer sind, ist das die falsche Einheit"},
    {", in size and in spacing: if they ", ", an Größe und Abstand: wenn sie "},
    {", in size and in spacing: if those of the others ", ", an Größe und Abstand: wenn die der anderen "},
    {"give its unit: --unit m for a folder, or `obj_info unit m` in its header",
     "seine Einheit angeben: ?unit=m hinter dem Ordner, oder `obj_info unit m` in seinem Kopf"},
    {"give its unit: --unit in for a folder, or `obj_info unit in` in its header",
     "seine Einheit angeben: ?unit=in hinter dem Ordner, oder `obj_info unit in` in seinem Kopf"},
    {"give its unit: --unit cm for a folder, or `obj_info unit cm` in its header",
     "seine Einheit angeben: ?unit=cm hinter dem Ordner, oder `obj_info unit cm` in seinem Kopf"},
    {"give its unit: --unit um for a folder, or `obj_info unit um` in its header",
     "seine Einheit angeben: ?unit=um hinter dem Ordner, oder `obj_info unit um` in seinem Kopf"},
    {"; a session keeps its unit: scan into a new one with that",
     "; eine Sitzung behält ihre Einheit: damit in eine neue scannen"},
    {"give the right --unit, or export it in millimetres",
     "die richtige ?unit= angeben, oder in Millimetern ausgeben"},
    {"it would be ", "er wäre "},
    {" mm across: its unit is ", " mm groß: seine Einheit ist "},
    {" times larger than was said; give ", "-mal größer als angegeben; richtig wäre "},
    {" times smaller than was said; give ", "-mal kleiner als angegeben; richtig wäre "},
    {"--unit m (metres) in place of mm, or --unit mm in place of um",
     "?unit=m (Meter) statt mm, oder ?unit=mm statt um"},
    {"--unit m in place of um", "?unit=m statt um"},
    {"--unit um (micrometres) in place of mm, or --unit mm in place of m",
     "?unit=um (Mikrometer) statt mm, oder ?unit=mm statt m"},
    {"--unit um in place of m", "?unit=um statt m"},
    {" (in a file's header: `obj_info unit`)", " (im Kopf einer Datei: `obj_info unit`)"},
    // a mesh of others
    {"it lies ", "es liegt "},
    {" mm from the origin of its numbers, where places are good to ",
     " mm vom Ursprung seiner Zahlen, wo Orte so genau sind: "},
    {"export it again with its middle at the origin", "noch einmal mit der Mitte im Ursprung ausgeben"},
    {" mm large, perhaps its numbers are ", " mm groß, vielleicht sind seine Zahlen in "},
    {"no unit makes a tablet of it: it is ", "keine Einheit macht eine Tafel daraus: es sind "},
    {"look what its numbers are, and make millimetres of them",
     "nachsehen, was seine Zahlen sind, und Millimeter daraus machen"},
    {"dubsar mesh convert --unit ", "noch einmal in Millimetern ausgeben, nicht in "},
    {" makes millimetres of them", ""},
    {"dubsar mesh convert --unit mm mends the file",
     "noch einmal mit Millimetern als seiner Einheit ausgeben"},
    {"as it stands it is ", "so, wie es dasteht, ist es "},
    {"its numbers are taken for ", "seine Zahlen gelten als "},
    {", by its size alone: ", ", nur nach seiner Größe: "},
    {"its wedges are not measured before it is said what its numbers are",
     "seine Keile werden erst gemessen, wenn gesagt ist, was seine Zahlen sind"},
    {"these wedges are not shown: only ", "diese Keile werden nicht gezeigt: nur "},
    {" % of them lie on this mesh, so they are another one's, or it was moved or has another unit since",
     " % davon liegen auf diesem Netz, sie gehören also zu einem anderen, oder es wurde seither verschoben "
     "oder "
     "hat eine andere Einheit"},
    {"measure them on this mesh", "sie auf diesem Netz messen"},
    // why a place is excused
    {"no pose that the rig allows has it within its field, unshaded for laser and camera, at a slope below "
     "70°",
     "keine Stellung, die das Gerät erlaubt, hat es im Messfeld, für Laser und Kamera frei, unter weniger "
     "als "
     "70° Neigung"},
    {" scans looked straight at it, each from elsewhere, and brought no dense samples: too dark, too shiny, "
     "too deep or no surface",
     " Scans sahen gerade darauf, jeder von anderswo, und brachten keine dichten Messpunkte: zu dunkel, zu "
     "glänzend, zu tief oder keine Fläche"},
    {" scans and more might have sampled it and did not, and no other pose promises to",
     " Scans und mehr hätten es erfassen können und taten es nicht, und keine andere Stellung verspricht es"},
    {"speck: scans looked straight at it and found nothing more",
     "Fleck: Scans sahen gerade darauf und fanden nichts weiter"},
    {"speck: the gap is no larger than the rule of 3µ lets pass, and closes in a straight line",
     "Fleck: die Lücke ist nicht größer, als die Regel von 3µ durchlässt, und schließt sich geradlinig"},
    {"speck: no view is expected to clear as much as one such speck",
     "Fleck: keine Ansicht brächte voraussichtlich so viel wie ein solcher Fleck"},
    {"slit or pit of less than a wedge's size: ", "Spalt oder Grube, kleiner als ein Keil: "},
    {"slit or pit of less than a wedge's size, one of more than may be passed over: ",
     "Spalt oder Grube, kleiner als ein Keil, eine von mehr, als übergangen werden dürfen: "},
    {"gives no signal, look at it: ", "gibt kein Signal, ansehen: "},
    {"gap of ", "Lücke von "},
    {" mm; its surroundings bend by ", " mm; ihre Umgebung weicht um "},
    {" µm from a quadric, interpolation good to ", " µm von einer Quadrik ab, gefüllt auf "},
    // what the checklist warns of, and when to stop
    {"its samples scatter by ", "seine Messpunkte streuen um "},
    {" µm, half of the other scans by no more than ", " µm, die Hälfte der anderen Scans um höchstens "},
    {" µm: clay that it alone saw is as noisy; take it out and scan that anew",
     " µm: Ton, den nur er sah, ist ebenso verrauscht; ihn entfernen und dort neu scannen"},
    {"three scans brought next to nothing of what is red: stop, look at it, or sign with --incomplete REASON",
     "drei Scans haben fast nichts von dem gebracht, was rot ist: aufhören, es ansehen, oder als "
     "unvollständig unterschreiben"},
    // what the window drops
    {"what was asked for meanwhile was not begun; ask for it again once nothing else is under way",
     "was inzwischen verlangt wurde, ist nicht begonnen; noch einmal verlangen, sobald nichts anderes läuft"},
};

}  // namespace

std::span<const EnginePhrase> engine_remarks() {
  return kRemarks;
}

}  // namespace dubsar::ui

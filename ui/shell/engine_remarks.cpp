// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What readers remark on the files of others, in other languages; phrase by phrase, as in engine_words.cpp.
#include "ui/shell/engine_words.h"

namespace dubsar::ui {

namespace {

/// Where one phrase holds another it stands first.
constexpr EnginePhrase kRemarks[] = {
    // what the reading of a scan remarks
    {"its header says a spacing of ", "sein Kopf nennt einen Punktabstand von "},
    {" mm, but its samples lie ", " mm, aber seine Messpunkte liegen "},
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
    {"its rows and columns run as if it was seen along ",
     "seine Zeilen und Spalten laufen wie gesehen entlang "},
    {", and no outline settles it: it is read as seen along ",
     ", und kein Umriss entscheidet es: gelesen ist er entlang "},
    {"; write one of them in its header: ", "; eins davon in seinen Kopf schreiben: "},
    {" in its header", " in seinen Kopf"},
    // a mesh of others
    {"it lies ", "es liegt "},
    {" mm from the origin of its numbers, where places are good to ",
     " mm vom Ursprung seiner Zahlen, wo Orte so genau sind: "},
    {"export it again with its middle at the origin", "noch einmal mit der Mitte im Ursprung ausgeben"},
    {" mm large, perhaps its numbers are metres", " mm groß, vielleicht sind seine Zahlen Meter"},
    {"dubsar mesh convert --unit m makes millimetres of them", "noch einmal in Millimetern ausgeben"},
};

}  // namespace

std::span<const EnginePhrase> engine_remarks() {
  return kRemarks;
}

}  // namespace dubsar::ui

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is said of stages and of the controllers on their serial lines, in other languages; phrase by phrase,
// as in engine_words.cpp.
#include "ui/shell/engine_words.h"

namespace dubsar::ui {

namespace {

constexpr EnginePhrase kControllers[] = {
    // the line to it
    {"no right to use the controller", "kein Recht, die Steuerung zu benutzen"},
    {"join the group plugdev, or copy 60-dubsar.rules to /etc/udev/rules.d; then plug it in again",
     "in die Gruppe plugdev eintreten, oder 60-dubsar.rules nach /etc/udev/rules.d kopieren; dann neu "
     "anstecken"},
    {"the controller is in use by another program", "ein anderes Programm benutzt die Steuerung"},
    {"close what talks to it, then try again", "schließen, was mit ihr spricht, dann noch einmal"},
    {"the controller was unplugged or is not there", "die Steuerung ist abgesteckt oder nicht da"},
    {"see to its cable, and that its laser is off", "nach ihrem Kabel sehen, und dass ihr Laser aus ist"},
    {"USB cannot be used here", "USB ist hier nicht benutzbar"},
    {"the controller cannot be opened", "die Steuerung lässt sich nicht öffnen"},
    {"the controller is no serial line of the standard kind (CDC-ACM)",
     "die Steuerung ist keine serielle Leitung der üblichen Art (CDC-ACM)"},
    {"the controller cannot be claimed", "die Steuerung lässt sich nicht übernehmen"},
    {"the controller takes no bytes", "die Steuerung nimmt nichts an"},
    {"the controller sends no bytes", "die Steuerung sendet nichts"},
    {"the controller says neither that it is GRBL nor that it is Horus",
     "die Steuerung meldet sich weder als GRBL noch als Horus"},
    {"give firmware=tmcl with its steps=, or see to its firmware",
     "firmware=tmcl mit steps= angeben, oder nach ihrer Firmware sehen"},
    {"the controller does not answer", "die Steuerung antwortet nicht"},
    {"see to its power and cable, and that its laser is off",
     "nach Strom und Kabel sehen, und dass ihr Laser aus ist"},
    {"the controller restarted", "die Steuerung ist neu angelaufen"},
    {"see to its power, then home it", "nach ihrem Strom sehen, dann Referenzfahrt"},
    {"see to its power", "nach ihrem Strom sehen"},
    {"no controller is named", "es ist keine Steuerung genannt"},
    {"write usb_stage:VID:PID, e.g. usb_stage:2341:0043; dubsar drivers lists them",
     "usb_stage:VID:PID schreiben, etwa usb_stage:2341:0043; unter Scanner steht, was da ist"},
    {"a stage alone makes no scans", "ein Tisch allein macht keine Scans"},
    // what it refuses
    {"the controller refuses to move: ", "die Steuerung will nicht fahren: "},
    {"the controller refuses command ", "die Steuerung lehnt den Befehl ab: "},
    {"see that it is a motion module of Trinamic's", "nachsehen, ob sie ein Achsmodul von Trinamic ist"},
    {"the controller refuses ", "die Steuerung lehnt ab: "},
    {"home it, or keep within its limits", "Referenzfahrt, oder in ihren Grenzen bleiben"},
    {"homing is not enabled in its settings", "die Referenzfahrt ist in ihren Einstellungen nicht erlaubt"},
    {"it is moving", "sie fährt gerade"},
    {"it is locked until it is homed", "sie ist bis zur Referenzfahrt gesperrt"},
    {"the target is beyond its own soft limits", "das Ziel liegt jenseits ihrer eigenen Grenzen"},
    {"no speed was given", "es ist keine Geschwindigkeit genannt"},
    {"it ran into a limit switch", "sie ist auf einen Endschalter gefahren"},
    {"it was reset while it moved; its position is not certain",
     "sie wurde in der Fahrt zurückgesetzt; ihre Stellung ist nicht sicher"},
    {"homing failed: a switch was not found or not left",
     "Referenzfahrt misslungen: ein Schalter wurde nicht gefunden oder nicht verlassen"},
    {"the checksum was wrong", "die Prüfsumme war falsch"},
    {"it does not know the command", "sie kennt den Befehl nicht"},
    {"it does not know this type of the command", "sie kennt diese Art des Befehls nicht"},
    {"it refuses the value", "sie lehnt den Wert ab"},
    {"its memory is locked", "ihr Speicher ist gesperrt"},
    {"the command is not available", "den Befehl gibt es gerade nicht"},
    // motion
    {"stopped on the way", "unterwegs angehalten"},
    {"stopped before the move", "vor der Fahrt angehalten"},
    {"stopped while it was homed", "während der Referenzfahrt angehalten"},
    {"the stage reports an impossible position: ", "der Tisch meldet eine unmögliche Stellung: "},
    {"see to its cable and motor, then home it", "nach Kabel und Motor sehen, dann Referenzfahrt"},
    {"the emergency stop was pressed", "der Not-Halt wurde gedrückt"},
    {"home the stage first", "zuerst Referenzfahrt"},
    {" is beyond the limits of axis ", " liegt jenseits der Grenzen von Achse "},
    {"it goes from ", "sie geht von "},
    {"/s is no speed of axis ", "/s ist keine Geschwindigkeit von Achse "},
    {"where the stage is is not known", "es ist nicht bekannt, wo der Tisch steht"},
    {"home it first", "zuerst Referenzfahrt"},
    {"the stage went into alarm ", "der Tisch ging in Alarm, es fehlten "},
    {"the stage stands ", "der Tisch steht, es fehlen "},
    {" short of its target", " zum Ziel"},
    {"see what holds it up, then home it", "nachsehen, was ihn aufhält, dann Referenzfahrt"},
    {"see what holds it up, and home it", "nachsehen, was ihn aufhält, und Referenzfahrt"},
    {"the stage looked for its switch in vain", "der Tisch hat seinen Schalter nicht gefunden"},
    {"see to its switch and its motor", "nach Schalter und Motor sehen"},
    {"see to its switches", "nach ihren Schaltern sehen"},
    {"cannot be homed: ", "keine Referenzfahrt möglich: "},
    {"a turntable without a switch cannot be homed",
     "ein Drehteller ohne Schalter macht keine Referenzfahrt"},
    {"where it stands when it is opened is its zero", "wo er beim Öffnen steht, ist null"},
    {"a stage without switches cannot be homed", "ein Tisch ohne Schalter macht keine Referenzfahrt"},
    {"open it anew; it counts from where its controller was switched on",
     "ihn neu öffnen; er zählt von dort, wo seine Steuerung eingeschaltet wurde"},
    {"farther than the motor can count", "weiter, als der Motor zählen kann"},
    // its axes
    {"see the option axes= of its URI", "siehe die Option axes= seiner Adresse"},
    {"see the option axes=", "siehe die Option axes="},
    {"a turntable has one axis", "ein Drehteller hat eine Achse"},
    {"the controller says that axis ", "laut Steuerung hat Achse "},
    {" has no way or no speed", " weder Weg noch Geschwindigkeit"},
    {"set its travel ($", "ihren Weg ($"},
    {") and its rate ($", ") und ihre Geschwindigkeit ($"},
    {") in the controller", ") in der Steuerung stellen"},
    {"the controller reports fewer axes than it is said to have",
     "die Steuerung meldet weniger Achsen, als sie haben soll"},
    {"how far a step goes is not known", "es ist nicht bekannt, wie weit ein Schritt geht"},
    {"give steps= (microsteps per mm or degree) and speed_max=, for each axis",
     "steps= (Mikroschritte je mm oder Grad) und speed_max= angeben, für jede Achse"},
    {"axes are x, y, z, a, b and c", "Achsen sind x, y, z, a, b und c"},
    {"no axis ", "diese Achse gibt es nicht: "},
    // its laser
    {"this controller has no power between off and on for its laser",
     "diese Steuerung kann ihren Laser nur ganz oder gar nicht einschalten"},
    {"give 0 or 1", "0 oder 1 angeben"},
    {"the laser's guard does not start: ", "der Wächter des Lasers läuft nicht an: "},
    {"try again, or reinstall: without it no laser goes on",
     "noch einmal, oder neu installieren: ohne ihn geht kein Laser an"},
    {"no such laser", "diesen Laser gibt es nicht"},
    {"no laser ", "diesen Laser gibt es nicht: "},
};

}  // namespace

std::span<const EnginePhrase> engine_controllers() {
  return kControllers;
}

}  // namespace dubsar::ui

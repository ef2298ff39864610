// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is said of drivers, of their options and settings, in other languages; phrase by phrase, as in
// engine_words.cpp.
#include "ui/shell/engine_words.h"

namespace dubsar::ui {

namespace {

constexpr EnginePhrase kDrivers[] = {
    // what a driver does wrong
    {"the driver ", "der Treiber "},
    {"told a rig without spacing, field or depth range",
     "meldet ein Gerät ohne Punktabstand, Messfeld oder Tiefenbereich"},
    {"told a rig ", "meldet ein Gerät "},
    {"with a spacing of ", "mit einem Punktabstand von "},
    {"with a depth range of ", "mit einem Tiefenbereich von "},
    {"with a support height of ", "mit einer Auflagehöhe von "},
    {"whose calibration has an age of ", "mit einem Alter der Kalibrierung von "},
    {", beyond ", ", jenseits von "},
    {"told a range of ", "meldet einen unmöglichen Bereich für "},
    {"its turntable", "seinen Drehteller"},
    {"its arm's reach", "die Reichweite seines Arms"},
    {"its head's height", "die Höhe seines Kopfs"},
    {"its head's stand-off", "den Abstand seines Kopfs"},
    {"its tilt", "seine Neigung"},
    {" that is none", ""},
    {"told a head that is no box", "meldet einen Kopf, der kein Quader ist"},
    {"told an arm that stands nowhere", "meldet einen Arm, der nirgends steht"},
    {"announced profiles of ", "kündigt unmögliche Profile an: "},
    {"told a nominal pose that is no rigid motion, written row by row with the last row 0 0 0 1",
     "meldet eine Stellung, die keine starre Bewegung ist, zeilenweise geschrieben, mit der letzten Zeile 0 "
     "0 0 1"},
    {"sent a profile without samples", "sendet ein Profil ohne Messpunkte"},
    {"sent pixels of a format that has no place here",
     "sendet Pixel in einem Format, das hier nicht vorgesehen ist"},
    {"sent a frame that is smaller than it says", "sendet ein Bild, das kleiner ist, als es angibt"},
    {"told an axis whose limits are none", "meldet eine Achse mit unmöglichen Grenzen"},
    {"told of more axes or lasers than there can be", "meldet mehr Achsen oder Laser, als es geben kann"},
    {"told a position that is none", "meldet eine unmögliche Position"},
    {"cancelled", "abgebrochen"},
    // why a driver is left out
    {"driver left out: ", "Treiber weggelassen: "},
    {"skipped; ", "übergangen; "},
    {"skipped", "übergangen"},
    {"get a newer driver", "einen neueren Treiber holen"},
    {"get a newer Dubsar", "ein neueres Dubsar holen"},
    {"not a Dubsar driver: no ", "kein Treiber von Dubsar: es fehlt "},
    {"the driver says that it cannot work here", "der Treiber sagt, dass er hier nicht arbeiten kann"},
    {"driver interface version ", "Schnittstelle des Treibers in Version "},
    {", this program has ", ", dieses Programm hat "},
    {"its driver struct has ", "seine Beschreibung hat "},
    {" bytes of at least ", " Byte statt mindestens "},
    {"the driver lacks a function that every driver has",
     "dem Treiber fehlt eine Funktion, die jeder Treiber hat"},
    {"the driver has some of the settings functions and not all",
     "der Treiber hat nicht alle Funktionen für Einstellungen"},
    {"the driver has some of the functions of a camera and not all",
     "der Treiber hat nicht alle Funktionen einer Kamera"},
    {"the driver has some of the functions of a stage and not all",
     "der Treiber hat nicht alle Funktionen eines Tisches"},
    {"the driver's scheme is no scheme", "der Name, den der Treiber sich gibt, ist keiner"},
    {"cannot be loaded: ", "lässt sich nicht laden: "},
    {"a driver for ", "ein Treiber für "},
    {": is there already, from ", ": ist schon da, aus "},
    {"cannot be looked at: ", "lässt sich nicht ansehen: "},
    {"another user (", "ein anderer Benutzer ("},
    {") owns", ") besitzt"},
    {"everybody may write to", "jeder darf hineinschreiben:"},
    {"a group (", "eine Gruppe ("},
    {") may write to", ") darf hineinschreiben:"},
    {"by an access list others may write to", "nach einer Zugriffsliste dürfen andere hineinschreiben:"},
    {"take it away (setfacl -b) and see who wrote it",
     "sie wegnehmen (setfacl -b) und nachsehen, wer sie geschrieben hat"},
    {"have its owner changed (chown) and see who wrote it",
     "den Besitzer ändern lassen (chown) und nachsehen, wer sie geschrieben hat"},
    {"take the right away (chmod o-w) and see who wrote it",
     "das Recht wegnehmen (chmod o-w) und nachsehen, wer sie geschrieben hat"},
    {"take the right away (chmod g-w) and see who wrote it",
     "das Recht wegnehmen (chmod g-w) und nachsehen, wer sie geschrieben hat"},
    // options and settings
    {"no option ", "keine Option "},
    {"a rig has no option ", "ein Gerät hat keine Option "},
    {"say it in the rig's file", "es in der Gerätedatei sagen"},
    {": takes no options", ": hat keine Optionen"},
    {": takes ", ": kennt "},
    {"; set DUBSAR_DRIVER_PATH", "; DUBSAR_DRIVER_PATH setzen"},
    {"option '", "Option '"},
    {"' is not key=value", "' ist nicht Name=Wert"},
    {" is given twice", " steht zweimal da"},
    {"'%' without two hexadecimal digits", "'%' ohne zwei hexadezimale Ziffern"},
    {"in the name of a folder or file write %3F for ? and %25 for %",
     "im Namen eines Ordners oder einer Datei %3F für ? und %25 für % schreiben"},
    {"write %25 for the sign itself", "für das Zeichen selbst %25 schreiben"},
    {"a zero byte in the name of a device", "ein Nullbyte im Namen eines Geräts"},
    {"take it out", "es entfernen"},
    {"no setting ", "keine Einstellung "},
    {"it takes ", "zulässig ist "},
    {"it has none", "es hat keine"},
    {"a text of at most ", "ein Text von höchstens "},
    {"true or false", "true oder false"},
    {"there is rate", "es gibt rate"},
    {"' is none", "' gibt es nicht"},
    // one that does not come back
    {"the device does not answer: stop the laser and the stage by hand, or pull their plugs",
     "das Gerät antwortet nicht: Laser und Antrieb von Hand abschalten oder Stecker ziehen"},
    {"what was stored is safe; close the window: the program then ends within ",
     "was gespeichert ist, ist sicher; das Fenster schließen: das Programm endet dann binnen "},
    // the simulated scanner
    {"nothing stands between sim: and its options", "zwischen sim: und seinen Optionen steht nichts"},
    {"a motor does not answer, half way there", "ein Motor antwortet nicht, auf halbem Weg"},
    {"see what holds it up, then give the same command again", "nachsehen, was ihn aufhält, dann weiter"},
    {"nothing of the tablet lies in the measuring volume", "nichts von der Tafel liegt im Messvolumen"},
    {"place the tablet or the scanner otherwise", "Tafel oder Scanner anders stellen"},
    {"the scanner stopped in the middle of the scan", "der Scanner hielt mitten im Scan"},
    {"see to its cable and power, then give the same command again",
     "nach Kabel und Strom sehen, dann weiter"},
};

}  // namespace

std::span<const EnginePhrase> engine_drivers() {
  return kDrivers;
}

}  // namespace dubsar::ui

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the engine says of packages, and of what lies where one is to go.
#include "ui/shell/engine_words.h"

namespace dubsar::ui {

namespace {

constexpr EnginePhrase kPhrases[] = {
    // where it is to go
    {": a package of this session, of an earlier state or made otherwise",
     ": ein Paket dieser Sitzung, von einem früheren Stand oder anders gemacht"},
    {": a package of this session without the stamp that belongs to it, which tells of what state it is",
     ": ein Paket dieser Sitzung ohne den Stempel, der dazu gehört und sagt, von welchem Stand es ist"},
    {"bring it up to date with --update, choose another folder, or replace it with --force",
     "einen anderen Ordner wählen"},
    {"something lies there already", "dort liegt schon etwas"},
    {"somebody has put something there since this was begun",
     "jemand hat etwas dorthin gelegt, seit das begonnen wurde"},
    {"this is the top of a disk, and a folder cannot take its place",
     "das ist ein ganzer Datenträger, an dessen Stelle kein Ordner treten kann"},
    {"give a folder in it, such as ", "einen Ordner darin angeben, etwa "},
    {"a package keeps a checksum of every file in it; nothing else is written there",
     "ein Paket hat eine Prüfsumme für jede seiner Dateien; anderes wird nicht hineingeschrieben"},
    {"write it beside the package: ", "neben das Paket schreiben: "},
    {"another program is writing this folder now", "ein anderes Programm schreibt gerade diesen Ordner"},
    {"wait for it, or choose another folder", "darauf warten, oder einen anderen Ordner wählen"},
    {"cannot make the folder: others take it away or put theirs there",
     "der Ordner lässt sich nicht anlegen: andere nehmen ihn weg oder legen ihren hin"},
    {"cannot lock the folder", "der Ordner lässt sich nicht sperren"},
    {"cannot clear what was left there", "was dort liegen blieb, lässt sich nicht wegräumen"},
    {"cannot read back what was written", "was geschrieben wurde, lässt sich nicht wieder lesen"},
    {"cannot put the folder in its place", "der Ordner lässt sich nicht an seinen Platz setzen"},
    {"cannot move the old folder there", "der alte Ordner lässt sich nicht dorthin schieben"},
    {": what was replaced cannot be taken away: ", ": was ersetzt wurde, lässt sich nicht wegnehmen: "},
    {"; it is needed no more", "; es wird nicht mehr gebraucht"},
    // the package that lies there
    {"there is no folder to go up from", "hier ist kein Ordner, aus dem es hinaufgeht"},
    {"write the path without it", "den Pfad ohne ihn schreiben"},
    {"this is a link to what is not there", "dies ist ein Verweis auf etwas, das nicht da ist"},
    {"choose another folder, or remove the link yourself",
     "einen anderen Ordner wählen, oder den Verweis selbst entfernen"},
    {"what lies there is no package of Dubsar, so it is not replaced",
     "was dort liegt, ist kein Paket von Dubsar, also wird es nicht ersetzt"},
    {"what lies there is the package of another session, so it is not replaced",
     "was dort liegt, ist das Paket einer anderen Sitzung, also wird es nicht ersetzt"},
    {"the package that lies here is not what was written (",
     "das Paket, das hier liegt, ist nicht mehr das geschriebene ("},
    {"somebody added it", "jemand hat sie hinzugefügt"},
    {"see what differs (dubsar verify), choose another folder, or replace it with --force",
     "nachsehen, was anders ist, oder einen anderen Ordner wählen"},
    {"choose another folder, or replace it with --force", "einen anderen Ordner wählen"},
    // what it holds and the session does not
    {", and the package that lies here holds it", ", und das Paket, das hier liegt, hat es noch"},
    {"bring it back from a copy of the session (dubsar verify --repair --from COPY); where there is none, "
     "choose another folder: the package that lies here keeps it",
     "es aus einer Kopie der Sitzung zurückholen; wo es keine gibt, einen anderen Ordner wählen: das Paket, "
     "das "
     "hier liegt, behält es"},
    {"the session may have lost some of its record (",
     "die Sitzung hat vielleicht etwas von ihrem Verlauf verloren ("},
    {"the session has lost of its record: ", "die Sitzung hat von ihrem Verlauf verloren: "},
    {"the session no longer has ", "die Sitzung hat nicht mehr: "},
    {" as it was stored", ", wie es gespeichert wurde"},
    // what of it is kept
    {"nothing was replaced: move it elsewhere yourself, or choose another folder",
     "nichts wurde ersetzt: es selbst woandershin legen, oder einen anderen Ordner wählen"},
    {"not all of its files can be listed", "nicht alle Dateien darin lassen sich auflisten"},
    {"cannot be kept", "lässt sich nicht aufheben"},
    {"what was put into the earlier package, or changed in it, is kept in ",
     "was in das frühere Paket gelegt oder darin geändert wurde, liegt nun in "},
};

}  // namespace

std::span<const EnginePhrase> engine_packages() {
  return kPhrases;
}

}  // namespace dubsar::ui

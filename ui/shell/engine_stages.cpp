// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the engine says is under way, in other languages.
#include "ui/shell/engine_words.h"

namespace dubsar::ui {

namespace {

/// What is under way. Single words, some of them: they are replaced where they are all that is said, for
/// within a sentence they may be a file's name.
constexpr EnginePhrase kStages[] = {
    {"reading scans", "Scans werden gelesen"},
    {"checking the session", "Sitzung wird geprüft"},
    {"reading the session", "Sitzung wird gelesen"},
    {"registering", "Scans werden eingepasst"},
    {"relax", "Lagen werden ausgeglichen"},
    {"checking scans", "Scans werden geprüft"},
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
    {"compressing the model", "Modell wird komprimiert"},
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

}  // namespace dubsar::ui

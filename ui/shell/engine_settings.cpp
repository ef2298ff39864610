// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What drivers say of their settings, in other languages.
#include "ui/shell/engine_words.h"

namespace dubsar::ui {

namespace {

constexpr EnginePhrase kSettings[] = {
    {"of a frame", "eines Bildes"},
    {"of a frame in the whole picture", "eines Bildes im ganzen Bild"},
    {"of the region", "des Ausschnitts"},
    {"of the region on the sensor", "des Ausschnitts auf dem Sensor"},
    {"exposure of a frame", "Belichtung eines Bildes"},
    {"gain", "Verstärkung"},
    {"gain, in steps of the camera's own", "Verstärkung, in eigenen Schritten der Kamera"},
    {"frames per second", "Bilder in der Sekunde"},
    {"profiles per second", "Profile in der Sekunde"},
    {"profiles per second; 0 is as fast as can be", "Profile in der Sekunde; 0 heißt so schnell es geht"},
    {"power of the camera's own laser or lamp", "Leistung des Lasers oder der Lampe der Kamera"},
    {"counts of the encoder for each profile", "Schritte des Gebers je Profil"},
    {"count of the encoder now", "Stand des Gebers"},
    {"what releases a frame", "was ein Bild auslöst"},
    {"what the camera sends", "was die Kamera sendet"},
    {"of moves that name none; other axes go at the same share of their greatest",
     "von Fahrten, die keine nennen; andere Achsen fahren mit demselben Anteil ihrer größten"},
    {"its power; 0 is off", "seine Leistung; 0 ist aus"},
};

}  // namespace

std::span<const EnginePhrase> engine_settings() {
  return kSettings;
}

}  // namespace dubsar::ui

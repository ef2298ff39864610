// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// How the tablet is to be turned and pushed, and where an arm goes.
#include "ui/shell/engine_words.h"

namespace dubsar::ui {

namespace {

constexpr EnginePhrase kTurns[] = {
    {"turn the obverse towards the camera", "die Vorderseite zur Kamera drehen"},
    {"turn the reverse towards the camera", "die Rückseite zur Kamera drehen"},
    {"turn the left edge towards the camera", "den linken Rand zur Kamera drehen"},
    {"turn the right edge towards the camera", "den rechten Rand zur Kamera drehen"},
    {"turn the top edge towards the camera", "den oberen Rand zur Kamera drehen"},
    {"turn the bottom edge towards the camera", "den unteren Rand zur Kamera drehen"},
    {"turn it so that ", "so drehen, dass "},
    {" comes towards the camera", " zur Kamera kommt"},
    {", by way of ", ", über "},
    {", by way of the obverse", ", über die Vorderseite"},
    {", by way of the reverse", ", über die Rückseite"},
    {", by way of the left edge", ", über den linken Rand"},
    {", by way of the right edge", ", über den rechten Rand"},
    {", by way of the top edge", ", über den oberen Rand"},
    {", by way of the bottom edge", ", über den unteren Rand"},
    {"the corner between the obverse and the left edge", "die Ecke zwischen Vorderseite und linkem Rand"},
    {"the corner between the obverse and the right edge", "die Ecke zwischen Vorderseite und rechtem Rand"},
    {"the corner between the obverse and the top edge", "die Ecke zwischen Vorderseite und oberem Rand"},
    {"the corner between the obverse and the bottom edge", "die Ecke zwischen Vorderseite und unterem Rand"},
    {"the corner between the reverse and the left edge", "die Ecke zwischen Rückseite und linkem Rand"},
    {"the corner between the reverse and the right edge", "die Ecke zwischen Rückseite und rechtem Rand"},
    {"the corner between the reverse and the top edge", "die Ecke zwischen Rückseite und oberem Rand"},
    {"the corner between the reverse and the bottom edge", "die Ecke zwischen Rückseite und unterem Rand"},
    {"the corner between the left edge and the top edge", "die Ecke zwischen linkem Rand und oberem Rand"},
    {"the corner between the left edge and the bottom edge",
     "die Ecke zwischen linkem Rand und unterem Rand"},
    {"the corner between the right edge and the top edge", "die Ecke zwischen rechtem Rand und oberem Rand"},
    {"the corner between the right edge and the bottom edge",
     "die Ecke zwischen rechtem Rand und unterem Rand"},
    {", and turn it where it lies, ", ", und drehen, wo sie liegt, "},
    {", propped up", ", abgestützt"},
    {"lay its middle under the scanner", "ihre Mitte unter den Scanner legen"},
    {"lay the place ", "die Stelle "},
    {" mm from its middle towards the obverse", " mm von der Mitte zur Vorderseite hin"},
    {" mm from its middle towards the reverse", " mm von der Mitte zur Rückseite hin"},
    {" mm from its middle towards the left edge", " mm von der Mitte zum linken Rand hin"},
    {" mm from its middle towards the right edge", " mm von der Mitte zum rechten Rand hin"},
    {" mm from its middle towards the top edge", " mm von der Mitte zum oberen Rand hin"},
    {" mm from its middle towards the bottom edge", " mm von der Mitte zum unteren Rand hin"},
    {" under the scanner", " unter den Scanner legen"},
    {"bring its middle to the working distance", "ihre Mitte in den Arbeitsabstand bringen"},
    {"bring the place ", "die Stelle "},
    {" mm above its middle to the working distance", " mm über ihrer Mitte in den Arbeitsabstand bringen"},
    {"from how it lay for ", "von der Lage bei "},
    {"leave the tablet as it lies", "die Tafel liegen lassen"},
    {"turn the tablet where it lies, ", "die Tafel drehen, wo sie liegt, "},
    {" counter-clockwise seen from the camera", " gegen den Uhrzeigersinn, von der Kamera aus"},
    {" clockwise seen from the camera", " im Uhrzeigersinn, von der Kamera aus"},
    {"; then ", "; dann "},
    {"arm straight above, rolled ", "Arm senkrecht darüber, gerollt um "},
    {"arm to the side of the obverse", "Arm zur Seite der Vorderseite"},
    {"arm to the side of the reverse", "Arm zur Seite der Rückseite"},
    {"arm to the side of the left edge", "Arm zur Seite des linken Rands"},
    {"arm to the side of the right edge", "Arm zur Seite des rechten Rands"},
    {"arm to the side of the top edge", "Arm zur Seite des oberen Rands"},
    {"arm to the side of the bottom edge", "Arm zur Seite des unteren Rands"},
    {" off the vertical, rolled ", " aus der Senkrechten, gerollt um "},
    {" off the vertical", " aus der Senkrechten"},
    {"turntable to", "Drehteller auf"},
    {"tilt to", "Neigung auf"},
};

}  // namespace

std::span<const EnginePhrase> engine_turns() {
  return kTurns;
}

}  // namespace dubsar::ui

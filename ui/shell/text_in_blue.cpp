// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/text_in_blue.h"

#include <algorithm>
#include <iterator>

namespace dubsar::ui {

namespace {

constexpr TextRow kInBlue[] = {
    {Text::kStillRed, "{} mm² are still blue: scan on", "{} mm² sind noch blau: weiter scannen"},
    {Text::kUnjudgedHow, "They may hold what is blue on the model: judge first, then scan.",
     "Was auf dem Modell blau ist, kann auf ihnen sein: erst beurteilen, dann scannen."},
    {Text::kThenScan, "Then scan. What is blue on the model is still missing.",
     "Dann scannen. Was auf dem Modell blau ist, fehlt noch."},
    {Text::kScanTheRed, "Turn what is still blue towards the camera, then scan",
     "Was noch blau ist, zur Kamera drehen, dann scannen"},
    {Text::kRedArea, "{} mm² blue", "{} mm² blau"},
    {Text::kRedRim, "blue at its rim", "blau am Rand"},
    {Text::kNoRedSoFar, "no blue so far", "bisher nichts blau"},
};

}  // namespace

const TextRow* text_in_blue(Text text) {
  const TextRow* row = std::ranges::find(kInBlue, text, &TextRow::text);
  return row != std::end(kInBlue) ? row : nullptr;
}

}  // namespace dubsar::ui

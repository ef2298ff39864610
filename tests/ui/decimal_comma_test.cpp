// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/decimal_comma.h"

#include <gtest/gtest.h>

#include "ui/shell/widgets.h"

namespace dubsar::ui {
namespace {

TEST(DecimalComma, WhatIsMeasuredHasACommaInGerman) {
  EXPECT_EQ(with_decimal_commas("steht zu nah (0.8 mm): versetzen"), "steht zu nah (0,8 mm): versetzen");
  EXPECT_EQ(with_decimal_commas("ist 2.0 % zu lang, um -1.5° und +0.25 mm"),
            "ist 2,0 % zu lang, um -1,5° und +0,25 mm");
  EXPECT_EQ(with_decimal_commas("120.5 mm² sind noch rot; 0.05 mm/s"), "120,5 mm² sind noch rot; 0,05 mm/s");
  EXPECT_EQ(with_decimal_commas("100 mm/s, dann 0.5 mm"), "100 mm/s, dann 0,5 mm");
  EXPECT_EQ(with_decimal_commas("kein Keil liegt bei 1.234, -2.345, 0.100 mehr"),
            "kein Keil liegt bei 1,234; -2,345; 0,100 mehr");
  EXPECT_EQ(with_decimal_commas("0.25 mm"), "0,25 mm");
  EXPECT_EQ(with_decimal_commas("es fehlen 0.25 mm."), "es fehlen 0,25 mm.");
}

TEST(DecimalComma, NamesVersionsAndWhatIsTypedStayAsTheyAre) {
  for (const char* left :
       {"Dubsar 0.1.0", "geschrieben von Version 1.2", "BM 12.345 ist nicht da", "K.1.5 mm", "VAT 12.5",
        "/data/scans 0.5 mm fein/a.ply: nicht lesbar", "sessions/BM 0.5 mm: beschädigt",
        "Scan 3 (Tafel 0.5 mm fein.ply): sein Kopf", "\"Tafel 0.5 mm\" hat sich geändert", "a 0.5 mm.ply",
        "schreiben: `obj_info dubsar_direction 0 0.71 -0.71`", "steps=1600,88.9", "0..120",
        "limits=0..120 mm", "192.168.0.1", "am 3.5.2026", "siehe ~/x 0.5 mm/a"}) {
    EXPECT_EQ(with_decimal_commas(left), left);
  }
}

TEST(DecimalComma, TextsOfTheTableMarkTheirDecimals) {
  EXPECT_EQ(filled("auf {:.1Lf} µm, {:.2Lf} px, {:.0f}", 1234.56, 0.25, 3.0), "auf 1234,6 µm, 0,25 px, 3");
  EXPECT_EQ(filled("to {:.1f} µm", 1234.56), "to 1234.6 µm");
  EXPECT_EQ(decimal(12.375, 2, Language::kGerman), "12,38");
  EXPECT_EQ(decimal(12.375, 2, Language::kEnglish), "12.38");
}

}  // namespace
}  // namespace dubsar::ui

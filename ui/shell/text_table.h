// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace dubsar::ui {

enum class Language { kEnglish, kGerman };

[[nodiscard]] std::optional<Language> language_of(std::string_view code);  ///< "en", "de"
[[nodiscard]] const char* code_of(Language language);

/// Every text of the window. Another language is another column of text_table.cpp.
enum class Text {
  kTitle, kLayTablet, kChooseDevice, kReading, kOpening, kMoving, kScanning, kJudging, kFinishing, kSigning,
  kStillRed, kConclusive, kSigned, kSignedNext, kStopped, kUnsureScan, kUnsureHow, kTurnThenScan, kScanAsItLies,
  kScan, kUndo, kSign, kFinish, kStop, kGoOn, kHandsOff,
  kChecklist, kObverse, kReverse, kLeft, kRight, kTop, kBottom, kRedArea, kExcused, kNoArea,
  kModel, kScanGrowing, kNextPose, kScans, kRegistered, kUnsure, kFailed, kDropped, kDamaged, kJudged, kLocked,
  kDrop, kRestore, kRescan, kLock, kUnlock, kPointPairs, kWithdraw,
  kTablet, kMuseumNumber, kCdli, kCollection, kOperator, kNotes, kCdliWrong, kKept,
  kDevice, kSettings, kView, kClose, kUse, kLookAgain, kFound, kNothingFound, kAddress, kLanguage, kDark,
  kFontSize, kColourBlind, kClickSamePlace, kInUnsure, kInOther, kPairsDone, kPairsClear, kPairCount,
  kSignName, kSignRole, kSignIncomplete, kSignNow, kSignHint, kStore, kStoreWhole, kStoreDamaged, kDiskFree,
  kCalibration, kDaysOld, kNoCalibration, kNoModelYet, kNoScanYet, kSamples, kProfiles, kTimeLeft, kUncertainty,
  kLookClay, kOverlay, kLamp, kShadows, kOcclusion, kRadiance, kDepthShading, kFlat, kOverlayClay,
  kOverlayColours, kOverlayReliability, kOverlayScans, kOverlayFlags, kOverlayCurvature, kOverlayHeight,
  kOverlayOpenness, kOverlaySigma, kOverlayMsii, kWedges, kNoWedges, kMeasure, kMeasureHint, kPicture, kDpi, kPictureKept,
  kSixViews, kAnalyse, kAnalysing, kFaces, kVertices, kLeftOut, kGraphicsMemory, kDepth, kLength, kSelect,
  kSelectHint, kSelected, kUnion, kIntersect, kSubtract, kVisibleOnly, kClear, kPolygon, kBackToScan, kOpenMesh, kMove,
  kOrder,
  kCount
};

[[nodiscard]] const char* text_of(Text text, Language language);

/// What the engine says in English (where to turn the tablet, why a scan is unsure), as far as its phrases
/// are known; the rest stays as it is.
[[nodiscard]] std::string translated(const std::string& english, Language language);

}  // namespace dubsar::ui

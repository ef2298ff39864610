// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/position_track.h"
#include "acquisition/row_pitch.h"
#include "core/rig_calibration.h"
#include "drivers/device.h"

namespace dubsar {

/// What becomes of the profiles of a moved range camera on their way to `sink`: each is put where the stage
/// was at its time, in the frame of position 0, and those outside of the scan are left out. Profiles that
/// came in one block have one time, that of the first; the time from block to block tells the others'. A row
/// whose place is not known well enough (kSureSteps) is left out and counted as lost, and so are those that
/// were missed at the start of the scan.
class PlacedProfiles : public ProfileSink {
 public:
  struct Scan {
    RigMotion motion;
    double start = 0, step = 0;  ///< mm or radians
    int rows = 0;
    std::string device;
    double speed = 0;  ///< mm/s or rad/s, once it is gathered; 0: not known
    [[nodiscard]] double end() const { return start + step * (rows - 1); }
  };
  PlacedProfiles(ProfileSink& sink, PositionTrack& track, Scan scan);

  bool begin(const ScanInfo& info) override;
  bool profile(const Profile& profile) override;
  void end(const ScanTally& tally) override;
  void remark(const std::string& text) override { sink_.remark(text); }
  /// Hands on what still waits; call it when no more profiles come. The sink's begin() comes with the first
  /// rows, once it is known how far apart they are, or here.
  void flush();

  [[nodiscard]] bool complete() const { return complete_; }    ///< the stage has passed the scan's end
  [[nodiscard]] bool cancelled() const { return cancelled_; }  ///< the sink had enough
  [[nodiscard]] bool begun() const { return begun_; }
  [[nodiscard]] bool single_block() const { return !period_ns_; }  ///< nothing tells when its rows were taken
  [[nodiscard]] bool timeless() const { return timeless_; }        ///< a profile came without any time
  [[nodiscard]] std::optional<double> position() const { return position_; }
  /// For the operator, of rows that are not as far apart as was asked.
  [[nodiscard]] std::optional<std::string> pitch_remark() const { return pitch_.remark(); }
  [[nodiscard]] const ScanTally& tally() const { return tally_; }

 private:
  struct Row {
    std::int64_t number = 0;
    std::vector<float> x, y, z, intensity, confidence;
    std::vector<std::uint8_t> valid, rgb;
    std::optional<std::int64_t> encoder;
  };
  bool hand_on();
  bool begin_sink();
  void give(const Row& row, std::int64_t timestamp_ns);
  bool place(Row& row, std::int64_t timestamp_ns);
  /// Nothing that is still to come of the block can be of the scan: it would go on for ever.
  [[nodiscard]] bool is_behind() const;
  void count_unsure(std::int64_t row, double position);
  void begin_rows(std::int64_t row, double position);

  ProfileSink& sink_;
  PositionTrack& track_;
  Scan scan_;
  RowPitch pitch_;
  std::optional<ScanInfo> info_;                       ///< as the camera told it, from its begin() on
  std::vector<std::pair<Row, std::int64_t>> waiting_;  ///< until the sink has begun; and their times, ns
  bool flat_ = false;                                  ///< y of the camera is made up of the rows' numbers
  std::vector<Row> block_;
  std::int64_t block_ns_ = 0;
  std::optional<double> period_ns_;
  std::optional<std::int64_t> first_row_;
  std::optional<double> position_;
  std::optional<std::pair<std::int64_t, double>>
      sure_;                          ///< the last row whose place was known, and its place
  std::vector<std::int64_t> unsure_;  ///< rows since then
  bool begun_ = false, complete_ = false, cancelled_ = false, timeless_ = false;
  ScanTally tally_;
};

}  // namespace dubsar

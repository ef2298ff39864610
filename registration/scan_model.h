// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "registration/registrar.h"

namespace dubsar {

/// The scans of a Registrar, the groups that they form and the pairs between them. A group is a set of scans
/// that are registered with each other in a frame of their own; a scan that is registered with nothing is a
/// group of one.
class ScanModel {
 public:
  explicit ScanModel(RegistrationOptions options) : options_(std::move(options)) {}

  /// Takes a scan in, as a group of its own. A null grid is an empty one.
  void enter(int id, const RangeGrid* grid, const PinSet* pins);
  bool remove(int id);
  /// Tries to join the scan's group with every other group. True when it joined one.
  bool join(int id, JobContext& job);
  /// Tries again the scans outside the main group until no more join.
  void retry(JobContext& job);
  bool place(int id, const RigidTransform& model_from_scanner, bool locked);
  Status finalize(JobContext& job);

  [[nodiscard]] ScanPose pose(int id) const;
  [[nodiscard]] std::vector<ScanPose> poses() const;

 private:
  struct Scan {
    std::string file;
    ScanFeatures features;
    std::optional<NominalPose> nominal;
    std::vector<PinTip> pins;
    double own_scale_mm = 0;
    bool usable = false;
    int group = 0;
    RigidTransform group_from_scanner;
    bool locked = false;
    std::string reason;  ///< why it does not join; empty when it has joined or was not tried
    PoseStatus outcome = PoseStatus::kFailed;
    double rms_mm = 0, overlap = 0, stage_sigma_mm = 0;
    Matrix6d covariance = Matrix6d::Zero();
  };
  /// a < b.
  struct Pair {
    RigidTransform a_from_b;
    Eigen::Vector3d center_mm{0, 0, 0};
    Matrix6d information = Matrix6d::Zero();
  };

  [[nodiscard]] std::vector<int> members(int group) const;  ///< ascending ids
  [[nodiscard]] int main_group() const;
  [[nodiscard]] std::vector<int> groups_by_size() const;
  [[nodiscard]] PoseHints hints_for(const Scan& scan, const std::vector<int>& group_ids) const;
  [[nodiscard]] std::vector<ModelScan> model_of(const std::vector<int>& ids) const;
  [[nodiscard]] std::vector<PoseHypothesis> hypotheses(int source, int target);
  bool join_group(int id, int group, JobContext& job);
  void connect(int id, const ModelFit& fit, bool by_stage, const std::vector<int>& group_ids, int group);
  void measure_pair(int a, int b);
  void relax_group(int group, const JobContext& job);
  void judge(int id);

  RegistrationOptions options_;
  double scale_mm_ = 0;
  int next_group_ = 0;
  std::map<int, Scan> scans_;
  std::map<std::pair<int, int>, Pair> pairs_;
  std::map<std::pair<int, int>, std::vector<PoseHypothesis>>
      hypotheses_;  ///< by (source, target): do not depend on poses
};

}  // namespace dubsar

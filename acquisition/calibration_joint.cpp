// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/calibration_joint.h"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "acquisition/calibration_terms.h"
#include "acquisition/calibration_volume.h"

namespace dubsar {

namespace {

namespace terms = calibration_terms;

constexpr double kHuber = 2.5;        // standard deviations
constexpr double kLeastSigma = 0.01;  // px: nothing is measured better

using Pose = std::array<double, 6>;

Pose numbers_of(const RigidTransform& pose) {
  const Eigen::AngleAxisd turn(pose.rotation);
  const Eigen::Vector3d w = turn.angle() * turn.axis();
  const Eigen::Vector3d& t = pose.translation_mm;
  return {w.x(), w.y(), w.z(), t.x(), t.y(), t.z()};
}

RigidTransform transform_of(const Pose& p) {
  RigidTransform out = RigidTransform::from_twist({p[0], p[1], p[2]}, Eigen::Vector3d::Zero());
  out.translation_mm = {p[3], p[4], p[5]};
  return out;
}

/// All unknowns at fixed addresses.
struct Unknowns {
  std::array<double, 9> camera{};
  std::vector<Pose> poses;            // one per free view, one per fixed board
  std::vector<std::size_t> pose_of;   // [used]
  std::vector<std::uint8_t> carried;  // [used] a view of a fixed board
  Eigen::Vector3d laser{0, 0, 0};
  Eigen::Vector3d direction{0, 1, 0};
  Eigen::Vector3d point{0, 0, 0};
};

CameraModel camera_of(const std::array<double, 9>& c, const CameraModel& size) {
  return {size.width, size.height, c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8]};
}

struct Scatter {
  double corner_px = 0.1;
  double stripe_px = 0.1;
};

class Refinement {
 public:
  Refinement(const std::vector<CalibrationView>& views, const std::vector<std::size_t>& used,
             const std::vector<StripeSample>& stripes, JointState& state)
      : views_(views), used_(used), stripes_(stripes), state_(state) {
    const CameraModel& c = state.camera;
    x_.camera = {c.fx_px, c.fy_px, c.cx_px, c.cy_px, c.k1, c.k2, c.p1, c.p2, c.k3};
    std::map<std::string, std::size_t> fixed;
    for (std::size_t k = 0; k < used.size(); ++k) {
      const CalibrationView& view = views[used[k]];
      const bool carried =
          state.has_stage && !view.fixed.empty() && state.motion.kind != MotionKind::kGalvanometer;
      x_.carried.push_back(carried ? 1 : 0);
      if (!carried) {
        x_.pose_of.push_back(x_.poses.size());
        x_.poses.push_back(numbers_of(state.camera_from_board[k]));
        continue;
      }
      const auto [at, fresh] = fixed.try_emplace(view.fixed, x_.poses.size());
      if (fresh) {
        x_.poses.push_back(
            numbers_of(state.motion.zero_from_camera(view.stage_position) * state.camera_from_board[k]));
      }
      x_.pose_of.push_back(at->second);
    }
    if (state.has_laser) {
      x_.laser = state.laser.normal / state.laser.distance_mm;
    }
    x_.direction = state.motion.direction;
    x_.point = state.motion.axis_point_mm;
  }

  [[nodiscard]] bool solve(const Scatter& scatter) {
    build(scatter);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.max_num_iterations = 100;
    options.function_tolerance = 1e-12;
    options.parameter_tolerance = 1e-12;
    options.gradient_tolerance = 1e-14;
    options.num_threads = 1;  // the same sums on every machine
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, problem_.get(), &summary);
    store();
    return summary.IsSolutionUsable();
  }

  [[nodiscard]] JointErrors errors() const;
  [[nodiscard]] bool deviations(double depth_range_mm, JointErrors& errors);
  [[nodiscard]] double mm_per_px(const StripeSample& sample) const;

 private:
  [[nodiscard]] double volume_sigma_mm(const ceres::Covariance& covariance, double depth_range_mm,
                                       bool stage) const;
  void build(const Scatter& scatter);
  void store();
  [[nodiscard]] RigidTransform pose_seen(std::size_t k) const {
    RigidTransform pose = transform_of(x_.poses[x_.pose_of[k]]);
    if (x_.carried[k] == 0) {
      return pose;
    }
    return state_.motion.zero_from_camera(views_[used_[k]].stage_position).inverse() * pose;
  }
  [[nodiscard]] double off_plane_mm(const StripeSample& sample) const;

  const std::vector<CalibrationView>& views_;
  const std::vector<std::size_t>& used_;
  const std::vector<StripeSample>& stripes_;
  JointState& state_;
  Unknowns x_;
  std::unique_ptr<ceres::Problem> problem_;
};

/// How far the point that is seen on the board moves off the plane when the sample moves by a pixel.
double Refinement::mm_per_px(const StripeSample& sample) const {
  const Plane plane = state_.motion.laser_at(state_.laser, views_[used_[sample.view]].mirror_position);
  const RigidTransform pose = pose_seen(sample.view);
  const Plane face{pose.rotation.col(2), pose.rotation.col(2).dot(pose.translation_mm)};
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  for (int axis = 0; axis < 2; ++axis) {
    std::array<double, 2> off{};
    for (int side = 0; side < 2; ++side) {
      Eigen::Vector2d pixel = sample.pixel;
      pixel[axis] += side == 0 ? -0.5 : 0.5;
      const auto ray = state_.camera.undistort(pixel);
      if (!ray) {
        return 1;
      }
      const Eigen::Vector3d direction(ray->x(), ray->y(), 1);
      off[static_cast<std::size_t>(side)] =
          plane.signed_distance_mm(face.along(Eigen::Vector3d::Zero(), direction).value_or(0) * direction);
    }
    slope[axis] = off[1] - off[0];
  }
  return std::max(1e-6, slope.norm());
}

double Refinement::off_plane_mm(const StripeSample& sample) const {
  const Plane plane = state_.motion.laser_at(state_.laser, views_[used_[sample.view]].mirror_position);
  const RigidTransform pose = pose_seen(sample.view);
  const Plane face{pose.rotation.col(2), pose.rotation.col(2).dot(pose.translation_mm)};
  const auto ray = state_.camera.undistort(sample.pixel);
  if (!ray) {
    return 0;
  }
  const Eigen::Vector3d direction(ray->x(), ray->y(), 1);
  return plane.signed_distance_mm(face.along(Eigen::Vector3d::Zero(), direction).value_or(0) * direction);
}

void Refinement::build(const Scatter& scatter) {
  problem_ = std::make_unique<ceres::Problem>();
  const MotionKind kind = state_.motion.kind;
  // With nothing else to weigh them against, corners are taken as everybody takes them, so that figures
  // compare: whole pictures that stand out have been left out before.
  const bool corners_alone = !state_.has_laser && !state_.has_stage;
  const auto corner_loss = [&] {
    return corners_alone ? nullptr : std::make_unique<ceres::HuberLoss>(kHuber);
  };
  for (std::size_t k = 0; k < used_.size(); ++k) {
    const CalibrationView& view = views_[used_[k]];
    double* const pose = x_.poses[x_.pose_of[k]].data();
    for (std::size_t i = 0; i < view.board.corners_px.size(); ++i) {
      const terms::Corner corner{view.board.corners_px[i], view.board.corners_mm[i], scatter.corner_px};
      if (x_.carried[k] == 0) {
        problem_->AddResidualBlock(
            new ceres::AutoDiffCostFunction<terms::Corner, 2, 9, 6>(new terms::Corner(corner)),
            corner_loss().release(), x_.camera.data(), pose);
      } else {
        problem_->AddResidualBlock(new ceres::AutoDiffCostFunction<terms::CarriedCorner, 2, 9, 6, 3, 3>(
                                       new terms::CarriedCorner{corner, kind, view.stage_position}),
                                   corner_loss().release(), x_.camera.data(), pose, x_.direction.data(),
                                   x_.point.data());
      }
    }
  }
  const bool galvanometer = state_.has_stage && kind == MotionKind::kGalvanometer;
  for (const StripeSample& sample : state_.has_laser ? stripes_ : std::vector<StripeSample>()) {
    if (x_.carried[sample.view] != 0) {
      continue;  // its board's pose is tied to the stage; other views carry the laser
    }
    const terms::Stripe stripe{sample.pixel, views_[used_[sample.view]].mirror_position, mm_per_px(sample),
                               scatter.stripe_px};
    double* const pose = x_.poses[x_.pose_of[sample.view]].data();
    if (galvanometer) {
      problem_->AddResidualBlock(
          new ceres::AutoDiffCostFunction<terms::Stripe, 1, 9, 6, 3, 3, 3>(new terms::Stripe(stripe)),
          new ceres::HuberLoss(kHuber), x_.camera.data(), pose, x_.laser.data(), x_.direction.data(),
          x_.point.data());
    } else {
      problem_->AddResidualBlock(
          new ceres::AutoDiffCostFunction<terms::Stripe, 1, 9, 6, 3>(new terms::Stripe(stripe)),
          new ceres::HuberLoss(kHuber), x_.camera.data(), pose, x_.laser.data());
    }
  }
  const DistortionTerms wanted = terms_for(state_.camera);
  if (wanted != DistortionTerms::kAll) {
    const std::vector<int> held =
        wanted == DistortionTerms::kFour ? std::vector<int>{8} : std::vector<int>{5, 8};
    problem_->SetManifold(x_.camera.data(), new ceres::SubsetManifold(9, held));
  }
  if (problem_->HasParameterBlock(x_.direction.data()) && kind != MotionKind::kLinear) {
    problem_->SetManifold(x_.direction.data(), new ceres::SphereManifold<3>());
    problem_->AddResidualBlock(
        new ceres::AutoDiffCostFunction<terms::AxisGauge, 1, 3>(new terms::AxisGauge{x_.direction, x_.point}),
        nullptr, x_.point.data());
  } else if (problem_->HasParameterBlock(x_.point.data())) {
    problem_->SetParameterBlockConstant(x_.point.data());
  }
}

void Refinement::store() {
  state_.camera = camera_of(x_.camera, state_.camera);
  if (state_.has_laser) {
    state_.laser.normal = x_.laser.normalized();
    state_.laser.distance_mm = 1 / x_.laser.norm();
  }
  if (state_.has_stage) {
    state_.motion.direction = x_.direction;
    state_.motion.axis_point_mm = x_.point;
  }
  for (std::size_t k = 0; k < used_.size(); ++k) {
    state_.camera_from_board[k] = pose_seen(k);
  }
}

JointErrors Refinement::errors() const {
  JointErrors out;
  double corners = 0;
  double carried_px = 0;
  double carried_mm = 0;
  std::size_t corner_count = 0;
  std::size_t carried_count = 0;
  for (std::size_t k = 0; k < used_.size(); ++k) {
    const BoardView& board = views_[used_[k]].board;
    const RigidTransform pose = pose_seen(k);
    for (std::size_t i = 0; i < board.corners_px.size(); ++i) {
      const Eigen::Vector3d p = pose * board.corners_mm[i];
      const double square = (state_.camera.project(p) - board.corners_px[i]).squaredNorm();
      corners += square;
      ++corner_count;
      if (x_.carried[k] != 0) {
        const double mm = p.z() / state_.camera.fx_px;
        carried_px += square;
        carried_mm += square * mm * mm;
        ++carried_count;
      }
    }
  }
  double px = 0;
  double mm = 0;
  std::size_t stripe_count = 0;
  for (const StripeSample& sample : state_.has_laser ? stripes_ : std::vector<StripeSample>()) {
    if (x_.carried[sample.view] == 0) {
      const double off = off_plane_mm(sample);
      mm += off * off;
      px += off * off / std::pow(mm_per_px(sample), 2);
      ++stripe_count;
    }
  }
  const auto root = [](double sum, std::size_t count) {
    return count == 0 ? 0 : std::sqrt(sum / static_cast<double>(count));
  };
  out.corner_rms_px = root(corners, corner_count);
  out.stage_rms_px = root(carried_px, carried_count);
  out.stage_rms_mm = root(carried_mm, carried_count);
  out.stripe_rms_px = root(px, stripe_count);
  out.stripe_rms_mm = root(mm, stripe_count);
  return out;
}

double Refinement::volume_sigma_mm(const ceres::Covariance& covariance, double depth_range_mm,
                                   bool stage) const {
  Eigen::VectorXd unknowns(18);
  unknowns << Eigen::Map<const Eigen::Matrix<double, 9, 1>>(x_.camera.data()), x_.laser, x_.direction,
      x_.point;
  Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(18, 18);
  const auto block = [&](const double* a, const double* b, Eigen::Index row, Eigen::Index col,
                         Eigen::Index rows, Eigen::Index cols) {
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> part(rows, cols);
    covariance.GetCovarianceBlock(a, b, part.data());
    joint.block(row, col, rows, cols) = part;
    joint.block(col, row, cols, rows) = part.transpose();
  };
  block(x_.camera.data(), x_.camera.data(), 0, 0, 9, 9);
  block(x_.camera.data(), x_.laser.data(), 0, 9, 9, 3);
  block(x_.laser.data(), x_.laser.data(), 9, 9, 3, 3);
  const bool counts = stage && state_.motion.kind != MotionKind::kGalvanometer;
  if (counts) {
    block(x_.camera.data(), x_.direction.data(), 0, 12, 9, 3);
    block(x_.laser.data(), x_.direction.data(), 9, 12, 3, 3);
    block(x_.direction.data(), x_.direction.data(), 12, 12, 3, 3);
  }
  if (counts && state_.motion.kind == MotionKind::kTurntable) {
    block(x_.camera.data(), x_.point.data(), 0, 15, 9, 3);
    block(x_.laser.data(), x_.point.data(), 9, 15, 3, 3);
    block(x_.direction.data(), x_.point.data(), 12, 15, 3, 3);
    block(x_.point.data(), x_.point.data(), 15, 15, 3, 3);
  }
  return dubsar::volume_sigma_mm(state_.camera, unknowns, joint,
                                 counts ? std::optional(state_.motion.kind) : std::nullopt, depth_range_mm);
}

bool Refinement::deviations(double depth_range_mm, JointErrors& errors) {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.num_threads = 1;
  ceres::Covariance covariance(options);
  std::vector<std::pair<const double*, const double*>> blocks{{x_.camera.data(), x_.camera.data()}};
  const bool laser = state_.has_laser && problem_->HasParameterBlock(x_.laser.data());
  const bool stage = state_.has_stage && problem_->HasParameterBlock(x_.direction.data());
  if (laser) {
    blocks.emplace_back(x_.laser.data(), x_.laser.data());
    blocks.emplace_back(x_.camera.data(), x_.laser.data());
  }
  if (stage) {
    blocks.emplace_back(x_.direction.data(), x_.direction.data());
  }
  if (laser && stage) {
    blocks.emplace_back(x_.camera.data(), x_.direction.data());
    blocks.emplace_back(x_.laser.data(), x_.direction.data());
    if (state_.motion.kind == MotionKind::kTurntable) {
      blocks.emplace_back(x_.point.data(), x_.point.data());
      blocks.emplace_back(x_.camera.data(), x_.point.data());
      blocks.emplace_back(x_.laser.data(), x_.point.data());
      blocks.emplace_back(x_.direction.data(), x_.point.data());
    }
  }
  if (!covariance.Compute(blocks, problem_.get())) {
    return false;
  }
  Eigen::Matrix<double, 9, 9, Eigen::RowMajor> camera;
  covariance.GetCovarianceBlock(x_.camera.data(), x_.camera.data(), camera.data());
  errors.focal_sigma_px = std::sqrt(std::max(0.0, camera(0, 0)));
  if (laser) {
    errors.volume_sigma_mm = volume_sigma_mm(covariance, depth_range_mm, stage);
  }
  if (stage) {
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> axis;
    covariance.GetCovarianceBlock(x_.direction.data(), x_.direction.data(), axis.data());
    // Across the direction: its length is the scale of a linear stage.
    const Eigen::Vector3d along = x_.direction.normalized();
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - along * along.transpose();
    errors.axis_sigma_rad = std::sqrt(std::max(0.0, (across * axis * across).trace())) / x_.direction.norm();
  }
  return true;
}

}  // namespace

Result<JointErrors> refine_jointly(const std::vector<CalibrationView>& views,
                                   const std::vector<std::size_t>& used,
                                   const std::vector<StripeSample>& stripes, double depth_range_mm,
                                   JointState& state) {
  Refinement refinement(views, used, stripes, state);
  const auto open = [] {
    return bad_input({}, "the pictures leave a part of the rig open",
                     "take more pictures of the board: tilted to each side, near and far, in every corner");
  };
  JointErrors errors = refinement.errors();
  // The second round weighs corners and stripe by the scatter that the first has left.
  for (int round = 0; round < 2; ++round) {
    const Scatter scatter{std::max(kLeastSigma, errors.corner_rms_px / std::sqrt(2.0)),
                          std::max(kLeastSigma, errors.stripe_rms_px)};
    if (!refinement.solve(scatter)) {
      return open();
    }
    errors = refinement.errors();
  }
  if (!refinement.deviations(depth_range_mm, errors)) {
    return open();
  }
  return errors;
}

}  // namespace dubsar

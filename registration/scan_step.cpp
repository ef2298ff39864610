// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/scan_step.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/number_text.h"
#include "core/parallel.h"
#include "core/units.h"
#include "registration/nearest_usable.h"
#include "registration/twist.h"

namespace dubsar {

namespace {

/// Rows are taken together in so many bins of as many pairs each; a step is looked for between two of them …
constexpr std::size_t kBins = 24;
/// … with at least so many on either side.
constexpr std::size_t kLeastBins = 3;
/// Of one other scan nothing tells which of the two moved.
constexpr std::size_t kLeastOthers = 2;
/// Fewer pairs tell nothing.
constexpr std::size_t kLeastPairs = 400;
/// One sample in so many tells whether the others are worth asking.
constexpr std::size_t kHintEvery = 4;
/// Scale of the robust weight in expected residuals, fit after fit: wide enough at first for either part.
constexpr std::array kKernels{6.0, 3.0, 3.0};
/// Of the mean strength: holds what nothing else holds.
constexpr double kHold = 1e-3;
constexpr std::size_t kSamplesPerPart = 256;

/// A sample and its partner on one other scan.
struct Pull {
  std::size_t target = 0;
  float row = 0;
  bool used = false, crease = false;
  double weight = 0, residual_mm = 0;
  Vector6d jacobian = Vector6d::Zero();  ///< of the residual, by a twist about the centre
  Eigen::Vector3d at_mm{0, 0, 0};        ///< from the centre, model frame
  Eigen::Vector3d normal{0, 0, 0};
};

/// What the pairs of some rows with one other scan come to.
struct Sums {
  Matrix6d h = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
};
using Bins = std::array<Sums, kBins>;
/// How much of a change each bin takes part in.
using Shape = std::array<double, kBins>;

/// What changes of these shapes over the rows, six numbers each and the same for all other scans, explain
/// beside a pose of the scan on each of them.
struct Change {
  Eigen::VectorXd by;                      ///< [6 a shape]
  Eigen::MatrixXd held;                    ///< normal matrix of `by`, the poses taken out
  std::vector<Vector6d> poses;             ///< of the scan on each other one, where `by` is 0
  std::vector<Eigen::MatrixXd> taken_out;  ///< the pull on `by` less so much of that on the pose
  double gain = 0;                         ///< sum of weighted squares that it takes off
  double gain_each = 0;                    ///< that changes for each other scan by itself would
  double gain_poses = 0;                   ///< that the poses take off before

  [[nodiscard]] double common() const { return gain_each > 0 ? gain / gain_each : 0.0; }
};

struct Pulls {
  std::vector<Pull> all;
  std::array<float, kBins - 1> ends{};  ///< rows at which bins end
  std::vector<Bins> bins;               ///< by target
  double weight = 0, radius_mm = 1;

  [[nodiscard]] std::size_t bin_of(float row) const {
    return static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), row) - ends.begin());
  }

  /// Bins of as many pairs each.
  [[nodiscard]] bool set_ends() {
    std::vector<float> rows;
    for (const Pull& pull : all) {
      if (pull.used) {
        rows.push_back(pull.row);
      }
    }
    if (rows.size() < kLeastPairs) {
      return false;
    }
    std::sort(rows.begin(), rows.end());
    for (std::size_t b = 1; b < kBins; ++b) {
      ends[b - 1] = rows[b * rows.size() / kBins];
    }
    return true;
  }

  void sum_up(std::size_t targets) {
    bins.assign(targets, {});
    double radius2 = 0;
    weight = 0;
    for (const Pull& pull : all) {
      if (!pull.used) {
        continue;
      }
      Sums& sums = bins[pull.target][bin_of(pull.row)];
      sums.h.noalias() += pull.weight * pull.jacobian * pull.jacobian.transpose();
      sums.g += pull.weight * pull.residual_mm * pull.jacobian;
      weight += pull.weight;
      radius2 += pull.weight * pull.at_mm.squaredNorm();
    }
    radius_mm = weight > 0 ? std::sqrt(radius2 / weight) : 1.0;
  }

  /// The diagonal that holds what nothing holds, for pairs of this weight.
  [[nodiscard]] Vector6d hold_of(double pairs_weight) const {
    Vector6d out;
    out << Eigen::Vector3d::Constant(radius_mm * radius_mm), Eigen::Vector3d::Ones();
    return kHold * pairs_weight * out;
  }

  [[nodiscard]] static Eigen::MatrixXd with_hold(Eigen::MatrixXd h, const Vector6d& hold) {
    h.diagonal() += hold.replicate(h.rows() / 6, 1);
    return h;
  }

  [[nodiscard]] Change change(std::span<const Shape> shapes) const {
    const auto n = static_cast<Eigen::Index>(6 * shapes.size());
    Change out;
    out.held = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(n);
    for (const Bins& of_target : bins) {
      Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
      Eigen::MatrixXd b = Eigen::MatrixXd::Zero(n, 6);
      Matrix6d c = Matrix6d::Zero();
      Eigen::VectorXd u = Eigen::VectorXd::Zero(n);
      Vector6d v = Vector6d::Zero();
      for (std::size_t k = 0; k < kBins; ++k) {
        const auto& [h, g] = of_target[k];
        for (std::size_t s = 0; s < shapes.size(); ++s) {
          const auto at = static_cast<Eigen::Index>(6 * s);
          for (std::size_t other = 0; other < shapes.size(); ++other) {
            a.block<6, 6>(at, static_cast<Eigen::Index>(6 * other)) += shapes[s][k] * shapes[other][k] * h;
          }
          b.block<6, 6>(at, 0) += shapes[s][k] * h;
          u.segment<6>(at) += shapes[s][k] * g;
        }
        c += h;
        v += g;
      }
      const Vector6d hold = hold_of(c.bottomRightCorner<3, 3>().trace());
      c.diagonal() += hold;
      const Eigen::LDLT<Matrix6d> solve(c);
      out.taken_out.push_back(solve.solve(b.transpose()).transpose());
      out.poses.push_back(solve.solve(v));
      out.gain_poses += v.dot(out.poses.back());
      const Eigen::MatrixXd own = a - out.taken_out.back() * b.transpose();
      const Eigen::VectorXd own_pull = u - out.taken_out.back() * v;
      out.gain_each += own_pull.dot(with_hold(own, hold).ldlt().solve(own_pull));
      out.held += own;
      pull += own_pull;
    }
    out.by = -with_hold(out.held, hold_of(weight)).ldlt().solve(pull);
    out.gain = -pull.dot(out.by);
    return out;
  }

  [[nodiscard]] Change step_after(std::size_t bin) const {
    Shape shape{};
    std::fill(shape.begin() + static_cast<std::ptrdiff_t>(bin), shape.end(), 1.0);
    return change({&shape, 1});
  }

  /// After which bin a step explains most.
  [[nodiscard]] std::size_t best_bin() const {
    std::size_t best = kLeastBins;
    double most = -1;
    for (std::size_t bin = kLeastBins; bin + kLeastBins <= kBins; ++bin) {
      if (const double gain = step_after(bin).gain; gain > most) {
        most = gain;
        best = bin;
      }
    }
    return best;
  }

  /// What a drift explains whose six numbers each follow a parabola over the rows.
  [[nodiscard]] double drift_gain() const {
    std::array<Shape, 2> shapes{};
    for (std::size_t k = 0; k < kBins; ++k) {
      shapes[0][k] = 2.0 * (static_cast<double>(k) + 0.5) / static_cast<double>(kBins) - 1.0;
      shapes[1][k] = shapes[0][k] * shapes[0][k];
    }
    return change(shapes).gain;
  }

  [[nodiscard]] double sum_of_squares() const {
    double sum = 0;
    for (const Pull& pull : all) {
      sum += pull.used ? pull.weight * pull.residual_mm * pull.residual_mm : 0.0;
    }
    return sum;
  }
};

/// The scan in two parts.
struct InTwo {
  const ScanSurface& scan;
  std::vector<IcpTarget> targets;
  Eigen::Vector3d center_mm;
  std::vector<RigidTransform> before;  ///< model_from_scanner of the first part, on each other scan by itself
  Vector6d by = Vector6d::Zero();      ///< twist of the model frame that takes the second part from there
  float row = 2;                       ///< the first of the second part's

  [[nodiscard]] std::vector<Pull> pulls(double kernel_mm, std::size_t every) const {
    const std::vector<SurfaceSample>& samples = scan.fine->samples;
    const double reach_mm = std::max(2.0 * scan.fine->spacing_mm, 5.0 * kernel_mm);
    const std::size_t count = (samples.size() + every - 1) / every;
    std::vector<Pull> out(count * targets.size());
    for (std::size_t t = 0; t < targets.size(); ++t) {
      const RigidTransform& model_from_target = targets[t].model_from_scanner;
      const RigidTransform target_from_model = model_from_target.inverse();
      const std::array<RigidTransform, 2> parts{before[t], twisted(before[t], by, center_mm)};
      const SurfaceLevel& level = *targets[t].level;
      parallel_chunks(count, kSamplesPerPart, [&](std::size_t begin, std::size_t end) {
        std::array<Eigen::Vector3f, kSamplesPerPart> asked;
        std::array<GridLookup::Found, kSamplesPerPart> found;
        for (std::size_t i = begin; i < end; ++i) {
          const SurfaceSample& s = samples[i * every];
          const RigidTransform& part = parts[s.row < row ? 0 : 1];
          asked[i - begin] =
              (target_from_model * (part * Eigen::Vector3d(s.position_mm.cast<double>()))).cast<float>();
        }
        nearest_usable(level, {asked.data(), end - begin}, static_cast<float>(reach_mm),
                       {found.data(), end - begin});
        for (std::size_t i = begin; i < end; ++i) {
          const auto& [partner, partner_mm] = found[i - begin];
          if (partner < 0 || !lies_on(level, found[i - begin], asked[i - begin])) {
            continue;
          }
          const SurfaceSample& s = samples[i * every];
          const Eigen::Vector3d n_from =
              parts[s.row < row ? 0 : 1].rotation * Eigen::Vector3d(s.normal.cast<double>());
          const Eigen::Vector3d n_into =
              model_from_target.rotation *
              Eigen::Vector3d(level.normals[static_cast<std::size_t>(partner)].cast<double>());
          if (n_from.dot(n_into) < 0.7) {
            continue;
          }
          Pull& pull = out[t * count + i];
          pull.normal = (n_from + n_into).normalized();
          const Eigen::Vector3d from_partner_mm = (asked[i - begin] - partner_mm).cast<double>();
          pull.residual_mm = pull.normal.dot(model_from_target.rotation * from_partner_mm);
          pull.weight = static_cast<double>(s.weight) * tukey_weight(pull.residual_mm, kernel_mm);
          pull.at_mm = model_from_target * Eigen::Vector3d(asked[i - begin].cast<double>()) - center_mm;
          pull.jacobian << pull.at_mm.cross(pull.normal), pull.normal;
          pull.used = pull.weight > 0;
          if (!(s.row < row)) {
            pull.residual_mm -= pull.jacobian.dot(by);  // as if the second part had not been taken along
          }
          pull.target = t;
          pull.row = s.row;
          pull.crease = s.crease;
        }
      });
    }
    return out;
  }

  void move(const Change& change, float to_row) {
    for (std::size_t t = 0; t < before.size(); ++t) {
      before[t] =
          twisted(before[t], -change.poses[t] - change.taken_out[t].transpose() * change.by, center_mm);
    }
    by = change.by;
    row = to_row;
  }
};

/// The pulls on the step alone with all fitted, for its covariance.
std::vector<PullTerm> terms_of(const Pulls& pulls, const Change& change, std::size_t bin) {
  std::vector<PullTerm> out;
  out.reserve(pulls.all.size());
  for (const Pull& pull : pulls.all) {
    if (pull.used) {
      const Matrix6d taken_out = change.taken_out[pull.target];
      const double part = pulls.bin_of(pull.row) >= bin ? 1.0 : 0.0;
      const Vector6d pose = -change.poses[pull.target] - taken_out.transpose() * change.by;
      const double left_mm = pull.residual_mm + pull.jacobian.dot(pose + part * change.by);
      const Vector6d own = part * pull.jacobian - taken_out * pull.jacobian;
      out.push_back({pull.weight * left_mm * own, pull.at_mm, pull.normal, pull.crease, true});
    }
  }
  return out;
}

/// Right scans of the bunny and the dragon show a chi-square of up to 154, simulated tablets up to 9.
constexpr double kLeastChi2 = 250.0;
/// Of what steps for each other scan by itself explain: 0.84 at most on those scans, where it is their own
/// systematic error that does; 0.95 at least where something moved.
constexpr double kLeastCommon = 0.9;
/// A step of six numbers explains more than a drift of twelve: 1.06 at least where something moved at once,
/// 0.93 at most where it drifted.
constexpr double kLeastOfDrift = 1.0;
/// Less moves the model by no more than its samples lie apart.
constexpr double kLeastSpacings = 0.4;
/// What some of the samples must show of all this for the others to be asked: a part of what they do where
/// something moved, and of the squares that are left (0.001 of right scans of simulated tablets).
constexpr double kHintShare = 0.01;
constexpr double kHintCommon = 0.7;
constexpr double kHintOfDrift = 0.75;

}  // namespace

bool ScanStep::is_told(double spacing_mm) const {
  return chi2 >= kLeastChi2 && moved_mm >= kLeastSpacings * spacing_mm && common >= kLeastCommon &&
         of_drift >= kLeastOfDrift;
}

std::string reason_of(const ScanStep& step) {
  return "the tablet or the scanner moved during the scan, after about " +
         std::to_string(std::lround(100.0 * step.row)) + " % of it, by " +
         fixed_text(deg_from_rad(step.turn_rad), 1) + " degrees and " + fixed_text(step.shift_mm, 2) +
         " mm; drop it and scan again";
}

std::optional<ScanStep> find_step(const ScanSurface& scan, std::span<const ModelScan> model,
                                  const ModelFit& fit) {
  InTwo two{scan,
            targets_of(model, fit.targets, &ScanSurface::fine),
            fit.model_from_scanner * scan.centroid_mm,
            {}};
  if (two.targets.size() < kLeastOthers) {
    return std::nullopt;
  }
  two.before.assign(two.targets.size(), fit.model_from_scanner);
  Pulls pulls;
  std::size_t bin = 0;
  Change change;
  // False where too little is shared.
  const auto take_step = [&](double kernel, std::size_t every, bool is_first) {
    pulls.all = two.pulls(kernel * fit.residual_sigma_mm, every);
    if (is_first && !pulls.set_ends()) {
      return false;
    }
    pulls.sum_up(two.targets.size());
    bin = pulls.best_bin();
    change = pulls.step_after(bin);
    two.move(change, pulls.ends[bin - 1]);
    return pulls.weight > 0;
  };
  if (!take_step(kKernels.front(), kHintEvery, true)) {
    return std::nullopt;
  }
  if (!(change.gain >= kHintShare * (pulls.sum_of_squares() - change.gain_poses)) ||
      !(change.common() >= kHintCommon) || !(change.gain >= kHintOfDrift * pulls.drift_gain())) {
    return std::nullopt;
  }
  for (const double kernel : kKernels) {
    if (!take_step(kernel, 1, kernel == kKernels.front())) {
      return std::nullopt;
    }
  }
  const FitInformation found =
      fit_information(change.held, terms_of(pulls, change, bin), {pulls.radius_mm, scan.fine->spacing_mm});
  ScanStep out;
  out.row = static_cast<double>(pulls.ends[bin - 1]);
  out.shift_mm = change.by.tail<3>().norm();
  out.turn_rad = change.by.head<3>().norm();
  // Over points at this distance from the middle.
  out.moved_mm = std::hypot(out.shift_mm, std::sqrt(2.0 / 3.0) * pulls.radius_mm * out.turn_rad);
  out.chi2 = change.by.dot(found.information * change.by);
  out.of_drift = change.gain / pulls.drift_gain();
  out.common = change.common();
  return out;
}

}  // namespace dubsar

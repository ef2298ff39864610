// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_advice.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/number_text.h"
#include "core/units.h"
#include "registration/pin_contradiction.h"
#include "registration/pin_matching.h"

namespace dubsar {

namespace {

/// An error that no set of pins is good enough to bring down.
constexpr double kOpen = std::numeric_limits<double>::infinity();

/// Tips narrower than this, of their spread along the line, leave the turn about it to chance.
constexpr double kLineWidth = 0.15;

struct Edge {
  const char* name;
  Eigen::Vector3d way;
};

const std::array<Edge, 4>& edges() {
  static const std::array<Edge, 4> all{{{"left edge", {-1, 0, 0}},
                                        {"right edge", {1, 0, 0}},
                                        {"top edge", {0, 1, 0}},
                                        {"bottom edge", {0, -1, 0}}}};
  return all;
}

struct Expected {
  double turn_deg = kOpen;
  double surface_mm = kOpen;
  double width = 0;  ///< spread of the tips across the line that fits them best, of that along it
};

/// Horn's normal matrix for small errors: Σ w (|d|² I - d dᵀ) for the turn about the weighted middle of the
/// tips, Σ w I for the shift of the middle.
Expected expected_error(const std::vector<Eigen::Vector3d>& at, const std::vector<double>& variance,
                        const Eigen::Vector3d& surface_center, double surface_radius) {
  Expected out;
  if (at.size() < 3) {
    return out;
  }
  double total = 0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < at.size(); ++k) {
    total += 1.0 / variance[k];
    middle += at[k] / variance[k];
  }
  middle /= total;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < at.size(); ++k) {
    const Eigen::Vector3d d = at[k] - middle;
    moments += d * d.transpose() / variance[k];
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(moments);
  out.width = std::sqrt(std::max(0.0, spread.eigenvalues()[1]) / std::max(1e-12, spread.eigenvalues()[2]));
  const Eigen::Matrix3d information = moments.trace() * Eigen::Matrix3d::Identity() - moments;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information);
  if (!(eigen.eigenvalues()[0] > 1e-9)) {
    return out;
  }
  const Eigen::Matrix3d turn = information.inverse();
  out.turn_deg = deg_from_rad(std::sqrt(1.0 / eigen.eigenvalues()[0]));
  // The mean square displacement over a ball's surface about its centre is that of the centre and 2/3 r² of
  // the turn's.
  const Eigen::Vector3d lever = surface_center - middle;
  const double centre2 = 3.0 / total + lever.squaredNorm() * turn.trace() - lever.dot(turn * lever);
  out.surface_mm = std::sqrt(centre2 + 2.0 / 3.0 * surface_radius * surface_radius * turn.trace());
  return out;
}

class Adviser {
 public:
  Adviser(const ScanPins& scan, std::span<const ScanPins> earlier, const PinAdviceOptions& options)
      : scan_(scan), earlier_(earlier), options_(options) {
    for (const SeenPin& tip : scan.tips) {
      at_.push_back(tip.position_mm);
      variance_.push_back(2.0 * options.replaced_sigma_mm * options.replaced_sigma_mm +
                          std::max(0.0, tip.covariance_mm2.trace() / 3.0));
    }
    labelled_ = static_cast<std::size_t>(
        std::count_if(scan.tips.begin(), scan.tips.end(), [](const SeenPin& t) { return t.label >= 0; }));
  }

  PinAdvice run() {
    const Expected now = expected(at_, variance_);
    advice_.turn_sigma_deg = now.turn_deg;
    advice_.surface_sigma_mm = now.surface_mm;
    if (at_.empty()) {
      return fault(PinFault::kNotSeen, -1,
                   "no pin's tip is seen: check the tips' diameter, and that pins stand clear of the tablet");
    }
    const std::size_t least = least_pins();
    if (at_.size() < least) {
      return fault(PinFault::kTooFew, -1,
                   "too few pins are seen, " + std::to_string(at_.size()) + ", and needed are " +
                       std::to_string(least) +
                       (labelled_ < at_.size() ? " (fewer when they are labelled)" : "") +
                       ": set more at the " + best_edge(at_.size()).name);
    }
    if (now.width < kLineWidth) {
      return move(PinFault::kInLine, "the pins stand nearly in one line");
    }
    if (const PinAdvice close = too_close(); close.fault != PinFault::kNone) {
      return close;
    }
    if (now.turn_deg > options_.most_turn_deg || now.surface_mm > options_.most_surface_mm) {
      return move(PinFault::kBunched, "the pins stand too close together: good to " +
                                          fixed_text(now.turn_deg, 1) + " degrees only");
    }
    return against_earlier();
  }

 private:
  [[nodiscard]] std::size_t least_pins() const {
    return 2 * labelled_ > at_.size() ? options_.least_labelled : options_.least_unlabelled;
  }

  [[nodiscard]] Expected expected(const std::vector<Eigen::Vector3d>& at,
                                  const std::vector<double>& variance) const {
    return expected_error(at, variance, scan_.surface_center_mm, scan_.surface_radius_mm);
  }

  PinAdvice fault(PinFault what, int pin, std::string say) {
    advice_.fault = what;
    advice_.pin = pin;
    advice_.say = std::move(say);
    return advice_;
  }

  /// The edge that a tip is nearest to, seen from the surface's centre.
  [[nodiscard]] const Edge& edge_of(std::size_t pin) const {
    const Eigen::Vector3d d = at_[pin] - scan_.surface_center_mm;
    return *std::max_element(edges().begin(), edges().end(),
                             [&](const Edge& a, const Edge& b) { return a.way.dot(d) < b.way.dot(d); });
  }

  [[nodiscard]] std::string name(std::size_t pin) const {
    const int label = scan_.tips[pin].label;
    return label >= 0 ? "pin " + std::to_string(label) : std::string("a pin at the ") + edge_of(pin).name;
  }

  /// Where the pin (or one more, when it is at_.size()) serves best; its error then goes to *surface_mm.
  [[nodiscard]] const Edge& best_edge(std::size_t pin, double* surface_mm = nullptr) const {
    const Edge* best = &edges().front();
    double least = kOpen;
    double least_crowd = kOpen;
    for (const Edge& edge : edges()) {
      std::vector<Eigen::Vector3d> at = at_;
      std::vector<double> variance = variance_;
      at.resize(std::max(at.size(), pin + 1));
      variance.resize(at.size(), 2.0 * options_.replaced_sigma_mm * options_.replaced_sigma_mm);
      at[pin] = scan_.surface_center_mm + scan_.surface_radius_mm * edge.way;
      const double error = expected(at, variance).surface_mm;
      // With too few pins for any pose the emptiest edge is best.
      double crowd = 0;
      for (std::size_t k = 0; k < at_.size(); ++k) {
        crowd += k != pin ? edge.way.dot(at_[k] - scan_.surface_center_mm) : 0.0;
      }
      if (error < least || (error == least && crowd < least_crowd)) {
        least = error;
        least_crowd = crowd;
        best = &edge;
      }
    }
    if (surface_mm != nullptr) {
      *surface_mm = least;
    }
    return *best;
  }

  /// Names the pin that does most good elsewhere, and where.
  PinAdvice move(PinFault what, const std::string& why) {
    std::size_t best = 0;
    double least = kOpen;
    for (std::size_t k = 0; k < at_.size(); ++k) {
      double error = kOpen;
      (void)best_edge(k, &error);
      if (error < least) {
        least = error;
        best = k;
      }
    }
    return fault(what, static_cast<int>(best),
                 why + "; to be moved to the " + best_edge(best).name + ": " + name(best));
  }

  PinAdvice too_close() {
    std::size_t first = 0;
    std::size_t second = 0;
    double least = options_.too_close_mm;
    for (std::size_t a = 0; a < at_.size(); ++a) {
      for (std::size_t b = a + 1; b < at_.size(); ++b) {
        if ((at_[a] - at_[b]).norm() < least) {
          least = (at_[a] - at_[b]).norm();
          first = a;
          second = b;
        }
      }
    }
    if (first == second) {
      return {};
    }
    double error_first = kOpen;
    double error_second = kOpen;
    (void)best_edge(first, &error_first);
    (void)best_edge(second, &error_second);
    const std::size_t moved = error_first <= error_second ? first : second;
    const std::size_t stays = moved == first ? second : first;
    return fault(PinFault::kTooClose, static_cast<int>(moved),
                 name(moved) +
                     (scan_.tips[stays].label >= 0 ? " stands too close to " + name(stays)
                                                   : std::string(" stands too close to another")) +
                     " (" + fixed_text(least, 1) + " mm): move it to the " + best_edge(moved).name);
  }

  /// The earlier scan that shows most of the same pins.
  PinAdvice against_earlier() {
    if (earlier_.empty()) {
      return advice_;
    }
    const ScanPins* best_scan = nullptr;
    std::optional<PinMatch> best;
    for (const ScanPins& other : earlier_) {
      const std::vector<PinMatch> matches = match_pins(scan_.tips, other.tips, {});
      if (!matches.empty() && (!best || matches.front().score > best->score)) {
        best = matches.front();
        best_scan = &other;
      }
    }
    if (!best || best->pairs.size() < options_.least_labelled) {
      const std::size_t shared = best ? best->pairs.size() : 0;
      return fault(PinFault::kNotShared, -1,
                   "too few of its pins can be told to be those of an earlier scan, " +
                       std::to_string(shared) + ": leave at least " + std::to_string(least_pins()) +
                       " pins standing from scan to scan, put back where they were");
    }
    // Pins that bear one label in both scans and yet do not come together.
    for (std::size_t s = 0; s < scan_.tips.size(); ++s) {
      for (const SeenPin& t : best_scan->tips) {
        if (scan_.tips[s].label < 0 || scan_.tips[s].label != t.label) {
          continue;
        }
        const double off = (best->target_from_source * at_[s] - t.position_mm).norm();
        // Beyond what putting back, the pose and a click make of it.
        if (off > std::max(options_.too_close_mm, 5.0 * std::sqrt(variance_[s]))) {
          return fault(PinFault::kMoved, static_cast<int>(s), moved_pin(name(s), best_scan->id, off));
        }
      }
    }
    return advice_;
  }

  const ScanPins& scan_;
  std::span<const ScanPins> earlier_;
  const PinAdviceOptions& options_;
  std::vector<Eigen::Vector3d> at_;
  std::vector<double> variance_;  ///< per axis, of the difference between two scans
  std::size_t labelled_ = 0;
  PinAdvice advice_;
};

}  // namespace

PinAdvice advise_pins(const ScanPins& latest, std::span<const ScanPins> earlier,
                      const PinAdviceOptions& options) {
  return Adviser(latest, earlier, options).run();
}

}  // namespace dubsar

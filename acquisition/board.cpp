// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/board.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/number_text.h"

namespace dubsar {

namespace {

constexpr int kLeastCharucoCorners = 8;

cv::Ptr<cv::aruco::Dictionary> dictionary_for(const BoardSpec& spec) {
  // 4x4 markers are the largest for their size; the smallest set that is enough is the hardest to confuse.
  const int markers = spec.cols * spec.rows / 2;
  return cv::aruco::getPredefinedDictionary(markers <= 50    ? cv::aruco::DICT_4X4_50
                                            : markers <= 100 ? cv::aruco::DICT_4X4_100
                                            : markers <= 250 ? cv::aruco::DICT_4X4_250
                                                             : cv::aruco::DICT_4X4_1000);
}

cv::Ptr<cv::aruco::CharucoBoard> charuco(const BoardSpec& spec) {
  return cv::aruco::CharucoBoard::create(spec.cols, spec.rows, static_cast<float>(spec.square_mm),
                                         static_cast<float>(spec.marker_mm), dictionary_for(spec));
}

cv::Mat mat_of(const GrayView& image) {
  cv::Mat out(image.height, image.width, CV_8UC1);
  for (int v = 0; v < image.height; ++v) {
    std::memcpy(out.ptr(v), image.row(v), static_cast<std::size_t>(image.width));
  }
  return out;
}

/// 0 for what is no number; nothing of a board is 0.
double number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value) ? value : 0;
}

/// Half the side of the window in which each corner is refined: as large as it can be, for what it averages,
/// and small enough to reach neither the next corner's edges nor a marker. `per_row` 0: corners of which some
/// are missing, all with the window of the closest two.
std::vector<int> corner_windows(const std::vector<cv::Point2f>& corners, int per_row, double share) {
  const auto half = [&](double least_px) { return std::clamp(static_cast<int>(share * least_px), 2, 11); };
  const auto apart = [&](std::size_t i, std::size_t k) { return cv::norm(corners[i] - corners[k]); };
  if (per_row == 0) {
    double least = 1e9;
    for (std::size_t i = 1; i < corners.size(); ++i) {
      least = std::min(least, apart(i, i - 1));
    }
    return std::vector<int>(corners.size(), half(least));
  }
  const auto width = static_cast<std::size_t>(per_row);
  std::vector<int> out;
  out.reserve(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    double least = 1e9;
    least = i % width > 0 ? std::min(least, apart(i, i - 1)) : least;
    least = i % width + 1 < width ? std::min(least, apart(i, i + 1)) : least;
    least = i >= width ? std::min(least, apart(i, i - width)) : least;
    least = i + width < corners.size() ? std::min(least, apart(i, i + width)) : least;
    out.push_back(half(least));
  }
  return out;
}

void refine(const cv::Mat& image, std::vector<cv::Point2f>& corners, int per_row, double share) {
  const std::vector<int> windows = corner_windows(corners, per_row, share);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    std::vector<cv::Point2f> one{corners[i]};
    cv::cornerSubPix(image, one, {windows[i], windows[i]}, {-1, -1},
                     {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 40, 1e-3});
    corners[i] = one.front();
  }
}

std::string what_it_looks_like(const cv::Mat& image) {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(image, mean, deviation);
  if (mean[0] > 235) {
    return "the picture is overexposed";
  }
  if (mean[0] < 12 && deviation[0] < 12) {
    return "the picture is dark";
  }
  cv::Mat edges;
  cv::Laplacian(image, edges, CV_32F);
  cv::Scalar none;
  cv::Scalar sharpness;
  cv::meanStdDev(edges, none, sharpness);
  if (sharpness[0] < 0.06 * std::max(8.0, deviation[0])) {
    return "the picture is blurred";
  }
  return "the board is not the one that was named, or not wholly in sight";
}

}  // namespace

std::string BoardSpec::text() const {
  const std::string size = std::to_string(cols) + "x" + std::to_string(rows) + ":" + number_text(square_mm);
  return kind == BoardKind::kChessboard ? "chessboard:" + size
                                        : "charuco:" + size + ":" + number_text(marker_mm);
}

Eigen::Vector2d BoardSpec::low_mm() const {
  return kind == BoardKind::kChessboard ? Eigen::Vector2d(-2, -2) * square_mm : Eigen::Vector2d(0, 0);
}

Eigen::Vector2d BoardSpec::high_mm() const {
  return kind == BoardKind::kChessboard ? Eigen::Vector2d(cols + 1, rows + 1) * square_mm
                                        : Eigen::Vector2d(cols, rows) * square_mm;
}

int BoardSpec::corner_count() const {
  return kind == BoardKind::kChessboard ? cols * rows : (cols - 1) * (rows - 1);
}

Result<BoardSpec> parse_board(std::string_view text) {
  const auto wrong = [&] {
    return fail(ErrorKind::kUsage, "a board cannot be '" + std::string(text) + "'", {},
                "say chessboard:9x6:25 (inner corners, square in mm) or charuco:9x7:5:3.7 (squares, square, "
                "marker)");
  };
  std::vector<std::string_view> parts;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(':', at), text.size());
    parts.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  BoardSpec spec;
  const bool chess = parts[0] == "chessboard";
  if ((!chess && parts[0] != "charuco") || parts.size() != (chess ? 3U : 4U)) {
    return wrong();
  }
  spec.kind = chess ? BoardKind::kChessboard : BoardKind::kCharuco;
  const std::size_t by = parts[1].find('x');
  const double cols = number(parts[1].substr(0, by));
  const double rows = by == std::string_view::npos ? 0 : number(parts[1].substr(by + 1));
  const double square = number(parts[2]);
  const double marker = chess ? 0 : number(parts[3]);
  constexpr double kMost = 40;
  if (cols != std::floor(cols) || rows != std::floor(rows) || cols < 3 || rows < 3 || cols > kMost ||
      rows > kMost || !(square > 0 && square < 1e3) ||
      (!chess && !(marker > 0.3 * square && marker < 0.95 * square))) {
    return wrong();
  }
  spec.cols = static_cast<int>(cols);
  spec.rows = static_cast<int>(rows);
  spec.square_mm = square;
  spec.marker_mm = marker;
  return spec;
}

Result<BoardView> find_board(const GrayView& view, const BoardSpec& spec, const std::string& name) {
  const auto not_found = [&](const std::string& what) {
    return bad_input(name, what, "take it again: sharp, evenly lit, the whole board in sight");
  };
  if (view.empty() || view.width < 16 || view.height < 16) {
    return not_found("there is no picture");
  }
  try {
    const cv::Mat image = mat_of(view);
    std::vector<cv::Point2f> corners;
    BoardView out{name, view.width, view.height, {}, {}};
    if (spec.kind == BoardKind::kChessboard) {
      const bool found =
          cv::findChessboardCorners(image, {spec.cols, spec.rows}, corners,
                                    cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE);
      if (!found || static_cast<int>(corners.size()) != spec.corner_count()) {
        return not_found("no chessboard with " + std::to_string(spec.cols) + " x " +
                         std::to_string(spec.rows) + " inner corners: " + what_it_looks_like(image));
      }
      refine(image, corners, spec.cols, 0.3);
      for (int i = 0; i < spec.corner_count(); ++i) {
        const cv::Point2f& c = corners[static_cast<std::size_t>(i)];
        const int row = i / spec.cols;
        out.corners_px.emplace_back(static_cast<double>(c.x), static_cast<double>(c.y));
        out.corners_mm.emplace_back(spec.square_mm * (i % spec.cols), spec.square_mm * row, 0);
      }
      return out;
    }
    const cv::Ptr<cv::aruco::CharucoBoard> board = charuco(spec);
    std::vector<std::vector<cv::Point2f>> markers;
    std::vector<int> marker_ids;
    cv::aruco::detectMarkers(image, board->dictionary, markers, marker_ids);
    std::vector<int> ids;
    if (!marker_ids.empty()) {
      cv::aruco::interpolateCornersCharuco(markers, marker_ids, image, board, corners, ids);
    }
    if (static_cast<int>(ids.size()) < kLeastCharucoCorners) {
      return not_found("too few corners of the board were found, " + std::to_string(ids.size()) + ": " +
                       what_it_looks_like(image));
    }
    refine(image, corners, 0, 0.35 * (1 - spec.marker_mm / spec.square_mm));
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const cv::Point3f& p = board->chessboardCorners[static_cast<std::size_t>(ids[i])];
      out.corners_px.emplace_back(static_cast<double>(corners[i].x), static_cast<double>(corners[i].y));
      out.corners_mm.emplace_back(static_cast<double>(p.x), static_cast<double>(p.y), 0);
    }
    return out;
  } catch (const cv::Exception& defect) {
    return not_found("the search for the board failed: " + defect.err);
  }
}

GrayImage board_pattern(const BoardSpec& spec, int texels_per_square) {
  if (spec.kind == BoardKind::kChessboard) {
    // Inner corners: one square more than corners on either way, and a margin of one square.
    GrayImage out((spec.cols + 3) * texels_per_square, (spec.rows + 3) * texels_per_square, 255);
    for (int v = 0; v < out.height; ++v) {
      for (int u = 0; u < out.width; ++u) {
        const int col = u / texels_per_square - 1;
        const int row = v / texels_per_square - 1;
        const bool inside = col >= 0 && row >= 0 && col <= spec.cols && row <= spec.rows;
        if (inside && (col + row) % 2 == 0) {
          out.pixels[out.index(u, v)] = 0;
        }
      }
    }
    return out;
  }
  cv::Mat drawn;
  charuco(spec)->draw({spec.cols * texels_per_square, spec.rows * texels_per_square}, drawn, 0, 1);
  GrayImage out(drawn.cols, drawn.rows);
  for (int v = 0; v < drawn.rows; ++v) {
    std::memcpy(out.pixels.data() + out.index(0, v), drawn.ptr(v), static_cast<std::size_t>(drawn.cols));
  }
  return out;
}

}  // namespace dubsar

// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "core/gray_image.h"
#include "core/result.h"

namespace dubsar {

enum class BoardKind {
  kChessboard,  ///< found only when every corner is seen
  kCharuco,     ///< chessboard with markers: may be partly out of sight
};

/// A printed calibration board. Board frame: z = 0, x to the right and y down the pattern, z away from who
/// looks at it; the origin is the first inner corner of a chessboard, the outer corner of a ChArUco board.
struct BoardSpec {
  BoardKind kind = BoardKind::kCharuco;
  int cols = 9;  ///< inner corners of a chessboard, squares of a ChArUco board
  int rows = 7;
  double square_mm = 5;
  double marker_mm = 3.7;  ///< ChArUco only; markers of the ArUco dictionary 4x4

  [[nodiscard]] std::string text() const;
  /// Upper left and lower right of the printed pattern, mm in the board frame.
  [[nodiscard]] Eigen::Vector2d low_mm() const;
  [[nodiscard]] Eigen::Vector2d high_mm() const;
  [[nodiscard]] int corner_count() const;
};

/// "chessboard:9x6:25" (inner corners, square in mm) or "charuco:9x7:5:3.7" (squares, square, marker in mm).
/// Errors: kUsage.
[[nodiscard]] Result<BoardSpec> parse_board(std::string_view text);

/// The corners of a board in one picture.
struct BoardView {
  std::string name;
  int width = 0;  ///< of the picture
  int height = 0;
  std::vector<Eigen::Vector2d> corners_px;
  std::vector<Eigen::Vector3d> corners_mm;  ///< the same corners, board frame
};

/// Finds the board, corners to sub-pixel. Errors (kBadInput): not found or too little of it, with what the
/// picture looks like as the reason.
[[nodiscard]] Result<BoardView> find_board(const GrayView& image, const BoardSpec& spec,
                                           const std::string& name);

/// The pattern for printing or simulating, from low_mm() to high_mm(), with a white margin of one square
/// around a chessboard.
[[nodiscard]] GrayImage board_pattern(const BoardSpec& spec, int texels_per_square);

}  // namespace dubsar

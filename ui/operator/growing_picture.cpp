// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/growing_picture.h"

#include <algorithm>

#include "ui/operator/operator_screen.h"

namespace dubsar::ui {

namespace {

constexpr int kFewestRows = 256;  ///< that a texture has room for

}  // namespace

void GrowingPicture::update(LiveSession& session, const UiContext& ui) {
  const bool repaint = dark_ != ui.preferences.dark || blue_ != ui.preferences.blue_for_red;
  dark_ = ui.preferences.dark;
  blue_ = ui.preferences.blue_for_red;
  const GrowingRows news = session.look_at_growing(scan_, repaint ? 0 : rows_);
  since_ = news.since;
  scan_ = news.scan;
  rows_ = news.total;
  if (news.rows.rows == 0 || news.rows.cols == 0) {
    return;
  }
  const std::vector<unsigned char> painted = coloured(news.rows, ui);
  const std::size_t row_bytes = static_cast<std::size_t>(news.rows.cols) * 3;
  const bool has_room =
      texture_.id() != 0 && texture_.width() == news.rows.cols && texture_.height() >= news.total;
  if (!has_room) {
    // Twice as much each time, so that a long scan is seldom moved; not so much that the card would leave out
    // rows for which it still has room.
    const int most = PixelTexture::finest();
    const int twice = std::max(kFewestRows, 2 * news.total);
    const int room = news.total <= most ? std::min(twice, most) : twice;
    pixels_.resize(row_bytes * static_cast<std::size_t>(room));
  }
  std::ranges::copy(painted, pixels_.begin() + static_cast<std::ptrdiff_t>(row_bytes) * news.first);
  if (has_room) {
    texture_.put_rows(news.first, news.rows.rows, painted.data());
  } else {
    texture_.upload(news.rows.cols, static_cast<int>(pixels_.size() / row_bytes), 3, pixels_.data(), false);
  }
}

}  // namespace dubsar::ui

#include "host/dataset/contact_sheet.hpp"

#include <algorithm>

#include "host/base/error.hpp"
#include "host/formats/pixel_font.hpp"

namespace pvg {
namespace {

constexpr int MARGIN = 8;  // [pixels]
constexpr Color8 PAPER = {250, 250, 248}, INK = {30, 30, 36}, FAINT_INK = {110, 110, 120};

void paste(Picture8& onto, const Picture8& picture, int x, int y) {
  for (int row = 0; row < picture.height; ++row)
    std::copy_n(&picture.rgb[std::size_t(row * picture.width) * 3], std::size_t(picture.width) * 3,
                &onto.rgb[std::size_t((y + row) * onto.width + x) * 3]);
}

std::string cut(const std::string& text, int width, int size) {
  return text.substr(0, std::size_t(std::max(0, letters_that_fit(width, size))));
}

void check_shape(const ContactSheet& sheet) {
  if (sheet.pictures.size() != sheet.rows.size()) throw Failure("the contact sheet has rows without a name");
  for (const std::vector<Picture8>& row : sheet.pictures)
    for (const Picture8& picture : row)
      if (row.size() != sheet.columns.size() || picture.width != row.front().width ||
          picture.height != row.front().height)
        throw Failure("the contact sheet's pictures are not of one size per row");
}

}  // namespace

std::vector<std::size_t> evenly_spread(std::size_t n, std::size_t n_columns) {
  std::vector<std::size_t> chosen;
  const std::size_t count = std::min(n, n_columns);
  for (std::size_t i = 0; i < count; ++i)
    chosen.push_back(count == 1 ? 0 : (i * (n - 1) + (count - 1) / 2) / (count - 1));
  return chosen;
}

Picture8 lay_out(const ContactSheet& sheet) {
  check_shape(sheet);
  const std::size_t n = sheet.columns.size(), beside = std::max<std::size_t>(1, std::min(n, sheet.columns_beside));
  int cell = 0, band = LETTER_HEIGHT + MARGIN / 2;  // width of a picture; height of a band [pixels]
  for (const std::vector<Picture8>& row : sheet.pictures)
    if (!row.empty()) {
      cell = std::max(cell, row.front().width);
      band += LETTER_HEIGHT + 2 + row.front().height + MARGIN;
    }
  const int n_bands = int((n + beside - 1) / beside), top = MARGIN + 2 * LETTER_HEIGHT + MARGIN;
  Picture8 page{std::max(MARGIN + int(beside) * (cell + MARGIN), 240), top + n_bands * (band + MARGIN), {}};
  page.rgb.resize(std::size_t(page.width) * std::size_t(page.height) * 3);
  for (std::size_t i = 0; i < page.rgb.size(); ++i) page.rgb[i] = PAPER[i % 3];

  draw_text(page, MARGIN, MARGIN, cut(sheet.title, page.width - 2 * MARGIN, 2), 2, INK);
  for (std::size_t c = 0; c < n; ++c) {
    const int x = MARGIN + int(c % beside) * (cell + MARGIN);
    int y = top + int(c / beside) * (band + MARGIN);
    draw_text(page, x, y, cut(sheet.columns[c], cell, 1), 1, INK);
    y += LETTER_HEIGHT + MARGIN / 2;
    for (std::size_t r = 0; r < sheet.rows.size(); ++r) {
      if (c % beside == 0) draw_text(page, x, y, cut(sheet.rows[r], cell, 1), 1, FAINT_INK);
      paste(page, sheet.pictures[r][c], x, y + LETTER_HEIGHT + 2);
      y += LETTER_HEIGHT + 2 + sheet.pictures[r][c].height + MARGIN;
    }
  }
  return page;
}

}  // namespace pvg

#include "host/calibration/board.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "host/base/atomic_files.hpp"
#include "host/base/counted.hpp"
#include "host/base/error.hpp"

namespace pvg {

namespace {

constexpr const char* KINDS[] = {"charuco", "chessboard", "tags"};

}  // namespace

Board parse_board(const std::string& text) {
  const std::string shape = "; a board is KIND,COLUMNSxROWS,SQUARE[,TAG] in mm, such as charuco,7x5,30,22";
  Board board;
  char kind[16] = {};
  double square = 0, tag = 0;
  int length = 0;
  const int n = std::sscanf(text.c_str(), "%15[a-z],%dx%d,%lf%n,%lf%n", kind, &board.columns, &board.rows, &square,
                            &length, &tag, &length);
  int found = -1;
  for (int i = 0; i < 3; ++i)
    if (std::string(kind) == KINDS[i]) found = i;
  if (n < 4 || std::size_t(length) != text.size())
    throw UsageError("the board `" + text + "` is not understood" + shape);
  if (found < 0) throw UsageError("the board `" + text + "`: its kind must be charuco, chessboard or tags" + shape);
  board.kind = Board::Kind(found);
  board.square = square * 1e-3;
  board.tag = tag * 1e-3;
  if (board.columns < 2 || board.rows < 2 || board.columns > 40 || board.rows > 40)
    throw UsageError("the board `" + text + "` must have 2 to 40 columns and rows" + shape);
  if (!(square >= 1 && square <= 1000)) throw UsageError("the board `" + text + "`: squares of 1 to 1000 mm" + shape);
  if (board.kind == Board::Kind::chessboard ? n != 4 : !(n == 5 && tag > 0 && tag < square))
    throw UsageError("the board `" + text +
                     "`: charuco and tags need a tag smaller than the square, a chessboard none" + shape);
  const int n_tags = board.kind == Board::Kind::tags ? board.columns * board.rows : board.columns * board.rows / 2;
  if (board.kind != Board::Kind::chessboard && n_tags > 587)
    throw UsageError("the board `" + text + "` needs " + counted(n_tags, "tag") + "; the family 36h11 has 587");
  return board;
}

std::string name_of(const Board& board) {
  std::string name =
      fmt::format("{},{}x{},{:g}", KINDS[int(board.kind)], board.columns, board.rows, board.square * 1e3);
  return board.kind == Board::Kind::chessboard ? name : name + fmt::format(",{:g}", board.tag * 1e3);
}

Vec2f board_size(const Board& board) {
  const double gap = board.kind == Board::Kind::tags ? board.square - board.tag : 0;
  return {float(board.columns * board.square - gap), float(board.rows * board.square - gap)};
}

void write_board_svg(const std::filesystem::path& file, const Board& board) {
  const Vec2f size = board_size(board);
  const double margin = board.square, w = size.x() + 2 * margin, h = size.y() + 2 * margin;
  std::string text = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0:.3f}mm' height='{1:.3f}mm' viewBox='0 0 {0:.3f} {1:.3f}' "
      "shape-rendering='crispEdges'>\n<rect width='100%' height='100%' fill='white'/>\n<path fill='black' d='",
      1e3 * w, 1e3 * h);
  for (const BlackRectangle& r : board_rectangles(board))
    text += fmt::format("M{:.4f} {:.4f}h{:.4f}v{:.4f}h{:.4f}z", 1e3 * (margin + r.x),
                        1e3 * (margin + size.y() - r.y - r.height), 1e3 * r.width, 1e3 * r.height, -1e3 * r.width);
  const double low = 1e3 * (h - 0.3 * margin);
  text += fmt::format(
      "'/>\n<path stroke='black' stroke-width='0.3' fill='none' d='M{0:.2f} {1:.2f}v2h100v-2'/>\n<text x='{2:.2f}' "
      "y='{1:.2f}' font-family='sans-serif' font-size='4'>100 mm; {3}; print without scaling</text>\n</svg>\n",
      1e3 * margin, low, 1e3 * margin + 104, name_of(board));
  write_text_atomically(file, text);
}

Texture board_picture(const Board& board, double resolution) {
  const Vec2f size = board_size(board);
  Texture picture;
  picture.width = int(std::lround(size.x() * resolution));
  picture.height = int(std::lround(size.y() * resolution));
  picture.rgba.assign(std::size_t(picture.width) * std::size_t(picture.height) * 4, 255);
  for (const BlackRectangle& r : board_rectangles(board)) {
    const int left = int(std::lround(r.x * resolution)), right = int(std::lround((r.x + r.width) * resolution));
    const int top = picture.height - int(std::lround((r.y + r.height) * resolution)),
              low = picture.height - int(std::lround(r.y * resolution));
    for (int y = std::max(0, top); y < std::min(low, picture.height); ++y)
      for (int x = std::max(0, left); x < std::min(right, picture.width); ++x)
        for (int k = 0; k < 3; ++k)
          picture.rgba[4 * (std::size_t(y) * std::size_t(picture.width) + std::size_t(x)) + std::size_t(k)] = 0;
  }
  return picture;
}

}  // namespace pvg

// Boards that a camera is calibrated by: what to print, and what is found of them in a photo.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/geometry/mesh.hpp"
#include "host/pictures/picture.hpp"

namespace pvg {

// Tags are those of AprilTag's family 36h11.
struct Board {
  enum class Kind { charuco, chessboard, tags };
  Kind kind = Kind::charuco;
  int columns = 7, rows = 5;  // squares; of a grid of tags: tags
  double square = 0.03;       // edge of a square; of a grid: distance of tags' left edges [m]
  double tag = 0.022;         // edge of a tag, its black border included [m]
};

// "charuco,7x5,30,22": kind, columns x rows, edge of a square, of a tag [mm]; a chessboard has no tags. A UsageError
// says what is wrong with it.
Board parse_board(const std::string& text);
std::string name_of(const Board& board);  // as parse_board reads it

// The black rectangles of a board on white paper, from the lower left corner, y up  [m].
struct BlackRectangle {
  double x, y, width, height;
};
std::vector<BlackRectangle> board_rectangles(const Board& board);
Vec2f board_size(const Board& board);  // [m]

// An SVG in true size, with a margin of one square, a scale of 100 mm and the board's name.
void write_board_svg(const std::filesystem::path& file, const Board& board);

// The board without margin, `resolution` pixels per metre.
Texture board_picture(const Board& board, double resolution);

// A corner of the board in a photo.
struct BoardCorner {
  int id = 0;
  Vec3 point = Vec3::Zero();                        // on the board, from its lower left corner, y up, z = 0 [m]
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // OpenCV: (0, 0) is the centre of the top left pixel
};
std::vector<BoardCorner> find_board(const Picture8& photo, const Board& board);
// The same in the photo mirrored left to right, whose pixels are given: what a board that was printed mirrored or is
// seen from behind gives. A chessboard looks like its mirror image and is found by find_board.
std::vector<BoardCorner> find_mirrored_board(const Picture8& photo, const Board& board);

// A tag of the family 36h11 in a photo: its corners as the tag library orders them, counter-clockwise from the lower
// left one as the tag stands upright (in the picture: left below, right below, right above, left above).
struct FoundTag {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corners;  // [pixels]; OpenCV: (0, 0) is the centre of the top left pixel
};
std::vector<FoundTag> find_tags(const Picture8& photo);
// The same with the corners of large tags refined in linear light: what a camera's place is computed from.
std::vector<FoundTag> find_tags_finely(const Picture8& photo);

}  // namespace pvg

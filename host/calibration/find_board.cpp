// Boards and tags in photos: tags by the AprilTag library, corners of squares by OpenCV.
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "host/calibration/board.hpp"
#include "host/pictures/srgb.hpp"

namespace pvg {
namespace {

constexpr int TAG_CELLS = 8;         // of 36h11: six bits and the black border on both sides
constexpr double HALF = 0.5;         // the library counts from the corner of the first pixel, OpenCV from its centre
constexpr float SHARPENING = 0.25f;  // before bits are read; 0 loses small tags, 0.5 makes false ones
constexpr double SMALLEST_REFINED = 32;       // edge of a tag from which its corners are refined [pixels]
constexpr double LARGEST_REFINEMENT = 1;      // [pixels]; what would move farther was drawn to something else
constexpr double LARGEST_DISAGREEMENT = 0.2;  // of two tags on the corner between them, as a share of the square

struct Detector {
  apriltag_family_t* family = tag36h11_create();
  apriltag_detector_t* detector = apriltag_detector_create();
  Detector() {
    apriltag_detector_add_family(detector, family);
    detector->quad_decimate = 1;  // small tags are lost at half the size
    detector->refine_edges = 0;   // moves corners of small tags by up to two pixels
    detector->decode_sharpening = SHARPENING;
  }
  ~Detector() {
    apriltag_detector_destroy(detector);
    tag36h11_destroy(family);
  }
  Detector(const Detector&) = delete;
};

cv::Mat gray_of(const Picture8& photo) {
  const cv::Mat rgb(photo.height, photo.width, CV_8UC3, const_cast<std::uint8_t*>(photo.rgb.data()));
  cv::Mat gray;
  cv::cvtColor(rgb, gray, cv::COLOR_RGB2GRAY);
  return gray;
}

struct DetectedTag {
  FoundTag tag;
  cv::Matx33d to_picture;  // of the tag's frame: its black border from -1 to 1, y down
};

// In the picture's coded values a soft edge seems to lie on its dark side, by some tenths of a pixel; in linear light
// it does not.
cv::Mat linear_of(const cv::Mat& gray) {
  cv::Mat linear(gray.size(), CV_32F);
  for (int y = 0; y < gray.rows; ++y)
    for (int x = 0; x < gray.cols; ++x)
      linear.at<float>(y, x) = 255 * srgb_to_linear(float(gray.at<std::uint8_t>(y, x)) / 255);
  return linear;
}

// Large tags have room for a
// window that reaches neither their bits nor beyond the white around them, which is as wide as their border.
void refine_corners(const cv::Mat& linear, FoundTag& tag) {
  double side = INFINITY;
  for (std::size_t k = 0; k < 4; ++k) side = std::min(side, (tag.corners[k] - tag.corners[(k + 1) % 4]).norm());
  if (!(side >= SMALLEST_REFINED)) return;
  const int reach = int(0.8 * side / TAG_CELLS);
  for (Eigen::Vector2d& corner : tag.corners) {
    if (corner.x() < reach + 2 || corner.y() < reach + 2 || corner.x() > linear.cols - reach - 3 ||
        corner.y() > linear.rows - reach - 3)
      continue;
    std::vector<cv::Point2f> refined = {{float(corner.x()), float(corner.y())}};
    cv::cornerSubPix(linear, refined, {reach, reach}, {-1, -1},
                     {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-3});
    const Eigen::Vector2d pixel(double(refined[0].x), double(refined[0].y));
    if ((pixel - corner).norm() <= LARGEST_REFINEMENT) corner = pixel;
  }
}

std::vector<DetectedTag> detect(const cv::Mat& gray) {
  const Detector with;
  image_u8_t image{gray.cols, gray.rows, int(gray.step), gray.data};
  zarray_t* list = apriltag_detector_detect(with.detector, &image);
  std::vector<DetectedTag> found;
  for (int i = 0; i < zarray_size(list); ++i) {
    apriltag_detection_t* each = nullptr;
    zarray_get(list, i, &each);
    DetectedTag detected;
    detected.tag.id = each->id;
    for (std::size_t k = 0; k < 4; ++k) detected.tag.corners[k] = {each->p[k][0] - HALF, each->p[k][1] - HALF};
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) detected.to_picture(r, c) = MATD_EL(each->H, unsigned(r), unsigned(c));
    found.push_back(detected);
  }
  apriltag_detections_destroy(list);
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.tag.id < b.tag.id; });
  return found;
}

// a tag that is seen twice is a reflection, or two boards: neither counts
std::vector<DetectedTag> without_doubles(std::vector<DetectedTag> tags) {
  std::map<int, int> count;
  for (const DetectedTag& tag : tags) ++count[tag.tag.id];
  std::erase_if(tags, [&](const DetectedTag& tag) { return count[tag.tag.id] > 1; });
  return tags;
}

// Lower left corners of the tags of a board, by their number: row by row from the upper left.
std::vector<Eigen::Vector2d> tag_places(const Board& board) {
  std::vector<Eigen::Vector2d> places;
  const bool is_grid = board.kind == Board::Kind::tags;
  const double margin = is_grid ? 0 : (board.square - board.tag) / 2;
  for (int y = board.rows - 1; y >= 0; --y)
    for (int x = 0; x < board.columns; ++x)
      if (is_grid || (x + y) % 2 == 1) places.emplace_back(x * board.square + margin, y * board.square + margin);
  return places;
}

void add_tag(std::vector<BlackRectangle>& black, apriltag_family_t* family, int id, const Eigen::Vector2d& at,
             double size) {
  std::array<std::array<bool, TAG_CELLS>, TAG_CELLS> is_black;  // [row, column]
  for (auto& row : is_black) row.fill(true);
  for (unsigned bit = 0; bit < family->nbits; ++bit)  // the first bit is the code's highest
    if (family->codes[id] >> (family->nbits - 1 - bit) & 1) is_black[family->bit_y[bit]][family->bit_x[bit]] = false;
  const double cell = size / TAG_CELLS;
  for (int j = 0; j < TAG_CELLS; ++j)
    for (int i = 0; i < TAG_CELLS; ++i) {
      int end = i;  // runs of black cells, so that no seam shows
      while (end < TAG_CELLS && is_black[std::size_t(j)][std::size_t(end)]) ++end;
      if (end > i) black.push_back({at.x() + i * cell, at.y() + (TAG_CELLS - 1 - j) * cell, (end - i) * cell, cell});
      i = std::max(i, end);
    }
}

std::vector<BoardCorner> find_chessboard(const cv::Mat& gray, const Board& board) {
  std::vector<cv::Point2f> corners;
  const cv::Size inner(board.columns - 1, board.rows - 1);
  if (!cv::findChessboardCornersSB(gray, inner, corners, cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY)) return {};
  std::vector<BoardCorner> found;
  for (int i = 0; i < int(corners.size()); ++i)
    found.push_back({i,
                     {(i % inner.width + 1) * board.square, (board.rows - 1 - i / inner.width) * board.square, 0},
                     {double(corners[std::size_t(i)].x), double(corners[std::size_t(i)].y)}});
  return found;
}

std::vector<BoardCorner> find_tag_grid(const std::vector<DetectedTag>& tags, const Board& board) {
  const std::vector<Eigen::Vector2d> places = tag_places(board);
  std::vector<BoardCorner> found;
  for (const DetectedTag& each : tags)
    for (int k = 0; std::size_t(each.tag.id) < places.size() && k < 4; ++k) {
      const Eigen::Vector2d at = places[std::size_t(each.tag.id)];
      found.push_back({4 * each.tag.id + k,
                       {at.x() + (k == 1 || k == 2 ? board.tag : 0), at.y() + (k >= 2 ? board.tag : 0), 0},
                       each.tag.corners[std::size_t(k)]});
    }
  return found;
}

// Corners of squares: where the tags beside them say, then refined to where four squares meet.
std::vector<BoardCorner> find_charuco(const cv::Mat& gray, const std::vector<DetectedTag>& tags, const Board& board) {
  const std::vector<Eigen::Vector2d> places = tag_places(board);
  std::vector<BoardCorner> found;
  for (int y = 1; y < board.rows; ++y)
    for (int x = 1; x < board.columns; ++x) {
      const Eigen::Vector2d corner(x * board.square, y * board.square);
      std::vector<Eigen::Vector2d> predicted;
      double gap = 1e9, side = 1e9;  // between corner and tag, and of a square [pixels]
      for (const DetectedTag& each : tags) {
        if (std::size_t(each.tag.id) >= places.size()) continue;
        const Eigen::Vector2d middle = places[std::size_t(each.tag.id)] + Eigen::Vector2d::Constant(board.tag / 2);
        const Eigen::Vector2d off = (corner - middle) / (board.tag / 2);
        if ((corner - middle).norm() > board.square) continue;  // of another square
        const cv::Vec3d p = each.to_picture * cv::Vec3d(off.x(), -off.y(), 1);
        predicted.emplace_back(p[0] / p[2] - HALF, p[1] / p[2] - HALF);
        const double tag_side = (each.tag.corners[0] - each.tag.corners[1]).norm();
        const double low = std::min(tag_side, (each.tag.corners[1] - each.tag.corners[2]).norm());
        side = std::min(side, low * board.square / board.tag);
        gap = std::min(gap, low * (board.square - board.tag) / 2 / board.tag);
      }
      if (predicted.empty()) continue;
      if (predicted.size() == 2 && (predicted[0] - predicted[1]).norm() > LARGEST_DISAGREEMENT * side) continue;
      Eigen::Vector2d start = Eigen::Vector2d::Zero();
      for (const Eigen::Vector2d& p : predicted) start += p / double(predicted.size());
      const int reach = std::clamp(int(gap), 2, 8);
      if (start.x() < reach + 2 || start.y() < reach + 2 || start.x() > gray.cols - reach - 3 ||
          start.y() > gray.rows - reach - 3)
        continue;
      std::vector<cv::Point2f> refined = {{float(start.x()), float(start.y())}};
      cv::cornerSubPix(gray, refined, {reach, reach}, {-1, -1},
                       {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-3});
      const Eigen::Vector2d pixel(double(refined[0].x), double(refined[0].y));
      if ((pixel - start).norm() > reach) continue;
      found.push_back({(y - 1) * (board.columns - 1) + x - 1, {corner.x(), corner.y(), 0}, pixel});
    }
  return found;
}

std::vector<BoardCorner> find_in(const cv::Mat& gray, const Board& board) {
  if (board.kind == Board::Kind::chessboard) return find_chessboard(gray, board);
  std::vector<DetectedTag> tags = without_doubles(detect(gray));
  if (board.kind == Board::Kind::tags) {
    const cv::Mat linear = linear_of(gray);
    for (DetectedTag& each : tags) refine_corners(linear, each.tag);
  }
  return board.kind == Board::Kind::tags ? find_tag_grid(tags, board) : find_charuco(gray, tags, board);
}

}  // namespace

std::vector<BlackRectangle> board_rectangles(const Board& board) {
  std::vector<BlackRectangle> black;
  if (board.kind != Board::Kind::tags)
    for (int y = 0; y < board.rows; ++y)
      for (int x = 0; x < board.columns; ++x)
        if ((x + y) % 2 == 0) black.push_back({x * board.square, y * board.square, board.square, board.square});
  if (board.kind == Board::Kind::chessboard) return black;
  const Detector with;
  const std::vector<Eigen::Vector2d> places = tag_places(board);
  for (std::size_t id = 0; id < places.size(); ++id) add_tag(black, with.family, int(id), places[id], board.tag);
  return black;
}

std::vector<BoardCorner> find_board(const Picture8& photo, const Board& board) {
  return find_in(gray_of(photo), board);
}

std::vector<BoardCorner> find_mirrored_board(const Picture8& photo, const Board& board) {
  cv::Mat mirrored;
  cv::flip(gray_of(photo), mirrored, 1);  // about the vertical axis
  return find_in(mirrored, board);
}

std::vector<FoundTag> find_tags(const Picture8& photo) {
  std::vector<FoundTag> found;
  for (const DetectedTag& each : detect(gray_of(photo))) found.push_back(each.tag);
  return found;
}

std::vector<FoundTag> find_tags_finely(const Picture8& photo) {
  std::vector<FoundTag> found = find_tags(photo);
  const cv::Mat linear = linear_of(gray_of(photo));
  for (FoundTag& tag : found) refine_corners(linear, tag);
  return found;
}

}  // namespace pvg

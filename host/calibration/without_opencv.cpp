// What stands in where OpenCV or the AprilTag library was not found.
#include "host/base/error.hpp"
#include "host/calibration/hand_eye.hpp"
#include "host/calibration/tag_frame.hpp"

namespace pvg {
namespace {

[[noreturn]] void refuse() {
  throw UsageError(
      "this program was built without OpenCV and the AprilTag library; run scripts/install_calibration.sh "
      "and build again");
}

}  // namespace

std::vector<BlackRectangle> board_rectangles(const Board&) { refuse(); }
std::vector<BoardCorner> find_board(const Picture8&, const Board&) { refuse(); }
std::vector<BoardCorner> find_mirrored_board(const Picture8&, const Board&) { refuse(); }
std::vector<FoundTag> find_tags(const Picture8&) { refuse(); }
std::vector<FoundTag> find_tags_finely(const Picture8&) { refuse(); }
CameraCalibration calibrate_camera(std::vector<BoardPhoto>, int, int, const CalibrationSettings&) { refuse(); }
HandEye calibrate_hand_eye(std::vector<HandPhoto>, const std::vector<PlacedTag>&, const Camera&) { refuse(); }
CameraPlace place_camera(const std::vector<FoundTag>&, const std::vector<PlacedTag>&, const Camera&) { refuse(); }
TagFrame locate_tags(std::span<const TagPhoto>, const std::vector<PlacedTag>&, double) { refuse(); }

}  // namespace pvg

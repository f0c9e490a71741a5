// The planes of a room and the frame that they give it.
#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/capture/room.hpp"

namespace pvg {
namespace {

constexpr double UPRIGHT = 0.8;  // cosine between a plane's normal and up from which it can be the ground

int choose_ground(const std::vector<CapturedPlane>& planes, const Vec3& up, int asked) {
  if (asked >= int(planes.size()))
    throw UsageError("--ground " + std::to_string(asked) + ": only " +
                     counted(planes.size(), "plane was", "planes were") +
                     " found; they count from 0, the largest first");
  if (asked >= 0) return asked;
  for (int i = 0; i < int(planes.size()); ++i)
    if (planes[std::size_t(i)].pose.linear().col(2).dot(up) > UPRIGHT) return i;
  return -1;
}

// z along the ground's normal, the origin in the middle of its rectangle, x along its longer side, away from the eye
Pose frame_on(const CapturedPlane& ground, const Vec3& eye) {
  Pose pose = ground.pose;
  if ((eye - pose.translation()).dot(pose.linear().col(0)) > 0) {
    pose.linear().col(0) *= -1;
    pose.linear().col(1) *= -1;
  }
  return pose.inverse();
}

void move(std::vector<Vec3f>& points, const Pose& to_room) {
  const Eigen::Isometry3f by = to_room.cast<float>();
  for (Vec3f& p : points) p = by * p;
}

}  // namespace

void place_room(const RoomSettings& settings, const Vec3& up, const Vec3& eye, Room& room) {
  room.planes = find_planes(room.mesh.points, room.mesh.triangles, settings.planes);
  room.is_placed = settings.room_from_capture.has_value();
  const Vec3 upward = room.is_placed ? Vec3(settings.room_from_capture->linear().row(2)) : up;
  if (!settings.keeps_frame) room.ground = choose_ground(room.planes, upward, settings.ground);
  if (room.is_placed)
    room.room_from_capture = *settings.room_from_capture;
  else if (room.ground >= 0)
    room.room_from_capture = frame_on(room.planes[std::size_t(room.ground)], eye);
  move(room.mesh.points, room.room_from_capture);
  for (CapturedSurface& look : room.looks) move(look.mesh.points, room.room_from_capture);
  move(room.background.points, room.room_from_capture);
  for (CapturedPlane& plane : room.planes) plane.pose = room.room_from_capture * plane.pose;
}

}  // namespace pvg

// Light tracing (Arvo 1986; Dutre et al. 1993): paths from the lamps over mirror-like surfaces, glass or metal, to surfaces
// that scatter; each of these is joined with the camera. The camera's own paths find the same light where they
// meet the lamp by chance; both are weighted against each other (power heuristic, Veach 1997), by what they have per path,
// area [m^2] and projected solid angle [sr]:
//   from the lamp     p_lamp / area * p_aim / cos_lamp                 emission_density
//   from the camera   pixels / sr * cos_camera / distance^2 * p / cos  camera_density
// p: density of the direction that it scattered in [1/sr].
// Mirror-like surfaces keep the volume in phase space, and choose with the same chance both ways: they change neither. A
// surface that scatters has p / cos of one way in place of p / cos of the other (scattered_ratio).
#ifndef PVG_RENDER_LIGHT_TRACING_CL
#define PVG_RENDER_LIGHT_TRACING_CL
#include "render/lights.cl"
#include "sensors/camera.cl"

// share of the way with density a; neither may be squared alone, small lamps have large ones
static inline float traced_weight(const float a, const float b) {
  const float ratio = b / a;
  return a > 0 ? 1.0f / (1.0f + ratio * ratio) : 0.0f;
}

// random numbers of light paths, apart from those of the pixels
#define LIGHT_PATH_KEY 0x2545f491u

// so that a ratio of two stays a number
#define MOST_DENSITY 1e30f

// Whether light paths bring what a camera's path with these flags has met: only where the camera sees the path's first
// surface that scatters, where no such surface lets light through, and from lamps in the open air. The rest, such as what
// a lamp inside of a solid sends, is left to the camera's paths
static inline bool is_light_traced(const Launch launch, const uint flags, const float pdf, const uint media) {
  return launch.n_light_paths > 0 && (flags & PATH_SEEN) && pdf == 0 && media == 0;
}

// Directions of light paths are drawn evenly in the cones that the targets fill, by their solid angle: spheres around
// all that is mirror-like. Its density [1/sr]; 0: not in any cone
static inline float aim_pdf(const Launch launch, global const float4* targets, const float3 point, const float3 d) {
  float solid_angle = 0.0f, n_cones = 0.0f;
  for (uint k = 0; k < launch.n_targets; ++k) {
    const float4 target = targets[k];
    const float3 v = target.xyz - point;
    const float d2 = dot(v, v), radius2 = target.w * target.w;
    const bool is_inside = d2 <= radius2;
    solid_angle += is_inside ? 4.0f * M_PI_F : 2.0f * M_PI_F * cone_height(target.w, d2);
    const float3 beside = cross(v, d);
    n_cones += is_inside || (dot(v, d) > 0 && dot(beside, beside) <= radius2) ? 1.0f : 0.0f;
  }
  return solid_angle > 0 ? n_cones / solid_angle : 0.0f;
}

// u: in the cone;  choice: of the target
static inline float3 aim(const Launch launch, global const float4* targets, const float3 point, const float2 u,
                         const float choice) {
  float solid_angle = 0.0f;
  for (uint k = 0; k < launch.n_targets; ++k) {
    const float3 v = targets[k].xyz - point;
    const float d2 = dot(v, v);
    solid_angle += d2 <= targets[k].w * targets[k].w ? 2.0f : cone_height(targets[k].w, d2);
  }
  float rest = choice * solid_angle, height = 2.0f;
  float3 axis = (float3)(0, 0, 1);
  for (uint k = 0; k < launch.n_targets; ++k) {
    const float3 v = targets[k].xyz - point;
    const float d2 = dot(v, v);
    const bool is_inside = d2 <= targets[k].w * targets[k].w;
    height = is_inside ? 2.0f : cone_height(targets[k].w, d2);
    axis = is_inside ? (float3)(0, 0, 1) : v * rsqrt(d2);
    rest -= height;
    if (rest < 0) break;
  }
  const float h = u.x * height, r = sqrt(max(0.0f, h * (2.0f - h))), phi = 2.0f * M_PI_F * u.y;
  return to_world(make_frame(axis), (float3)(r * cos(phi), r * sin(phi), 1.0f - h));
}

// of light paths that leave a lamp of this area at the point in direction `away` [1/(m^2 sr)]; 0: none does
static inline float emission_density(const Launch launch, const Shading scene, const float probability,
                                     const float area, const float3 point, const float cosine, const float3 away) {
  if (!(cosine > 0 && area > 0)) return 0.0f;
  return probability / area * aim_pdf(launch, scene.targets, point, away) / cosine;
}

// at the surface of the true sphere, where a ray that meets the lamp's triangles leaves it; 0: it passes by
static inline float sphere_cosine(global const Light* light, const float3 point, const float3 away) {
  const float3 beside = cross(point - vload3(0, light->corner), away);
  return sqrt(max(0.0f, 1.0f - dot(beside, beside) / (light->radius * light->radius)));
}

// where a ray from a point of the lens is seen; lens, direction: in the camera's frame
static inline bool seen_at(const PinholeCamera c, const float3 lens, const float3 direction, float2* pixel) {
  if (c.lens_radius == 0) return project(c, direction, pixel);
  return direction.z > 0 && project(c, lens + direction * (c.focus_distance / direction.z), pixel);
}

// direction: unit
static inline float pixels_per_steradian(const PinholeCamera c, const float3 lens, const float3 direction) {
  if (c.model == CAMERA_PINHOLE && !c.is_distorted)
    return c.fx * c.fy / (direction.z * direction.z * direction.z);
  const float h = 2e-3f;  // [rad]: exact enough, and pixels differ by far more than they are rounded
  const Frame frame = make_frame(direction);
  float2 right, left, up, down;
  if (!seen_at(c, lens, direction + h * frame.x, &right) || !seen_at(c, lens, direction - h * frame.x, &left) ||
      !seen_at(c, lens, direction + h * frame.y, &up) || !seen_at(c, lens, direction - h * frame.y, &down))
    return 0.0f;
  const float2 a = (right - left) / (2 * h), b = (up - down) / (2 * h);
  return fabs(a.x * b.y - a.y * b.x);
}

// of a direction to or from a surface that scatters
static inline float light_cosine(const Surface s, const float3 direction) {
  return max(1e-6f, fabs(dot(s.face, direction)));
}

// of one sample per pixel, over area of the surface that the camera sees [1/m^2]: weighs only, so that a lens counts as
// its middle
static inline float camera_density(const Launch launch, const Surface s) {
  const float3 seen = in_camera(launch.camera, s.point);
  const float3 eye = (float3)(launch.camera.to_world[3], launch.camera.to_world[7], launch.camera.to_world[11]);
  const float3 to_eye = eye - s.point;
  const float d2 = dot(to_eye, to_eye);
  return pixels_per_steradian(launch.camera, (float3)(0.0f), unit(seen)) * fabs(dot(s.face, to_eye)) / (d2 * sqrt(d2));
}
#endif

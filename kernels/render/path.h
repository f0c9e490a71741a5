// What travels between the stages of the path tracer and what they read: vertices, instances, lights, the camera and
// the launch. Lengths in metres, world frame unless said otherwise.
#ifndef PVG_RENDER_PATH_H
#define PVG_RENDER_PATH_H
#include "shared/types.h"

// who is stopped by an instance
#define MASK_SURFACES 1u   // shadow rays of ordinary surfaces
#define MASK_RECEIVERS 2u  // shadow rays of shadow receivers: inserted objects only
// cut-out instances have these bits shifted: they are not met by shadow rays, but asked in holes.cl
#define MASK_CUTOUT_SHIFT 2u

#define INSTANCE_NORMALS 1u      // the mesh has vertex normals
#define INSTANCE_CLEAR 2u        // clear glass: shadow rays may pass
#define INSTANCE_UNMOVED 4u      // the mesh's frame is the world's
#define INSTANCE_COLORS 8u       // the mesh has vertex colours
#define INSTANCE_CUTOUT 16u      // not everywhere there: the material has MATERIAL_MASK or MATERIAL_BLEND
#define INSTANCE_SHINES 32u      // its triangles are among the lights
#define INSTANCE_SECOND_UVS 64u  // the mesh has second texture coordinates

// path flags
#define PATH_SCATTERED 1u  // has met a surface that scatters (diffuse or rough)
#define PATH_DIFFUSE 2u    // the last such surface was matte (materials/list.cl)
#define PATH_REFRACTED 4u  // has passed through glass since
#define PATH_SEEN 8u       // light tracing covers it so far: the camera sees the first such surface with nothing between

// what a shadow ray is for
#define SHADOW_NONE 0u
#define SHADOW_SURFACE 1u        // blocked by glass
#define SHADOW_SURFACE_GLASS 2u  // attenuated by glass
#define SHADOW_RECEIVER 3u

#define NO_TRIANGLE 0xffffffffu

// on a CPU: rays or paths side by side; those that a work-item of render/lanes/trace.cl and of render/lanes/rays.cl takes
#define PACKET 16
#define TRACE_CHUNK 1024
#define RAYS_CHUNK 128

// shadow rays end just short of the light itself, in units of the way to it
#define BEFORE_LIGHT 0.9999f

SHARED_BEGIN
typedef struct {
  f32 v[4];
} F32x4;
SHARED_SIZE(F32x4, 16);

typedef struct {
  f32 point[3];   // in the mesh's frame [m]
  f32 normal[3];  // unit, or 0
  f32 uv[2];
} Vertex;
SHARED_SIZE(Vertex, 32);

typedef struct {
  f32 to_object[12];  // rows of [A | p]: world to mesh
  f32 to_world[12];   // mesh to world
  u32 root;           // node of its mesh
  u32 material;
  u32 visual;  // 1 + index of the Visual; 0: a light
  u32 mask;    // MASK_...
  i32 light;   // of a light its index; with INSTANCE_SHINES that of triangle t is light + t
  u32 flags;   // INSTANCE_...
  i32 first_color;      // colour of vertex i: first_color + i
  i32 first_second_uv;  // likewise its second texture coordinates
} Instance;
SHARED_SIZE(Instance, 128);

#define LIGHT_RECTANGLE 0u
#define LIGHT_SPHERE 1u
#define LIGHT_TRIANGLE 2u
#define LIGHT_ENVIRONMENT 3u

// one light to be chosen; a rectangle shines on the side of its normal, a sphere outward, a triangle on both sides
typedef struct {
  u32 kind;          // LIGHT_...
  f32 probability;   // of being chosen: its share of the power
  f32 keep;          // alias table: chosen with this probability where its place is drawn,
  u32 other;         // else this one is
  f32 corner[3];     // of a rectangle; centre of a sphere [m]
  f32 area;          // of a rectangle or sphere [m^2]
  f32 edge_u[3];     // of a rectangle; of a sphere the direction of a spot
  u32 instance;      // of a triangle
  f32 edge_v[3];     // of a rectangle; of a sphere: cosine of a spot's outer angle, 1 / (that of the inner one - it)
  u32 triangle;      // index into the triangles of all meshes
  f32 normal[3];     // of a rectangle, unit
  f32 radius;        // of a sphere [m]
  f32 radiance[3];   // of rectangles and spheres [W/(sr m^2)]
  f32 unused;
} Light;
SHARED_SIZE(Light, 96);

// importance of the environment's directions
#define ENVIRONMENT_COLUMNS 256u
#define ENVIRONMENT_ROWS 128u
typedef struct {
  f32 keep;  // alias table, as in Light
  u32 other;
  f32 density;  // over directions [1/sr]
  f32 unused;
} EnvironmentCell;
SHARED_SIZE(EnvironmentCell, 16);

#define CAMERA_PINHOLE 0u
#define CAMERA_FISHEYE 1u

// OpenCV's pinhole or fisheye camera, with a thin lens
typedef struct {
  f32 fx, fy, cx, cy;  // [pixels]
  f32 k[6];            // radial k1 k2 k3, then the denominator's k4 k5 k6; of a fisheye k1 k2 k3 k4
  f32 p[2];            // tangential
  f32 to_world[12];    // rows of [R | origin]
  u32 width, height;   // [pixels]
  u32 is_distorted;
  u32 model;            // CAMERA_...
  f32 lens_radius;      // [m]; 0: everything is sharp
  f32 focus_distance;   // along the optical axis [m]
  u32 unused[2];
} PinholeCamera;
SHARED_SIZE(PinholeCamera, 128);

// one batch: samples first_sample .. of the pixels first_pixel .. of a list
typedef struct {
  PinholeCamera camera;
  u32 first_pixel, n_pixels;
  u32 n_samples;
  u32 key;        // of seed, frame and camera
  u32 is_center;  // 1: one ray through the middle of each pixel
  u32 n_lights;
  u32 max_depth;
  u32 transparent_shadows;  // 1: shadow rays of diffuse surfaces and receivers pass clear glass, attenuated
  f32 receiver_scale;       // 1 / exposure: a receiver's texture is what the camera recorded
  u32 first_sample;         // number of the batch's first sample of each pixel
  u32 media;                // the solids that the camera is inside of, see media.cl
  i32 environment_light;    // its index among the lights, or -1
  f32 environment[3];       // radiance of what no surface covers, or scale of its picture
  f32 environment_turn;     // about z [rad]
  u32 environment_width, environment_height;  // [texels]; 0: the same everywhere
  // light tracing, see light_tracing.cl
  u32 n_light_paths;            // of the picture, 0: none
  f32 light_paths_per_sample;   // n_light_paths / mean number of samples of a pixel
  u32 n_targets;
  u32 unused[3];
} Launch;
SHARED_SIZE(Launch, 224);
SHARED_END
#endif

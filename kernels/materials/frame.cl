// The local frame of a surface: z along the normal, so that the cosine of a direction is its z. Branchless basis of
// Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
#ifndef PVG_MATERIALS_FRAME_CL
#define PVG_MATERIALS_FRAME_CL

typedef struct {
  float3 x, y, z;
} Frame;

static inline Frame make_frame(const float3 n) {
  const float sign = n.z >= 0 ? 1.0f : -1.0f;
  const float a = -1.0f / (sign + n.z), b = n.x * n.y * a;
  Frame frame;
  frame.x = (float3)(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
  frame.y = (float3)(b, sign + n.y * n.y * a, -n.y);
  frame.z = n;
  return frame;
}
static inline float3 to_local(const Frame f, const float3 w) { return (float3)(dot(f.x, w), dot(f.y, w), dot(f.z, w)); }
static inline float3 to_world(const Frame f, const float3 w) { return f.x * w.x + f.y * w.y + f.z * w.z; }

// What a material's sample function gives: a direction in the local frame, the weight f cos / pdf of the path, and the
// density of the direction; pdf = 0 marks a mirror-like direction that no light sample could find. Weight 0: absorbed.
typedef struct {
  float3 direction;
  float3 weight;
  float pdf;  // [1/sr]
} MaterialSample;
#endif

// Pixels in the order of 8 x 8 tiles, so that neighbours in memory are neighbours in the picture.
#ifndef PVG_RENDER_TILES_CL
#define PVG_RENDER_TILES_CL
#define TILE 8u

// a bijection of 0 .. width * height - 1; tiles at the right and lower border are narrower
static inline uint2 tile_pixel(const uint i, const uint width, const uint height) {
  const uint strip = i / (TILE * width), y0 = strip * TILE;
  const uint tile_height = min(TILE, height - y0);
  const uint in_strip = i - y0 * width;
  const uint column = in_strip / (TILE * tile_height), x0 = column * TILE;
  const uint tile_width = min(TILE, width - x0);
  const uint in_tile = in_strip - x0 * tile_height;
  return (uint2)(x0 + in_tile % tile_width, y0 + in_tile / tile_width);
}
#endif

// Letters of 5 x 7 pixels for labels on pictures: capitals, digits and a few signs; small letters show as capitals.
#pragma once
#include <array>
#include <string>

#include "host/formats/picture_files.hpp"

namespace pvg {

using Color8 = std::array<std::uint8_t, 3>;

constexpr int LETTER_WIDTH = 6, LETTER_HEIGHT = 9;  // with the space between [pixels, at size 1]

// Top left corner at (x, y), every pixel of a letter `size` pixels wide; what falls outside the picture is left out.
void draw_text(Picture8& picture, int x, int y, const std::string& text, int size, Color8 color);

// The number of letters that fit a width.
int letters_that_fit(int width, int size);

}  // namespace pvg

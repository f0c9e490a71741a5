// Drawings whose pixels are known by hand: the frame is 610 x 350, its upper left corner at (90, 40).
#include "pipeline/validation/plot.hpp"

#include <gtest/gtest.h>
#include <tinyxml.h>

#include <array>
#include <cstdio>

namespace pvg {
namespace {

double number(const TiXmlElement& element, const char* name) { return std::stod(element.Attribute(name)); }

TEST(Plot, InAPicturePointsAreDownwardAndAsLongAlongBothAxes) {
  Plot plot{"", "", "", "", {{"", {0, 100, 0, 0}, {0, 0, 0, 100}, false, Curve::Form::arrows}}};
  plot.is_picture = true;
  TiXmlDocument drawing;
  drawing.Parse(svg_of(plot).c_str());
  ASSERT_FALSE(drawing.Error()) << drawing.ErrorDesc();
  std::vector<std::array<double, 4>> arrows;
  for (const TiXmlElement* e = drawing.RootElement()->FirstChildElement("path"); e; e = e->NextSiblingElement("path")) {
    std::array<double, 4> a{};
    ASSERT_EQ(std::sscanf(e->Attribute("d"), "M %lf %lf L %lf %lf", &a[0], &a[1], &a[2], &a[3]), 4);
    arrows.push_back(a);
  }
  ASSERT_EQ(arrows.size(), 2u);
  const double length = 350 / 1.1;  // of 100 with margins of 5 on both sides
  EXPECT_NEAR(arrows[0][2] - arrows[0][0], length, 0.02);
  EXPECT_NEAR(arrows[0][3] - arrows[0][1], 0, 0.02);
  EXPECT_NEAR(arrows[1][2] - arrows[1][0], 0, 0.02);
  EXPECT_NEAR(arrows[1][3] - arrows[1][1], length, 0.02);
}

TEST(Plot, BarsStandOnZeroAndPlotsStandBelowEachOther) {
  const Plot plot{"", "", "", "", {{"", {1, 2}, {0.5, 1}, false, Curve::Form::bars}}};
  TiXmlDocument drawing;
  drawing.Parse(svg_of({plot, plot}).c_str());
  ASSERT_FALSE(drawing.Error()) << drawing.ErrorDesc();
  EXPECT_EQ(number(*drawing.RootElement(), "height"), 900);
  int n_plots = 0;
  for (const TiXmlElement* g = drawing.RootElement()->FirstChildElement("g"); g; g = g->NextSiblingElement("g")) {
    ++n_plots;
    std::vector<const TiXmlElement*> bars;
    for (const TiXmlElement* e = g->FirstChildElement("svg")->FirstChildElement("rect"); e;
         e = e->NextSiblingElement("rect"))
      if (e->Attribute("fill")[0] == '#') bars.push_back(e);
    ASSERT_EQ(bars.size(), 2u);
    EXPECT_NEAR(number(*bars[1], "height"), 2 * number(*bars[0], "height"), 0.02);
    EXPECT_NEAR(number(*bars[0], "y") + number(*bars[0], "height"), number(*bars[1], "y") + number(*bars[1], "height"),
                0.02);
  }
  EXPECT_EQ(n_plots, 2);
}

}  // namespace
}  // namespace pvg

// docs/reference says what the tables of fields say.
#include "host/load/reference.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace pvg {
namespace {

TEST(Reference, ThePagesInTheTreeAreThoseOfTheTables) {
  for (const ReferencePage& page : reference_pages()) {
    std::ifstream in(std::string(PVG_DATA_FOLDER) + "/../docs/reference/" + page.file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    EXPECT_TRUE(text == page.text) << "docs/reference/" << page.file
                                   << " is out of date: run pvg_reference docs/reference";
  }
}

TEST(Reference, ARowHasKeyUnitDefaultBoundsAndMeaning) {
  const std::string scene = reference_pages().at(0).text, gripper = reference_pages().at(2).text;
  EXPECT_NE(scene.find("| `activation_distance` | m | 0.001 | 1e-06 to 0.1 | contact acts below this gap"),
            std::string::npos);
  EXPECT_NE(gripper.find("| `fingers[].material.youngs_modulus` | Pa | required |"), std::string::npos);
}

}  // namespace
}  // namespace pvg

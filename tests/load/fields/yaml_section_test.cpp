// What a file may say: units, ranges, types; every mistake is named with file, line and key.
#include "host/load/fields/yaml_section.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

#include "host/base/error.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

struct YamlSectionTest : testing::Test {
  TestFolder folder;
  YamlSection load(const std::string& text) { return YamlSection::load(folder.write("a.yaml", text), "scene file"); }
  void expect_refused(const std::string& text, const std::function<void(YamlSection&)>& read,
                      std::initializer_list<const char*> words) {
    expect_error<UsageError>(
        [&] {
          YamlSection section = load(text);
          read(section);
          section.done();
        },
        words);
  }
};

TEST(Quantity, BareNumbersAreInSiAndUnitsAreConverted) {
  EXPECT_EQ(parse_quantity("1.5", Unit::length), 1.5);
  EXPECT_DOUBLE_EQ(parse_quantity("1.5 mm", Unit::length), 1.5e-3);
  EXPECT_DOUBLE_EQ(parse_quantity("-2cm", Unit::length), -0.02);
  EXPECT_DOUBLE_EQ(parse_quantity("180 deg", Unit::angle), M_PI);
  EXPECT_DOUBLE_EQ(parse_quantity("20 MPa", Unit::pressure), 2e7);
  EXPECT_DOUBLE_EQ(parse_quantity("500 g", Unit::mass), 0.5);
  EXPECT_DOUBLE_EQ(parse_quantity("2.23 g/cm^3", Unit::density), 2230);
  EXPECT_DOUBLE_EQ(parse_quantity("1e5 N m/rad", Unit::angular_stiffness), 1e5);
  EXPECT_EQ(parse_quantity("+010", Unit::none), 10);  // decimal, never octal
}

TEST(Quantity, WrongUnitsAndWordsAreRefused) {
  for (const char* wrong :
       {"1.5 kg", "1.5 deg", "1.5 Mm", "3 mm mm", "0x10", "1,5", "abc", "", ".nan", "nan", "inf", "1e999"}) {
    EXPECT_THROW(parse_quantity(wrong, Unit::length), std::invalid_argument) << wrong;
  }
  EXPECT_THROW(parse_quantity("3 mm", Unit::none), std::invalid_argument);
}

TEST_F(YamlSectionTest, BareNumbersAreThoseOfTheFileWithoutAUnit) {
  const std::string text = "a: 90\nb: [-90, 90 deg, 1e2]\nc: 90 deg\nd: word\n";
  const YamlSection s = load(text);
  EXPECT_EQ(s.bare_numbers("a"), std::vector<double>({90}));
  EXPECT_EQ(s.bare_numbers("b"), std::vector<double>({-90, 100}));
  for (const char* key : {"c", "d", "z"}) EXPECT_TRUE(s.bare_numbers(key).empty()) << key;
  EXPECT_TRUE(s.place_of("b").ends_with("a.yaml:2: `b`")) << s.place_of("b");
  EXPECT_TRUE(YamlSection::translated(text, s.path()).bare_numbers("a").empty());
  EXPECT_TRUE(YamlSection::resolved(text, s.path()).bare_numbers("a").empty());
}

TEST_F(YamlSectionTest, ReadsWhatIsThereAndDefaultsWhatIsNot) {
  YamlSection s = load("a: 3 mm\nb: [1, 2 mm, 3]\nc: {d: true}\ne: [{f: 1}, {f: 2}]\ng: word\nh: [1, 4]\n");
  EXPECT_DOUBLE_EQ(s.number("a", Unit::length, 0, 1), 0.003);
  EXPECT_EQ(s.number("z", Unit::length, 0, 1, 0.25), 0.25);
  EXPECT_EQ(s.vector("b", Unit::length, 0, 10), Vec3(1, 0.002, 3));
  EXPECT_TRUE(s.section("c").boolean("d", false));
  EXPECT_EQ(s.sections("e").at(1).integer("f", 0, 9), 2);
  EXPECT_EQ(s.choice("g", {"other", "word"}), 1u);
  EXPECT_EQ(s.range("h", Unit::none, 0, 9, 0).high, 4);
  EXPECT_EQ(s.range("a", Unit::length, 0, 9, 0).low, 0.003);
  s.done();
}

TEST_F(YamlSectionTest, UnknownKeyIsNamedWithLineAndWhatIsAllowed) {
  expect_refused("mass: 1\nmas: 2\n",
                 [](auto& s) { s.number("mass", Unit::mass, 0, 9), s.number("drag", Unit::none, 0, 1, 0); },
                 {"a.yaml:2", "`mas`", "unknown", "drag, mass"});
}

TEST_F(YamlSectionTest, MissingKeyIsNamedWithItsUnit) {
  expect_refused("part:\n  a: 1\n", [](auto& s) { s.section("part").number("mass", Unit::mass, 0, 9); },
                 {"a.yaml:2", "`part.mass`", "[kg]", "missing"});
}

TEST_F(YamlSectionTest, DoubledKeyIsNamed) {
  expect_refused("mass: 1\nmass: 2\n", [](auto&) {}, {"a.yaml:2", "`mass`", "second time"});
}

TEST_F(YamlSectionTest, WrongUnitNamesTheRightOnes) {
  expect_refused("length: 3 kg\n", [](auto& s) { s.number("length", Unit::length, 0, 9); },
                 {"a.yaml:1", "`length`", "`kg`", "m, cm, mm, um"});
}

TEST_F(YamlSectionTest, WrongSignAndRangeNameTheLimits) {
  expect_refused("mass: -1 kg\n", [](auto& s) { s.number("mass", Unit::mass, 0, INFINITY); },
                 {"`mass`", "at least 0 [kg]", "-1"});
  expect_refused("n: 12\n", [](auto& s) { s.integer("n", 1, 10); }, {"`n`", "between 1 and 10", "12"});
  expect_refused("n: 1.5\n", [](auto& s) { s.integer("n", 1, 10); }, {"`n`", "whole number"});
  expect_refused("r: [3, 1]\n", [](auto& s) { s.range("r", Unit::none, 0, 9, 0); }, {"`r`", "low <= high"});
}

TEST_F(YamlSectionTest, WrongTypesAreNamed) {
  expect_refused("a: [1, 2]\n", [](auto& s) { s.number("a", Unit::none, 0, 9); },
                 {"a.yaml:1", "`a`", "must be a number"});
  expect_refused("a: .nan\n", [](auto& s) { s.number("a", Unit::none, 0, 9); }, {"`a`", "must be a number", ".nan"});
  expect_refused("a: yes\n", [](auto& s) { s.boolean("a", true); }, {"`a`", "true or false"});
  expect_refused("a: [1, 2]\n", [](auto& s) { s.vector("a", Unit::none, 0, 9); }, {"`a`", "three numbers", "2"});
  expect_refused("a: 1\n", [](auto& s) { s.section("a"); }, {"`a`", "must be a mapping"});
  expect_refused("a: 1\n", [](auto& s) { s.sections("a"); }, {"`a`", "list of mappings"});
  expect_refused("a: blue\n", [](auto& s) { s.choice("a", {"red", "green"}); }, {"`a`", "blue", "red, green"});
}

TEST_F(YamlSectionTest, MissingFilesAndBrokenYamlAreNamed) {
  expect_error<UsageError>([] { YamlSection::load("/nowhere/task.yaml", "task file"); },
                           {"/nowhere/task.yaml", "no such task file"});
  expect_refused("mesh: cup.obj\n", [](auto& s) { s.file("mesh"); },
                 {"a.yaml:1", "`mesh`", "cup.obj", "does not exist"});
  expect_refused("a: [1, 2\nb: 3\n", [](auto&) {}, {"a.yaml:", "not YAML"});
  expect_refused("a: b: 1\n", [](auto&) {},
                 {"a.yaml:1: ", "not YAML", "a colon stands where none may", "illegal map value"});
  expect_refused("a: 1\n b: 2\n", [](auto&) {}, {"a.yaml:2: ", "same column"});
  expect_refused("a: 1\n  b\nc: 2\n d: 3\n", [](auto&) {}, {"a.yaml:4: ", "same column"});
  expect_refused("a: {b: 1\nc: 2\n", [](auto&) {}, {"a.yaml:", "a brace { is not closed"});
  expect_refused("a: [1, 2\nb: 3\n", [](auto&) {}, {"a.yaml:", "a bracket [ is not closed"});
  expect_refused("a: 'one\n---\n", [](auto&) {}, {"a.yaml:", "a quote is opened and not closed"});
  expect_refused("a:\n\t- 1\n", [](auto&) {}, {"a.yaml:2", "indented by a tab"});
  expect_refused("a: *b\n", [](auto&) {}, {"a.yaml:1", "an alias (*name) stands before its anchor"});
  expect_refused("a: ]\n", [](auto&) {}, {"a.yaml:1", "closes nothing that is open"});
  expect_refused("a: @b\n", [](auto&) {}, {"a.yaml:1", "put the value in quotes"});
  expect_refused("a: \"\\q\"\n", [](auto&) {}, {"a.yaml:1", "a backslash in double quotes"});
  expect_refused("- 1\n- 2\n", [](auto&) {}, {"must be a mapping"});
}

}  // namespace
}  // namespace pvg

// The text of XML files
#include "host/robot/xml_text.hpp"

#include <gtest/gtest.h>
#include <tinyxml.h>

namespace pvg {
namespace {

// The last byte begins a character of four bytes. Without more zeros than one TinyXML reads what lies behind the text.
TEST(XmlText, AFileThatEndsWithinACharacterIsReadToItsEndOnly) {
  const std::string text = "<robot name=\"a\">\xF0";
  const std::string with_end = xml_with_end(text);
  EXPECT_EQ(with_end.find('\0'), text.size());
  EXPECT_GE(with_end.size() + 1, text.size() + 4);  // c_str() has a zero of its own
  TiXmlDocument document;
  document.Parse(with_end.c_str());
  EXPECT_TRUE(document.Error());
}

}  // namespace
}  // namespace pvg

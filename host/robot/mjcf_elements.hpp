// Elements of an MJCF file with the attributes that <default> classes give them. Internal to the reader of MJCF.
#pragma once
#include <tinyxml.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/model/physical_scene.hpp"

namespace pvg::mjcf {

// The file with its <include>s in place. Files are relative to the folder of the outermost one.
class Document {
 public:
  explicit Document(const std::filesystem::path& file);
  const TiXmlElement& root() const { return *document_.RootElement(); }

 private:
  void include(TiXmlElement& element, const std::filesystem::path& file, int depth);
  TiXmlDocument document_;
};

// What a class of <default> holds, those it inherits from first.
using Defaults = std::map<std::string, std::vector<const TiXmlElement*>>;
Defaults read_defaults(const TiXmlElement& root, const std::string& file);

class Element {
 public:
  // inherited: elements of the same kind in its class, the strongest last
  Element(const TiXmlElement& own, std::vector<const TiXmlElement*> inherited, const std::string& file);

  const TiXmlElement& xml() const { return *own_; }
  std::string place() const;  // "arm.xml:12: joint `elbow`"
  bool has(const char* key) const { return find(key) != nullptr; }
  std::string text(const char* key, const std::string& otherwise = "") const;
  bool flag(const char* key, bool otherwise) const;  // true or false
  double number(const char* key, double otherwise) const;
  // at least `fewest` and at most as many as `otherwise`, whose last ones stay where fewer are given
  std::vector<double> numbers(const char* key, std::vector<double> otherwise, std::size_t fewest) const;
  Vec3 vector(const char* key, const Vec3& otherwise) const;

  [[noreturn]] void fail(const std::string& sentence) const;
  // what is not supported: fails if the attribute is there and not all zero
  void refuse_nonzero(std::initializer_list<const char*> keys) const;
  void refuse(std::initializer_list<const char*> keys) const;  // if the attribute is there

 private:
  const char* find(const char* key) const;
  const TiXmlElement* own_;
  std::vector<const TiXmlElement*> inherited_;
  std::string file_;
};

}  // namespace pvg::mjcf

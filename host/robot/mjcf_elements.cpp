#include "host/robot/mjcf_elements.hpp"

#include <charconv>
#include <cmath>

#include "host/base/error.hpp"
#include "host/base/files.hpp"
#include "host/base/outputs.hpp"
#include "host/robot/xml_text.hpp"

namespace pvg::mjcf {
namespace {

namespace fs = std::filesystem;
constexpr int DEEPEST_INCLUDE = 20;

void parse(TiXmlDocument& document, const fs::path& file) {
  const std::optional<std::string> text = read_whole_file(file);
  if (!text) throw UsageError(file.string() + " does not exist or cannot be read; correct the path");
  remember_read(file);
  check_xml_depth(*text, file.string());
  document.Parse(xml_with_end(*text).c_str());
  if (document.Error())
    throw UsageError(file.string() + ":" + std::to_string(document.ErrorRow()) + ": this is no valid XML (" +
                     document.ErrorDesc() + "); correct it");
  if (!document.RootElement() || document.RootElement()->ValueStr() != "mujoco")
    throw UsageError(file.string() + " has no <mujoco>; give an MJCF file");
}

void collect(const TiXmlElement& element, const std::string& parent, Defaults& classes, const std::string& file) {
  const char* given = element.Attribute("class");
  if (!given && !parent.empty())
    throw UsageError(file + ":" + std::to_string(element.Row()) + ": <default> has no class; name it");
  const std::string name = given ? given : "main";
  std::vector<const TiXmlElement*> chain;
  if (!parent.empty()) chain = classes[parent];
  for (const TiXmlElement* e = element.FirstChildElement(); e; e = e->NextSiblingElement())
    if (e->ValueStr() != "default") chain.push_back(e);
  if (parent.empty()) classes[""] = chain;
  classes[name] = chain;
  for (const TiXmlElement* e = element.FirstChildElement("default"); e; e = e->NextSiblingElement("default"))
    collect(*e, name, classes, file);
}

}  // namespace

Document::Document(const fs::path& file) {
  parse(document_, file);
  include(*document_.RootElement(), file, 0);
}

void Document::include(TiXmlElement& element, const fs::path& file, int depth) {
  for (TiXmlElement* e = element.FirstChildElement(); e;) {
    if (e->ValueStr() != "include") {
      include(*e, file, depth);
      e = e->NextSiblingElement();
      continue;
    }
    const std::string place = file.string() + ":" + std::to_string(e->Row());
    const char* name = e->Attribute("file");
    if (!name) throw UsageError(place + ": <include> lacks the attribute file; add it");
    if (depth >= DEEPEST_INCLUDE) throw UsageError(place + ": files include each other in a circle; cut it");
    TiXmlDocument included;
    parse(included, file.parent_path() / name);
    include(*included.RootElement(), file, depth + 1);
    TiXmlElement* before = e;
    for (const TiXmlElement* child = included.RootElement()->FirstChildElement(); child;
         child = child->NextSiblingElement())
      element.InsertBeforeChild(before, *child);
    e = e->NextSiblingElement();
    element.RemoveChild(before);
  }
}

Defaults read_defaults(const TiXmlElement& root, const std::string& file) {
  Defaults classes;
  classes[""] = {};
  for (const TiXmlElement* e = root.FirstChildElement("default"); e; e = e->NextSiblingElement("default"))
    collect(*e, "", classes, file);
  return classes;
}

Element::Element(const TiXmlElement& own, std::vector<const TiXmlElement*> inherited, const std::string& file)
    : own_(&own), inherited_(std::move(inherited)), file_(file) {}

const char* Element::find(const char* key) const {
  if (const char* own = own_->Attribute(key)) return own;
  for (auto e = inherited_.rbegin(); e != inherited_.rend(); ++e)
    if (const char* inherited = (*e)->Attribute(key)) return inherited;
  return nullptr;
}

std::string Element::place() const {
  const char* name = own_->Attribute("name");
  return file_ + ":" + std::to_string(own_->Row()) + ": <" + own_->ValueStr() + ">" +
         (name ? " `" + std::string(name) + "`" : "");
}

void Element::fail(const std::string& sentence) const { throw UsageError(place() + " " + sentence); }

std::string Element::text(const char* key, const std::string& otherwise) const {
  const char* found = find(key);
  return found ? found : otherwise;
}

bool Element::flag(const char* key, bool otherwise) const {
  const std::string said = text(key, otherwise ? "true" : "false");
  if (said != "true" && said != "false") fail("has " + std::string(key) + "=\"" + said + "\"; write true or false");
  return said == "true";
}

std::vector<double> Element::numbers(const char* key, std::vector<double> otherwise, std::size_t fewest) const {
  const char* found = find(key);
  if (!found) return otherwise;
  const std::string text = found;
  std::size_t count = 0;
  for (const char *at = text.data(), *end = at + text.size();;) {
    while (at != end && (std::isspace(static_cast<unsigned char>(*at)) || *at == '+')) ++at;
    if (at == end) break;
    double value = 0;
    const auto [after, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value) || count == otherwise.size()) count = otherwise.size() + 1;
    if (count > otherwise.size()) break;
    otherwise[count++] = value;
    at = after;
  }
  if (count < fewest || count > otherwise.size()) {
    const std::string most = std::to_string(otherwise.size());
    fail("has " + std::string(key) + "=\"" + text.substr(0, 80) + "\"; give " +
         (fewest == otherwise.size() ? most : std::to_string(fewest) + " to " + most) + " finite numbers");
  }
  return otherwise;
}

double Element::number(const char* key, double otherwise) const { return numbers(key, {otherwise}, 1)[0]; }

Vec3 Element::vector(const char* key, const Vec3& otherwise) const {
  const std::vector<double> v = numbers(key, {otherwise[0], otherwise[1], otherwise[2]}, 3);
  return {v[0], v[1], v[2]};
}

void Element::refuse_nonzero(std::initializer_list<const char*> keys) const {
  for (const char* key : keys)
    for (const double value : numbers(key, std::vector<double>(16, 0.0), 0))
      if (value != 0) fail("has " + std::string(key) + ", which is not supported; take it out");
}

void Element::refuse(std::initializer_list<const char*> keys) const {
  for (const char* key : keys)
    if (has(key)) fail("has " + std::string(key) + ", which is not supported; take it out");
}

}  // namespace pvg::mjcf

// A mapping with one key, which names the form of what stands under it, such as the shape of a body. Each form has a
// table of fields and a function that makes the value of it; from them come the reader and the rows of the reference
// page.
//
//   static const OneOf<TriangleMesh> SHAPES =
//       OneOf<TriangleMesh>().form("ball", BALL_FIELDS, [](const Ball& b) { return ball_surface(b); }, "a ball")
#pragma once
#include <utility>

#include "host/load/fields/fields.hpp"

namespace pvg {

template <class Made>
class OneOf {
 public:
  template <class Form, class Make>
  OneOf& form(const std::string& name, const Fields<Form>& fields, Make make, const std::string& meaning) {
    const auto read = [=](YamlSection& section) {
      YamlSection inner = section.section(name);
      Form form;
      fields.read(inner, form);
      inner.done();
      return make(form);
    };
    rows_.push_back({{name, "", "", "mapping", meaning}, fields.texts(name + "."), read});
    return *this;
  }

  // a list of such mappings, at least one
  template <class Form, class Make>
  OneOf& list(const std::string& name, const Fields<Form>& fields, Make make, const std::string& meaning) {
    const auto read = [=](YamlSection& section) {
      std::vector<Form> forms;
      for (YamlSection& inner : section.sections(name)) {
        fields.read(inner, forms.emplace_back());
        inner.done();
      }
      if (forms.empty()) section.fail(name, "must hold at least one entry");
      return make(forms);
    };
    rows_.push_back({{name, "", "", "list", meaning}, fields.texts(name + "[]."), read});
    return *this;
  }

  // the value is read from a file
  template <class Make>
  OneOf& file(const std::string& name, Make make, const std::string& meaning) {
    const auto read = [=](YamlSection& section) { return make(section.file(name)); };
    rows_.push_back({{name, "", "", "file", meaning}, {}, read});
    return *this;
  }

  // Throws a UsageError where the section holds no form, two, or anything else.
  Made read(YamlSection section) const {
    std::string names;
    for (const Row& row : rows_) {
      names += (names.empty() ? "" : ", ") + row.text.key;
      if (!section.has(row.text.key)) continue;
      Made made = row.read(section);
      section.done();
      return made;
    }
    section.done();
    section.fail("", "must hold one of: " + names);
  }

  std::vector<FieldText> texts(const std::string& prefix) const {
    std::vector<FieldText> all;
    for (const Row& row : rows_) {
      all.push_back(row.text);
      all.insert(all.end(), row.inner.begin(), row.inner.end());
    }
    for (FieldText& text : all) text.key = prefix + text.key;
    return all;
  }

 private:
  struct Row {
    FieldText text;
    std::vector<FieldText> inner;
    std::function<Made(YamlSection&)> read;
  };
  std::vector<Row> rows_;
};

}  // namespace pvg

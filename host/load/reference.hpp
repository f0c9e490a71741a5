// The pages of docs/reference that follow from the tables of fields.
#pragma once
#include <string>
#include <vector>

namespace pvg {

struct ReferencePage {
  std::string file;  // scene.md
  std::string text;  // Markdown
};

std::vector<ReferencePage> reference_pages();

}  // namespace pvg

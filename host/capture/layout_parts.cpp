// What several layouts need.
#include <cmath>
#include <sstream>

#include "host/base/error.hpp"
#include "host/base/files.hpp"
#include "host/capture/layouts.hpp"

namespace pvg {

std::vector<double> numbers_in(const std::filesystem::path& file) {
  const auto content = read_whole_file(file);
  if (!content) throw UsageError(file.string() + " cannot be read");
  std::vector<double> numbers;
  std::istringstream lines(*content);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    for (std::string word; words >> word;) {
      char* end = nullptr;
      numbers.push_back(std::strtod(word.c_str(), &end));
      if (end == word.c_str() || *end != 0)
        throw UsageError(file.string() + ": `" + word.substr(0, 40) + "` is no number");
    }
  }
  return numbers;
}

void set_size_of(const std::filesystem::path& picture, Camera& camera) {
  const PictureSize size = picture_size(picture);
  camera.width = size.width;
  camera.height = size.height;
}

}  // namespace pvg

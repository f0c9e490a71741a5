// The contact sheet: pictures evenly over the episode, one row per camera, each column with its time and what the robot
// is doing; what does not fit beside each other goes on below. What a person looks at first.
#pragma once
#include <string>
#include <vector>

#include "host/formats/picture_files.hpp"

namespace pvg {

struct ContactSheet {
  std::string title;
  std::vector<std::string> rows;                // camera names
  std::vector<std::string> columns;             // what stands above each column, such as "1.20 S  LIFT"
  std::vector<std::vector<Picture8>> pictures;  // [n_rows][n_columns], of one size per row
  std::size_t columns_beside = 4;               // then the next band begins
};

// Which of n frames the sheet shows: at most n_columns, evenly from the first to the last.
std::vector<std::size_t> evenly_spread(std::size_t n, std::size_t n_columns);

Picture8 lay_out(const ContactSheet& sheet);

}  // namespace pvg

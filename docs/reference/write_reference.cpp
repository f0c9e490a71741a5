// pvg_reference FOLDER: writes the generated pages of docs/reference.
#include <filesystem>
#include <fstream>
#include <iostream>

#include "host/load/reference.hpp"

int main(int n_arguments, char** arguments) {
  if (n_arguments != 2) {
    std::cerr << "usage: pvg_reference FOLDER   (docs/reference)\n";
    return 2;
  }
  for (const pvg::ReferencePage& page : pvg::reference_pages()) {
    std::ofstream out(std::filesystem::path(arguments[1]) / page.file, std::ios::binary);
    if (!(out << page.text)) {
      std::cerr << "pvg_reference: cannot write " << page.file << " in " << arguments[1] << "\n";
      return 1;
    }
  }
}

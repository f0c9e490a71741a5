// recording.yaml and its tables by structure: sound lines of which the input takes some out, changes values, and spoils
// cells of the run.
#include "host/load/recording/recording.hpp"

#include <string>
#include <vector>

#include "tests/fuzz/choices.hpp"
#include "tests/fuzz/input_file.hpp"

namespace pvg {
namespace {

std::string number(Choices& choices) {
  static const std::vector<std::string> NUMBERS = {"0.5", "1",  "-1",  "nan", "inf",   "1e999", "",   "abc",
                                                   "0x1", "1,", "1;2", "~",   "0.001", "-0",    " 3", "\xef\xbb\xbf"};
  return NUMBERS[choices.below(NUMBERS.size())];
}

std::string run_table(Choices& choices) {
  std::string text = choices.spoils() ? choices.text() + ",q\n" : "t,q\n";
  for (int row = 0; row < 12; ++row) {
    const std::string t = choices.spoils() ? number(choices) : std::to_string(0.1 * row);
    const std::string q = choices.spoils() ? number(choices) : std::to_string(0.01 * row);
    text += t + "," + q + (choices.spoils() ? "," + number(choices) : "") + "\n";
  }
  return text;
}

std::string recording(Choices& choices) {
  const auto value = [&](const std::string& right) { return choices.spoils() ? choices.text() : right; };
  const auto key = [&](const std::string& name, const std::string& right) {
    if (choices.spoils()) return std::string();
    return (choices.spoils() ? "x" + name : name) + ": " + value(right) + ", ";
  };
  std::string text = "schema: " + value("1") + "\nscene: " + value("solid.obj") + "\nruns:\n";
  const std::size_t n_runs = 1 + choices.below(3);
  for (std::size_t run = 0; run < n_runs; ++run)
    text +=
        "  - {" + key("file", "run_" + std::to_string(run) + ".csv") + key("role", run ? "held_out" : "fit") + "}\n";
  if (choices.spoils()) text += "inputs: [{column: q, target: " + value("joint/hinge/position") + "}]\n";
  text += "channels:\n";
  const std::size_t n_channels = 1 + choices.below(3);
  for (std::size_t channel = 0; channel < n_channels; ++channel) {
    static const std::vector<std::string> KINDS = {"position", "rate", "torque", "orientation", "marker", "force"};
    text += "  - {" + key("column", "q") + key("kind", KINDS[choices.below(KINDS.size())]) + key("joint", "hinge") +
            key("unit", "rad") + key("noise", number(choices));
    if (choices.spoils()) text += key("columns", "[q, q, q]");
    if (choices.spoils()) text += key("point", "[0, 0, .nan]");
    if (choices.spoils()) text += key("vertex", number(choices));
    if (choices.spoils()) text += key("axis", "[0, 0, 0]");
    text += "}\n";
  }
  text +=
      "initial: " +
      (choices.spoils() ? "{" + value("joint/hinge/position") + ": " + number(choices) + "}" : value("first_sample")) +
      "\n";
  return text;
}

void write_text(const std::string& name, const std::string& text) {
  input_file(name, reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

}  // namespace
}  // namespace pvg

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pvg;
  Choices choices(data, size);
  for (int run = 0; run < 3; ++run) write_text("run_" + std::to_string(run) + ".csv", run_table(choices));
  const std::string text = recording(choices);
  const std::filesystem::path file =
      input_file("recording.yaml", reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  may_refuse([&] { load_recording(file); });
  return 0;
}

// Runs a fuzz program on random bytes where libFuzzer is not there. Argument: seconds. What is told at the end is how
// often; an input that breaks the program lies in the file `broken`.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 60;
  const auto start = std::chrono::steady_clock::now();
  std::mt19937 random(1);
  unsigned long long n = 0;
  for (; std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < seconds; ++n) {
    std::vector<std::uint8_t> bytes(random() % 400);
    for (std::uint8_t& byte : bytes) byte = std::uint8_t(random());
    std::ofstream("broken", std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  std::remove("broken");
  std::printf("%llu inputs in %.0f s, nothing broke\n", n, seconds);
}

// A law as text, such as "c0 * sin(3 * q) + c1 * v * fabs(v)", read and printed again as an expression of OpenCL C.
//   sum     = product {(+|-) product}
//   product = factor {(*|/) factor}
//   factor  = (+|-) factor | number | variable | coefficient | function(sum {, sum}) | ( sum )
// Only what was understood is printed, so that nothing else can reach a kernel. Every number is printed as a double. A
// product that begins with a coefficient of 0 is 0, whatever its other factors are.
#pragma once
#include <cstddef>
#include <span>
#include <string>

namespace pvg {

constexpr std::size_t MOST_COEFFICIENTS = 32;  // c0 to c31

struct Formula {
  std::string kernel_text;         // coefficients are c[0], c[1], ...; the same for texts that differ in spaces alone
  std::size_t n_coefficients = 0;  // that it needs: one more than the largest number among them
};

// Throws a UsageError whose sentence begins with the place of the mistake, and ends with what may be used.
Formula parse_formula(const std::string& text, std::span<const std::string> variables);

}  // namespace pvg

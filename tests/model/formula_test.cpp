// Formulas of laws: what is understood, how it is printed, and what is refused with its place.
#include "host/model/formula.hpp"

#include <gtest/gtest.h>

#include "host/base/error.hpp"

namespace pvg {
namespace {

const std::vector<std::string> JOINT = {"q", "v"};

std::string printed(const std::string& text) { return parse_formula(text, JOINT).kernel_text; }

std::string refusal(const std::string& text) {
  try {
    return "accepted as " + printed(text);
  } catch (const UsageError& error) {
    return error.what();
  }
}

TEST(Formula, PrintsEveryNumberAsADouble) {
  EXPECT_EQ(printed("1/2"), "(1.0 / 2.0)");
  EXPECT_EQ(printed("3"), "3.0");
  EXPECT_EQ(printed(".5"), "0.5");
  EXPECT_EQ(printed("2.e-3"), "0.002");
  EXPECT_EQ(printed("1E300"), "1.0000000000000001e+300");
  EXPECT_EQ(printed("0.1"), "0.10000000000000001");
  EXPECT_EQ(printed("123456789012345678"), "1.2345678901234568e+17");
}

TEST(Formula, KeepsTheOrderOfOperations) {
  EXPECT_EQ(printed("q + v * 2"), "(q + (v * 2.0))");
  EXPECT_EQ(printed("(q + v) * 2"), "((q + v) * 2.0)");
  EXPECT_EQ(printed("q - v - 1"), "(q - v - 1.0)");
  EXPECT_EQ(printed("q - (v - 1)"), "(q - (v - 1.0))");
  EXPECT_EQ(printed("q / v / 2"), "(q / v / 2.0)");
  EXPECT_EQ(printed("-q * v"), "((-q) * v)");
  EXPECT_EQ(printed("q - -v"), "(q - (-v))");
  EXPECT_EQ(printed("--q"), "(-(-q))");
  EXPECT_EQ(printed("+q"), "q");
}

TEST(Formula, KnowsVariablesCoefficientsAndFunctions) {
  const Formula law = parse_formula("c0 * sin(3 * q) + c12*v * fabs(v)", JOINT);
  EXPECT_EQ(law.kernel_text,
            "((c[0] == 0 ? 0.0 : (c[0] * sin((3.0 * q)))) + (c[12] == 0 ? 0.0 : (c[12] * v * fabs(v))))");
  EXPECT_EQ(law.n_coefficients, 13u);
  EXPECT_EQ(parse_formula("1", JOINT).n_coefficients, 0u);
  EXPECT_EQ(printed("pow(q, 2)"), "pow(q, 2.0)");
  for (const std::string function : {"sin", "cos", "tan", "exp", "log", "sqrt", "fabs", "tanh", "sign"})
    EXPECT_EQ(printed(function + "(v)"), function + "(v)");
  for (const std::string function : {"pow", "fmin", "fmax"})
    EXPECT_EQ(printed(function + "(q,c31)"), function + "(q, c[31])");
  const std::vector<std::string> body = {"x", "y", "z", "vx", "vy", "vz"};
  EXPECT_EQ(parse_formula("x*vz", body).kernel_text, "(x * vz)");
}

TEST(Formula, SpacesDoNotMakeAnotherLaw) { EXPECT_EQ(printed(" c0*q\t+ v \n"), printed("c0 * q + v")); }

TEST(Formula, RefusesWhatItDoesNotKnowWithItsPlace) {
  const auto expect_refused = [](const std::string& text, const std::string& what) {
    EXPECT_EQ(refusal(text).find(what), 0u) << text << ": " << refusal(text);
    EXPECT_NE(refusal(text).find("; it may hold numbers, q, v, c0 to c31, + - * / ( ) and sin cos"), std::string::npos);
  };
  expect_refused("", "at character 1, the end stands where a number");
  expect_refused("q +", "at character 4, the end stands where a number");
  expect_refused("q + * v", "at character 5, `*` stands where a number");
  expect_refused("q v", "at character 3, `v` stands where an operator or the end should");
  expect_refused("q)", "at character 2, `)` stands where an operator");
  expect_refused("(q", "at character 3, the end stands where ) should");
  expect_refused("x", "at character 1, `x` is not known");
  expect_refused("c32", "at character 1, `c32` is not known");
  expect_refused("c01", "at character 1, `c01` is not known");
  expect_refused("cosh(q)", "at character 1, `cosh` is not known");
  expect_refused("1 + sin q", "at character 9, `q` stands where ( should");
  expect_refused("sin()", "at character 5, `)` stands where a number");
  expect_refused("pow(q)", "at character 6, `)` stands where , should");
  expect_refused("sin(q, v)", "at character 6, `,` stands where ) should");
  expect_refused("q ^ 2", "at character 3, `^` stands where an operator");
  expect_refused("0x10", "at character 2, `x10` stands where an operator");
  expect_refused("1.5f", "at character 4, `f` stands where an operator");
  expect_refused("1.2.3", "at character 4, `.` stands where an operator");
  expect_refused(".", "at character 1, there is no number");
  expect_refused("1e999", "at character 1, there is no number that a double can hold");
  expect_refused("nan", "at character 1, `nan` is not known");
  expect_refused("q; } kernel void f() {", "at character 2, `;` stands where an operator");
  expect_refused("q /* v */", "at character 4, `*` stands where a number");
  expect_refused("q // v", "at character 4, `/` stands where a number");
  expect_refused("\"q\"", "at character 1, `\"` stands where a number");
  expect_refused("q\\\n", "at character 2, `\\` stands where an operator");
  expect_refused("π", "at character 1, `π` is not known");
  expect_refused(std::string("q\0v", 3), "at character 2, something unprintable stands");
}

TEST(Formula, RefusesWhatACompilerWouldNotTake) {
  const auto nested = [](std::size_t n) { return std::string(n, '(') + "q" + std::string(n, ')'); };
  EXPECT_EQ(printed(nested(30)), "q");
  EXPECT_NE(refusal(nested(31)).find("nested more than 30 levels deep"), std::string::npos);
  EXPECT_NE(refusal(std::string(40, '-') + "q").find("nested more than"), std::string::npos);
  std::string longest = "q";
  while (longest.size() + 2 <= 2000) longest += "+q";
  EXPECT_EQ(printed(longest).find("accepted"), std::string::npos);
  EXPECT_NE(refusal(longest + "+q").find("longer than 2000 characters"), std::string::npos);
}

}  // namespace
}  // namespace pvg

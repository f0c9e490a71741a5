#include "host/model/formula.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr std::size_t LONGEST = 2000;  // characters
constexpr int DEEPEST = 30;            // levels, each up to four brackets as printed: compilers allow 256

struct Function {
  const char* name;
  int n_arguments;
};
constexpr Function FUNCTIONS[] = {{"sin", 1},  {"cos", 1},  {"tan", 1},  {"exp", 1}, {"log", 1},  {"sqrt", 1},
                                  {"fabs", 1}, {"tanh", 1}, {"sign", 1}, {"pow", 2}, {"fmin", 2}, {"fmax", 2}};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_of_name(char c) {  // bytes of what is no ASCII are shown together
  return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || static_cast<signed char>(c) < 0;
}

std::string printed(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", number);
  return std::string(text).find_first_of(".e") == std::string::npos ? std::string(text) + ".0" : text;
}

class Parser {
 public:
  Parser(const std::string& text, std::span<const std::string> variables) : text_(text), variables_(variables) {}

  Formula formula() {
    if (text_.size() > LONGEST) fail("it is longer than " + std::to_string(LONGEST) + " characters");
    skip_spaces();
    const std::string all = sum(0);
    if (at_ < text_.size()) fail(token() + " stands where an operator or the end should");
    return {all, n_coefficients_};
  }

 private:
  std::string sum(int depth) {
    return chain("+-", product(depth), [&] { return product(depth); });
  }
  // A law that its coefficient, 0, switches off is not evaluated: most of a sum of which a regression tries one law
  // after the other.
  std::string product(int depth) {
    const std::string first = factor(depth), all = chain("*/", first, [&] { return factor(depth); });
    const bool is_scaled = first.starts_with("c[") && all.find('(', 1) != std::string::npos;
    return is_scaled ? "(" + first + " == 0 ? 0.0 : " + all + ")" : all;
  }

  // operands with operators of one rank between them, which C, too, evaluates from the left
  template <class Operand>
  std::string chain(const char* operators, const std::string& first, const Operand& operand) {
    std::string all = first;
    while (at_ < text_.size() && std::string(operators).find(text_[at_]) != std::string::npos) {
      all += std::string(" ") + text_[at_] + " ";
      take();
      all += operand();
    }
    return all == first ? first : "(" + all + ")";
  }

  std::string factor(int depth) {
    if (depth > DEEPEST) fail("it is nested more than " + std::to_string(DEEPEST) + " levels deep");
    const char next = at_ < text_.size() ? text_[at_] : '\0';
    if (next == '+' || next == '-') {
      take();
      const std::string operand = factor(depth + 1);
      return next == '-' ? "(-" + operand + ")" : operand;
    }
    if (next == '(') {
      take();
      const std::string inner = sum(depth + 1);
      expect(')');
      return inner;
    }
    if (is_digit(next) || next == '.') return number();
    if (is_of_name(next)) return named(depth);
    fail(token() + " stands where a number, a variable, a function or ( should");
  }

  std::string number() {
    double value = 0;
    const char* first = text_.data() + at_;
    const auto [end, error] = std::from_chars(first, text_.data() + text_.size(), value);
    if (error != std::errc() || !std::isfinite(value)) fail("there is no number that a double can hold");
    take(std::size_t(end - first));
    return printed(value);
  }

  std::string named(int depth) {
    const std::string name = word();
    const std::size_t place = at_;
    take(name.size());
    if (std::find(variables_.begin(), variables_.end(), name) != variables_.end()) return name;
    for (std::size_t i = 0; i < MOST_COEFFICIENTS; ++i)
      if (name == "c" + std::to_string(i)) {
        n_coefficients_ = std::max(n_coefficients_, i + 1);
        return "c[" + std::to_string(i) + "]";
      }
    for (const Function& function : FUNCTIONS)
      if (name == function.name) return name + arguments(function.n_arguments, depth);
    at_ = place;
    fail("`" + name + "` is not known");
  }

  std::string arguments(int n, int depth) {
    std::string all = "(";
    for (int k = 0; k < n; ++k) {
      expect(k == 0 ? '(' : ',');
      all += (k == 0 ? "" : ", ") + sum(depth + 1);
    }
    expect(')');
    return all + ")";
  }

  std::string word() const {
    std::size_t end = at_;
    while (end < text_.size() && is_of_name(text_[end])) ++end;
    return text_.substr(at_, end - at_);
  }
  std::string token() const {
    if (at_ >= text_.size()) return "the end";
    if (static_cast<unsigned char>(text_[at_]) < ' ') return "something unprintable";
    return "`" + (is_of_name(text_[at_]) ? word() : std::string(1, text_[at_])) + "`";
  }

  void skip_spaces() { at_ = std::min(text_.find_first_not_of(" \t\n", at_), text_.size()); }
  void take(std::size_t n = 1) {
    at_ += n;
    skip_spaces();
  }
  void expect(char wanted) {
    if (at_ >= text_.size() || text_[at_] != wanted) fail(token() + " stands where " + wanted + " should");
    take();
  }

  [[noreturn]] void fail(const std::string& what) const {
    std::string known, functions;
    for (const std::string& variable : variables_) known += variable + ", ";
    for (const Function& f : FUNCTIONS) functions += std::string(" ") + f.name;
    throw UsageError("at character " + std::to_string(at_ + 1) + ", " + what + "; it may hold numbers, " + known +
                     "c0 to c" + std::to_string(MOST_COEFFICIENTS - 1) + ", + - * / ( ) and" + functions);
  }

  const std::string& text_;
  std::span<const std::string> variables_;
  std::size_t at_ = 0, n_coefficients_ = 0;
};

}  // namespace

Formula parse_formula(const std::string& text, std::span<const std::string> variables) {
  return Parser(text, variables).formula();
}

}  // namespace pvg

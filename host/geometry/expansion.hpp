// Exact sums and products of doubles: a number as a sum of doubles that do not overlap, smallest first.
// Shewchuk 1997, "Adaptive precision floating-point arithmetic and fast robust geometric predicates". Exact as long as
// nothing under- or overflows. Slow: for the few cases that a floating-point filter cannot decide.
#pragma once
#include <cmath>
#include <vector>

namespace pvg {

class Expansion {
 public:
  Expansion() = default;
  explicit Expansion(double value) { add(value); }
  // a - b
  static Expansion difference(double a, double b) {
    Expansion e(a);
    e.add(-b);
    return e;
  }
  Expansion& operator+=(const Expansion& other) {
    for (const double part : other.parts_) add(part);
    return *this;
  }
  Expansion& operator-=(const Expansion& other) {
    for (const double part : other.parts_) add(-part);
    return *this;
  }
  friend Expansion operator-(Expansion a, const Expansion& b) { return a -= b; }
  friend Expansion operator+(Expansion a, const Expansion& b) { return a += b; }
  friend Expansion operator*(const Expansion& a, const Expansion& b) {
    Expansion product;
    for (const double x : a.parts_)
      for (const double y : b.parts_) {
        const double high = x * y;
        product.add(std::fma(x, y, -high));
        product.add(high);
      }
    return product;
  }
  // the largest part decides
  int sign() const { return parts_.empty() ? 0 : parts_.back() > 0 ? 1 : -1; }

 private:
  // the sum of part and everything in parts_, zeros left out
  void add(double part) {
    std::vector<double> sum;
    double carry = part;
    for (const double x : parts_) {
      const double s = carry + x, x_in_s = s - carry, error = (carry - (s - x_in_s)) + (x - x_in_s);
      if (error != 0) sum.push_back(error);
      carry = s;
    }
    if (carry != 0) sum.push_back(carry);
    parts_ = std::move(sum);
  }
  std::vector<double> parts_;
};

}  // namespace pvg

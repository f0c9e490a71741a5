#include "host/identify/search/identifiability.hpp"

#include <fmt/format.h>

#include <cmath>

#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
using Columns = std::vector<std::size_t>;

// Of each candidate, in order.
std::vector<Columns> columns_of(const Signatures& s) {
  std::vector<Columns> columns;
  for (std::size_t i = 0; i < s.candidate.size(); ++i) {
    if (i == 0 || s.candidate[i] != s.candidate[i - 1]) columns.emplace_back();
    columns.back().push_back(i);
  }
  return columns;
}

MatrixXd information_of(const Signatures& s, const Columns& rows, const Columns& columns) {
  MatrixXd part(Eigen::Index(rows.size()), Eigen::Index(columns.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t k = 0; k < columns.size(); ++k)
      part(Eigen::Index(i), Eigen::Index(k)) = s.information(Eigen::Index(rows[i]), Eigen::Index(columns[k]));
  return part;
}

// The information on `columns` that is left with the numbers of `other` free.
MatrixXd information_beside(const Signatures& s, const Columns& columns, const Columns& other) {
  const MatrixXd cross = information_of(s, other, columns);
  const MatrixXd of_other = information_of(s, other, other);
  return information_of(s, columns, columns) -
         cross.transpose() * of_other.completeOrthogonalDecomposition().solve(cross);
}

// Standard deviation of the first number, in units of its step; infinite where less than `told_apart_share` of what one
// step changes is left.
double first_sigma(const MatrixXd& information, const MatrixXd& alone) {
  const MatrixXd scaled = information + 1e-12 * alone.trace() * MatrixXd::Identity(alone.rows(), alone.rows());
  if (!(information(0, 0) > criteria().told_apart_share * alone(0, 0))) return INFINITY;
  return std::sqrt(std::max(scaled.ldlt().solve(VectorXd::Unit(alone.rows(), 0))[0], 0.0));
}

}  // namespace

std::vector<Showable> identifiability(const Signatures& s) {
  const std::vector<Columns> all = columns_of(s);
  std::vector<Showable> rows;
  for (const Columns& columns : all) {
    const Candidate& candidate = *s.candidate[columns[0]];
    const Parameter& p = candidate.parameters[s.parameter[columns[0]]];
    const MatrixXd alone = information_of(s, columns, columns);
    const double step = std::abs(s.step[columns[0]]);
    Showable row{&candidate, p.name, p.unit, step * first_sigma(alone, alone)};
    row.smallest = criteria().showable_sigma * row.sigma;
    for (const Columns& other : all) {
      if (&other == &columns) continue;
      const double sigma = step * first_sigma(information_beside(s, columns, other), alone);
      if (sigma <= row.sigma_beside) continue;
      row.sigma_beside = sigma;
      row.look_alike = s.candidate[other[0]];
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<const Candidate*> look_alikes(const Signatures& s, const Candidate& named, const VectorXd& values) {
  const std::vector<Columns> all = columns_of(s);
  std::vector<const Candidate*> found;
  for (const Columns& columns : all) {
    if (s.candidate[columns[0]] != &named) continue;
    VectorXd size(Eigen::Index(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::size_t k = s.parameter[columns[i]];
      size[Eigen::Index(i)] = (values[Eigen::Index(k)] - named.parameters[k].off) / s.step[columns[i]];
    }
    for (const Columns& other : all) {
      if (&other == &columns) continue;
      const double left = size.dot(information_beside(s, columns, other) * size);
      if (left < criteria().told_apart * criteria().told_apart) found.push_back(s.candidate[other[0]]);
    }
  }
  return found;
}

std::string text_of(const Showable& row) {
  const std::string unit = row.unit == "1" ? "" : " " + row.unit;
  std::string text = fmt::format("{}: {} from {:.2g}{}", row.candidate->label(), row.parameter, row.smallest, unit);
  if (row.look_alike == nullptr) return text;
  if (std::isinf(row.sigma_beside)) return text + ", not told from " + row.look_alike->label();
  return text + fmt::format(", told from {} from {:.2g}{}", row.look_alike->label(),
                            criteria().showable_sigma * row.sigma_beside, unit);
}

namespace {

struct Part {
  MatrixXd a;
  VectorXd g;
};

Part part_of(const Signatures& s, std::span<const std::size_t> columns) {
  const Eigen::Index n = Eigen::Index(columns.size());
  Part part{MatrixXd(n, n), VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    part.g[i] = s.g[Eigen::Index(columns[std::size_t(i)])];
    for (Eigen::Index k = 0; k < n; ++k)
      part.a(i, k) = s.a(Eigen::Index(columns[std::size_t(i)]), Eigen::Index(columns[std::size_t(k)]));
  }
  return part;
}

}  // namespace

VectorXd optimum_of(const Signatures& signatures, std::span<const std::size_t> columns) {
  Part part = part_of(signatures, columns);
  part.a.diagonal().array() *= 1 + criteria().signature_ridge;
  const VectorXd x = -part.a.ldlt().solve(part.g);
  return x.allFinite() ? x : VectorXd::Zero(part.g.size());
}

double gain_at(const Signatures& signatures, std::span<const std::size_t> columns, const VectorXd& x) {
  const Part part = part_of(signatures, columns);
  return -(part.g.dot(x) + 0.5 * x.dot(part.a * x));
}

}  // namespace pvg::diagnose

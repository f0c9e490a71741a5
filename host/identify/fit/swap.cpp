#include "host/identify/fit/swap.hpp"

#include <algorithm>

namespace pvg::diagnose {
using Eigen::VectorXd;

Model without(const Model& model, std::size_t left_out) {
  Model less;
  std::vector<double> x, scale;
  Eigen::Index at = 0;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    for (std::size_t k = 0; k < model.parts[i]->parameters.size(); ++k, ++at)
      if (i != left_out) x.push_back(model.x[at]), scale.push_back(model.scale[at]);
    if (i != left_out) less.parts.push_back(model.parts[i]);
  }
  less.x = Eigen::Map<const VectorXd>(x.data(), Eigen::Index(x.size()));
  less.scale = Eigen::Map<const VectorXd>(scale.data(), Eigen::Index(scale.size()));
  return less;
}

std::vector<Model> each_left_out(const Model& model) {
  std::vector<Model> models;
  for (std::size_t i = std::size_t(model.n_nuisances()); i < model.parts.size(); ++i)
    models.push_back(without(model, i));
  return models;
}

Model replaced(const Model& model, std::size_t place, const Model& other) {
  Eigen::Index first = 0;
  for (std::size_t i = 0; i < place; ++i) first += Eigen::Index(model.parts[i]->parameters.size());
  const Eigen::Index n_old = Eigen::Index(model.parts[place]->parameters.size());
  const Eigen::Index n_new = Eigen::Index(other.parts.back()->parameters.size());
  const auto spliced = [&](const VectorXd& x, const VectorXd& with) {
    VectorXd out(x.size() - n_old + n_new);
    out << x.head(first), with.tail(n_new), x.tail(x.size() - first - n_old);
    return out;
  };
  Model next = model;
  next.parts[place] = other.parts.back();
  next.x = spliced(model.x, other.x);
  next.scale = spliced(model.scale, other.scale);
  return next;
}

std::vector<Model> swapped(const Model& model, std::size_t place, const std::vector<Fit>& others, std::size_t most) {
  std::vector<Model> models;
  for (const Fit& other : others)
    if (models.size() < most &&
        std::find(model.parts.begin(), model.parts.end(), other.model.parts.back()) == model.parts.end())
      models.push_back(replaced(model, place, other.model));
  return models;
}

Model with_numbers_of(Model model, const Model& other) {
  Eigen::Index here = 0, there = 0;
  for (std::size_t i = 0; i < std::min(model.parts.size(), other.parts.size()); ++i) {
    const std::vector<Parameter>&mine = model.parts[i]->parameters, &its = other.parts[i]->parameters;
    for (std::size_t k = 0; k < mine.size() && model.parts[i]->target == other.parts[i]->target; ++k)
      for (std::size_t j = 0; j < its.size(); ++j)
        if (its[j].name == mine[k].name)
          model.x[here + Eigen::Index(k)] = std::clamp(other.x[there + Eigen::Index(j)], mine[k].low, mine[k].high);
    here += Eigen::Index(mine.size());
    there += Eigen::Index(its.size());
  }
  return model;
}

std::vector<Model> with_wrong_numbers(const Model& model, const std::vector<Candidate>& candidates) {
  std::vector<Model> models;
  for (Eigen::Index i = 0; i < model.n_nuisances(); ++i) {
    const Candidate& nuisance = *model.parts[std::size_t(i)];
    const Parameter& p = nuisance.parameters[0];
    if (model.x[i] > p.low && model.x[i] < p.high) continue;
    for (const Candidate& candidate : candidates) {
      if (candidate.label() != nuisance.label()) continue;
      Model farther = joined(without(model, std::size_t(i)), model_of({&candidate}));
      farther.x[farther.x.size() - 1] = model.x[i];
      models.push_back(std::move(farther));
    }
  }
  return models;
}

}  // namespace pvg::diagnose

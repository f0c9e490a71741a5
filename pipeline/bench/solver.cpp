#include "pipeline/bench/solver.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <functional>

#include "host/base/statistics.hpp"
#include "host/physics/contact/contact.hpp"
#include "host/physics/linear/conjugate_gradients.hpp"
#include "host/physics/step/potential.hpp"
#include "host/physics/step/simulation.hpp"
#include "host/physics/step/time_integration.hpp"
#include "pipeline/bench/cholmod_factor.hpp"

namespace pvg {
namespace {

constexpr int APPLICATIONS = 20;  // timed together

struct Seconds {
  double wall = 0, cpu = 0;
};

// Median of `repeats` runs after one that does not count.
Seconds time_of(Device& device, std::size_t repeats, const std::function<void()>& work) {
  std::vector<double> wall, cpu;
  for (std::size_t i = 0; i <= repeats; ++i) {
    device.finish();
    const std::clock_t cpu_begin = std::clock();
    const auto begin = std::chrono::steady_clock::now();
    work();
    device.finish();
    if (i == 0) continue;
    wall.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    cpu.push_back(double(std::clock() - cpu_begin) / CLOCKS_PER_SEC);
  }
  return {median(wall), median(cpu)};
}

std::vector<Vec3> to_points(const std::vector<double>& values) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) points.emplace_back(&values[i]);
  return points;
}

// The linear system of a step's first Newton iteration, begun at a checkpoint.
struct LinearSystem {
  LinearSystem(Device& device, const BenchmarkRun& run, std::size_t n_worlds, const Checkpoint& checkpoint)
      : system(make_system(std::vector<PhysicalScene>(n_worlds, run.scene))),
        potential(device, system),
        x(device, system.n_nodes(), system.sites.size(), "x"),
        start(device, system.n_nodes(), system.sites.size(), "start"),
        predicted(device, system.n_nodes(), system.sites.size(), "predicted"),
        gradient(device, system.x.size(), "gradient"),
        integrator(device, system),
        contacts([&] {
          x.node.write(checkpoint.position);
          potential.update_sites(x);
          std::vector<ContactSettings> settings(n_worlds, run.scene.contact);
          return ContactSet(device, system.collision, settings, to_points(x.site.read()));
        }()) {
    const SolverSettings& solver = run.scene.solver;
    integrator.restore(checkpoint.history);
    const bool goes_on = integrator.goes_on(0, solver.time_step);
    const double inertia_h = integrator.begin_step(x.node, solver.time_step, solver.integrator, goes_on,
                                                   potential.sites(), start, predicted);
    potential.begin_step(x, predicted, solver.time_step, inertia_h);
    contacts.lagged().restore_anchors(checkpoint.anchors);
    contacts.find_candidates(x.site, x.site);
    contacts.find_contacts(x.site);
    contacts.lag_friction(x.site, solver.time_step, x.site, predicted.site);
    potential.set_friction(contacts);
    potential.differentiate(x, contacts, gradient);
  }
  System system;
  Potential potential;
  Positions x, start, predicted;
  Buffer<f64> gradient;
  TimeIntegrator integrator;
  ContactSet contacts;
};

Checkpoint last_state(Device& device, const BenchmarkRun& run, std::size_t n_worlds, const std::atomic<bool>& stop) {
  Simulation simulation(device, std::vector<PhysicalScene>(n_worlds, run.scene));
  for (const std::vector<double>& target : run.targets) {
    if (stop) throw TryAgain("stopped; nothing was measured");
    simulation.step(std::vector<std::vector<double>>(n_worlds, target));
  }
  return simulation.checkpoint();
}

using Product = ConjugateGradients::Product;

void time_solve(Device& device, LinearSystem& linear, std::size_t repeats, const Product& precondition,
                PreconditionerFigures& figures) {
  const System& system = linear.system;
  const SolverSettings& solver = system.scenes[0].solver;
  Buffer<f64> dx(device, system.x.size(), "dx");
  ConjugateGradients cg(device, system.node_world, system.n_worlds(), system.node_ranges);
  const auto seconds = time_of(device, repeats, [&] {
    const CgReport report =
        cg.solve([&](const Buffer<f64>& p, Buffer<f64>& out) { linear.potential.product(p, out); }, precondition,
                 linear.gradient, std::vector<char>(system.n_worlds(), true), solver.cg_tolerance, solver.max_cg, dx);
    figures.iterations = *std::max_element(report.iterations.begin(), report.iterations.end());
  });
  figures.solve_seconds = seconds.wall;
  figures.solve_cpu_seconds = seconds.cpu;
  figures.apply_seconds = time_of(device, repeats,
                                  [&] {
                                    for (int i = 0; i < APPLICATIONS; ++i) precondition(linear.gradient, dx);
                                  })
                              .wall /
                          APPLICATIONS;
}

PreconditionerFigures time_ours(Device& device, BenchmarkRun run, std::size_t n_worlds, const Checkpoint& checkpoint,
                                std::size_t repeats, SolverSettings::Preconditioner kind, bool takes_contacts) {
  run.scene.solver.preconditioner = kind;
  LinearSystem linear(device, run, n_worlds, checkpoint);
  PreconditionerFigures figures;
  figures.name = PRECONDITIONER_NAMES[std::size_t(kind)] + std::string(takes_contacts ? " with contacts" : "");
  const std::vector<char> all(n_worlds, true);
  figures.analyse_seconds =
      time_of(device, 1, [&] { const Preconditioner again(device, linear.system, linear.potential.matrix()); }).wall;
  if (takes_contacts) {
    linear.potential.couple_contacts(all, Potential::Coupling::step_begins);
    figures.analyse_seconds = time_of(device, 1, [&] {
                                const auto couplings = linear.potential.couplings();
                                linear.potential.restore_couplings(std::vector<std::vector<NodePair>>(n_worlds));
                                linear.potential.restore_couplings(couplings);
                              }).wall;
  }
  const Seconds build = time_of(device, repeats, [&] {
    if (linear.potential.factorize(all))
      throw Failure("the matrix of scene " + run.scene.name + " is not positive definite");
  });
  figures.build_seconds = build.wall;
  figures.build_cpu_seconds = build.cpu;
  figures.bytes = double(linear.potential.preconditioner_bytes());
  time_solve(
      device, linear, repeats, [&](const Buffer<f64>& r, Buffer<f64>& z) { linear.potential.precondition(r, z); },
      figures);
  return figures;
}

// CHOLMOD's factor of the same matrix without contacts.
PreconditionerFigures time_cholmod(Device& device, const BenchmarkRun& run, std::size_t n_worlds,
                                   const Checkpoint& checkpoint, std::size_t repeats) {
  LinearSystem linear(device, run, n_worlds, checkpoint);
  const BlockMatrix& matrix = linear.potential.matrix();
  PreconditionerFigures figures;
  figures.name = "CHOLMOD";
  figures.analyse_seconds = time_of(device, 1, [&] { CholmodFactor(matrix.pattern()); }).wall;
  CholmodFactor factor(matrix.pattern());
  const Seconds build = time_of(device, repeats, [&] {
    if (!factor.factorize(matrix.blocks().read()))
      throw Failure("CHOLMOD: the matrix of scene " + run.scene.name + " is not positive definite");
  });
  figures.build_seconds = build.wall;
  figures.build_cpu_seconds = build.cpu;
  figures.bytes = 8.0 * double(factor.n_numbers());
  time_solve(
      device, linear, repeats,
      [&](const Buffer<f64>& r, Buffer<f64>& z) {
        std::vector<double> values = r.read();
        factor.solve(values);
        z.write(values);
      },
      figures);
  return figures;
}

// The terms of solids and cloths by both kinds of product.
ProductFigures time_products(Device& device, LinearSystem& linear, std::size_t repeats) {
  const System& system = linear.system;
  Term inertia(device, "body", "point_inertia", 1), solid_4(device, "elastic", "stable_neo_hookean_4", 4);
  Term solid_10(device, "elastic", "stable_neo_hookean_10", 10), membrane(device, "elastic", "cloth_membrane", 3);
  Term bending(device, "elastic", "triangle_bending", 6);
  inertia.set(system.point_inertia.rows, system.point_inertia.world_first);
  solid_4.set(system.stable_neo_hookean_4.rows, system.stable_neo_hookean_4.world_first);
  solid_10.set(system.stable_neo_hookean_10.rows, system.stable_neo_hookean_10.world_first);
  membrane.set(system.cloth_membrane.rows, system.cloth_membrane.world_first);
  bending.set(system.triangle_bending.rows, system.triangle_bending.world_first);
  std::vector<Term*> terms;
  for (Term* term : {&inertia, &solid_4, &solid_10, &membrane, &bending})
    if (term->size() > 0) terms.push_back(term);
  ProductFigures figures;
  std::vector<RowBlock> blocks;
  u32 n_rows = 0;
  const double h = system.scenes[0].solver.time_step;
  BlockMatrix matrix(device, system.sites, system.node_is_fixed, terms);
  for (Term* term : terms) {
    term->hessian(linear.x.site, linear.x.site, h);
    term->first_row = n_rows;
    blocks.push_back({term->sites(), n_rows});
    n_rows += u32(term->size() * term->stencil());
    figures.element_bytes += 8.0 * double(term->n_block_numbers());
  }
  Gather gather(device, system.sites, system.n_nodes());
  gather.set(blocks);
  Program nodes(device, "solve/nodes.cl");
  Kernel to_sites = nodes.kernel("nodes_to_sites"), gather_rows = nodes.kernel("gather_rows");
  Buffer<Site> sites(device, system.sites, "sites");
  Buffer<u32> is_fixed(device, system.node_is_fixed, "is_fixed");
  Buffer<f64> rows(device, 3 * n_rows, "rows"), of_sites(device, 3 * system.sites.size(), "of sites");
  Buffer<f64> out(device, system.x.size(), "out");
  figures.matrix_bytes = 8.0 * double(matrix.blocks().size());
  figures.assemble_seconds = time_of(device, repeats, [&] { matrix.assemble(); }).wall;
  figures.matrix_seconds = time_of(device, repeats,
                                   [&] {
                                     for (int i = 0; i < APPLICATIONS; ++i) matrix.multiply(linear.gradient, out);
                                   })
                               .wall /
                           APPLICATIONS;
  figures.elements_seconds = time_of(device, repeats,
                                     [&] {
                                       for (int i = 0; i < APPLICATIONS; ++i) {
                                         const std::size_t n = system.sites.size();
                                         to_sites(n, u32(n), sites, linear.gradient, of_sites);
                                         for (Term* term : terms) term->product(of_sites, rows);
                                         gather.apply(gather_rows, is_fixed, rows, false, out);
                                       }
                                     })
                                 .wall /
                             APPLICATIONS;
  return figures;
}

}  // namespace

SolverFigures run_solver_benchmark(const PhysicsBenchmark& benchmark, const std::filesystem::path& data,
                                   const std::string& device_name, std::size_t repeats, const std::atomic<bool>& stop) {
  const BenchmarkRun run = load_run(benchmark, data);
  Device device(device_name);
  const Checkpoint checkpoint = last_state(device, run, benchmark.n_worlds, stop);
  SolverFigures figures;
  figures.scene = benchmark.name;
  {
    LinearSystem linear(device, run, benchmark.n_worlds, checkpoint);
    figures.unknowns = linear.system.x.size();
    figures.contacts = linear.contacts.contacts().n();
    figures.product = time_products(device, linear, repeats);
  }
  using Kind = SolverSettings::Preconditioner;
  const auto ours = [&](Kind kind, bool takes_contacts) {
    if (stop) throw TryAgain("stopped; nothing was measured");
    figures.preconditioners.push_back(
        time_ours(device, run, benchmark.n_worlds, checkpoint, repeats, kind, takes_contacts));
  };
  ours(Kind::factor, false);
  if (figures.contacts > 0) ours(Kind::factor, true);
  ours(Kind::schwarz, false);
  ours(Kind::block_jacobi, false);
  if (CholmodFactor::is_there())
    figures.preconditioners.push_back(time_cholmod(device, run, benchmark.n_worlds, checkpoint, repeats));
  return figures;
}

}  // namespace pvg

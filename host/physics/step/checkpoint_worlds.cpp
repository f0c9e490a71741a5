#include "host/physics/step/checkpoint_worlds.hpp"

#include <algorithm>
#include <span>

namespace pvg {
namespace {

// Where the numbers of a world stand in the lists that are not made of a part for each world.
struct Places {
  std::vector<std::size_t> node;      // of the numbers of its nodes; they are consecutive
  std::vector<std::size_t> pressing;  // of its rolling resistances
  std::vector<std::size_t> flowed;    // of its elements that flow, nine each
  std::vector<u32> site;              // of its sites, ascending: nodes, then points and directions
};

template <class Element>
void add_flows(std::vector<Places>& places, const std::vector<PlasticFlow>& flows, const Rows<Element>& elements,
               std::size_t& at) {
  for (const PlasticFlow& flow : flows) {
    const auto next = std::upper_bound(elements.world_first.begin(), elements.world_first.end(), flow.element);
    Places& world = places[std::size_t(next - elements.world_first.begin()) - 1];
    for (int k = 0; k < 9; ++k) world.flowed.push_back(at++);
  }
}

std::vector<Places> places_of(const System& system) {
  std::vector<Places> places(system.n_worlds());
  for (const WorldRange& range : system.node_ranges)
    for (std::size_t i = 3 * std::size_t(range.begin); i < 3 * std::size_t(range.end); ++i)
      places[range.world].node.push_back(i);
  for (u32 site = 0; site < system.sites.size(); ++site)
    places[system.node_world[system.sites[site].node[0]]].site.push_back(site);
  for (std::size_t i = 0; i < system.rolling_resistance.size(); ++i)
    places[system.rolling_resistance[i].world].pressing.push_back(i);
  std::size_t at = 0;
  add_flows(places, system.plastic_flow_4, system.stable_neo_hookean_4, at);
  add_flows(places, system.plastic_flow_10, system.stable_neo_hookean_10, at);
  return places;
}

std::vector<double> taken(const std::vector<double>& whole, const std::vector<std::size_t>& places) {
  std::vector<double> part;
  for (const std::size_t i : places) part.push_back(whole[i]);
  return part;
}

bool put_numbers(std::vector<double>& whole, const std::vector<std::size_t>& places, const std::vector<double>& part) {
  if (part.size() != places.size()) return false;
  for (std::size_t i = 0; i < places.size(); ++i) whole[places[i]] = part[i];
  return true;
}

std::vector<double> shifted(std::vector<double> nodes, double by) {
  for (double& node : nodes) node += by;
  return nodes;
}

// Sites are numbered over all worlds; within one world both numberings have one order, so the anchors stay sorted.
std::vector<FrictionAnchor> of_world(std::vector<FrictionAnchor> anchors, const std::vector<u32>& sites) {
  for (FrictionAnchor& anchor : anchors)
    for (u32& site : std::span(anchor.pair).subspan(1))
      site = u32(std::lower_bound(sites.begin(), sites.end(), site) - sites.begin());
  return anchors;
}

bool into_world(std::vector<FrictionAnchor>& anchors, const std::vector<u32>& sites) {
  for (FrictionAnchor& anchor : anchors)
    for (u32& site : std::span(anchor.pair).subspan(1)) {
      if (site >= sites.size()) return false;
      site = sites[site];
    }
  return true;
}

}  // namespace

std::vector<Checkpoint> split(const Checkpoint& whole, const System& system) {
  const std::vector<Places> places = places_of(system);
  const MotionHistory& history = whole.history;
  std::vector<Checkpoint> worlds;
  for (std::size_t w = 0; w < places.size(); ++w) {
    const Places& at = places[w];
    Checkpoint& world = worlds.emplace_back();
    world.position = taken(whole.position, at.node);
    world.history = {taken(history.velocity, at.node),
                     taken(history.position_before, at.node),
                     taken(history.velocity_before, at.node),
                     taken(history.velocity_two_before, at.node),
                     {history.length_before[w]}};
    world.anchors = {of_world(whole.anchors[w], at.site)};
    world.time = {whole.time[w]};
    world.joint_position = {whole.joint_position[w]};
    world.targets = {whole.targets[w]};
    world.couplings = {shifted(whole.couplings[w], -double(system.node_ranges[w].begin))};
    world.past_targets = {whole.past_targets[w]};
    world.pressing = taken(whole.pressing, at.pressing);
    world.reading = {whole.reading[w]};
    world.flowed = taken(whole.flowed, at.flowed);
    world.joint_motion = {whole.joint_motion[w]};
  }
  return worlds;
}

bool put(Checkpoint& whole, std::span<const std::optional<Checkpoint>> worlds, const System& system) {
  if (worlds.size() != system.n_worlds()) return false;
  const std::vector<Places> places = places_of(system);
  for (std::size_t w = 0; w < worlds.size(); ++w) {
    if (!worlds[w]) continue;
    const Checkpoint& world = *worlds[w];
    const Places& at = places[w];
    MotionHistory& history = whole.history;
    if (world.time.size() != 1 || !put_numbers(whole.position, at.node, world.position) ||
        !put_numbers(history.velocity, at.node, world.history.velocity) ||
        !put_numbers(history.position_before, at.node, world.history.position_before) ||
        !put_numbers(history.velocity_before, at.node, world.history.velocity_before) ||
        !put_numbers(history.velocity_two_before, at.node, world.history.velocity_two_before) ||
        !put_numbers(whole.pressing, at.pressing, world.pressing) ||
        !put_numbers(whole.flowed, at.flowed, world.flowed))
      return false;
    history.length_before[w] = world.history.length_before[0];
    whole.anchors[w] = world.anchors[0];
    if (!into_world(whole.anchors[w], at.site)) return false;
    whole.time[w] = world.time[0];
    whole.joint_position[w] = world.joint_position[0];
    whole.targets[w] = world.targets[0];
    whole.couplings[w] = shifted(world.couplings[0], double(system.node_ranges[w].begin));
    whole.past_targets[w] = world.past_targets[0];
    whole.reading[w] = world.reading[0];
    whole.joint_motion[w] = world.joint_motion[0];
  }
  return true;
}

}  // namespace pvg

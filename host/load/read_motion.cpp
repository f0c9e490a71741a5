// The section `motion` of a task file: elements one after the other, some of them together.
#include "host/load/read_sections.hpp"

namespace pvg {

using Section = YamlSection;

std::vector<MotionElement> read_motion(Section& root, const std::vector<RobotCell>& robots) {
  const Fields<MotionElement> fields = motion_fields(robots);
  std::vector<MotionElement> motion;
  for (Section& section : root.sections("motion")) {
    if (!section.has("together")) {
      motion.push_back(read_all(fields, section));
      motion.back().place = section.place();
      continue;
    }
    std::vector<Section> parts = section.sections("together");
    for (std::size_t i = 0; i < parts.size(); ++i) {
      motion.push_back(read_all(fields, parts[i]));
      motion.back().place = parts[i].place();
      motion.back().is_with_previous = i > 0;
      for (std::size_t k = 1; k <= i; ++k)
        if (motion[motion.size() - 1 - k].robot == motion.back().robot)
          parts[i].fail("robot", "moves twice in what goes on together; give each robot one element");
    }
    section.done();
  }
  if (motion.empty()) root.fail("", "lacks `motion`: a task has at least one motion element");
  return motion;
}

}  // namespace pvg

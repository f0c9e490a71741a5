#!/bin/sh
# The house rules that includes must keep:
#   1. a file includes only its own floor or floors below: kernels < host < pipeline
#   2. <CL/...> stays in host/device
#   3. pvg_core (host/base, device, geometry, physics, render) includes nothing of host/robot, host/io or pipeline,
#      of host/scene only the plain structs, and no library but Eigen and OpenCL
set -eu
cd "${1:-$(dirname "$0")/..}"
findings=$(mktemp)
trap 'rm -f "$findings"' EXIT
complain() { # $1: the rule that is broken; stdin: places
  places=$(cat)
  [ -z "$places" ] || printf 'floors: %s:\n%s\n' "$1" "$places" >>"$findings"
}
find_includes() { # $1: extended regular expression after #include; the rest: folders
  pattern="^[[:space:]]*#[[:space:]]*include[[:space:]]*$1"
  shift
  grep -rnE --include='*.[ch]pp' --include='*.h' --include='*.cl' "$pattern" "$@" || true
}
core="host/base host/device host/geometry host/physics host/render"

find_includes '["<](host|pipeline|tests)/' kernels | complain "kernels include nothing above them"
find_includes '["<](pipeline|tests)/' host | complain "the library includes nothing of the pipeline"
find_includes '["<]tests/' pipeline | complain "the pipeline includes nothing of the tests"
find_includes '<CL/' kernels host pipeline tests | grep -v '^host/device/' | complain "OpenCL's headers stay in host/device"
find_includes '"host/(robot|io)/' $core | complain "pvg_core includes nothing of host/robot and host/io"
find_includes '"host/scene/' $core | grep -vE '"host/scene/(scene|state|motion)\.hpp"' |
  complain "pvg_core includes of host/scene only scene.hpp, state.hpp and motion.hpp"
find_includes '<(yaml-cpp|nlohmann|urdf|assimp|OpenImageIO|hdf5|oneapi|tbb|fmt|spdlog|CLI|opencv2)' $core |
  complain "pvg_core depends on OpenCL and Eigen alone"
if [ -s "$findings" ]; then
  cat "$findings" >&2
  exit 1
fi
echo "floors: every include goes to its own floor or down"

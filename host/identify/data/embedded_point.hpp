// Markers on soft bodies and cloth: the embedding of host/geometry.
#pragma once
#include "host/geometry/embedded_point.hpp"

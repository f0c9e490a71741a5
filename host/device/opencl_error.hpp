// What the OpenCL driver answered, as an error.
#pragma once
#include <string>

#include "host/device/impl.hpp"

namespace pvg {

// Throws a DeviceError, "WHAT: the OpenCL driver answered ...", unless the code is CL_SUCCESS.
void require(cl_int code, const std::string& what);

}  // namespace pvg

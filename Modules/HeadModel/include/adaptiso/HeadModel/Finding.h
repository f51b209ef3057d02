#pragma once

#include <string>

#include "adaptiso/Core/Geometry.h"

namespace adaptiso {

/// Why a surface or a head model can't be had as asked for, and where.
struct Finding {
    std::string what;  ///< one line: the thing, the value, the rule
    Vec3 pointMm;
};

}  // namespace adaptiso

#pragma once

#include <cstdint>
#include <cstring>

#include "adaptiso/Core/Geometry.h"

namespace adaptiso::detail {

struct HashOfPoint {
    std::size_t operator()(const Vec3& p) const {
        std::size_t hash = 0;
        for (int a = 0; a < 3; ++a) {
            std::uint64_t bits = 0;
            const double along = p[a] + 0.0;  // -0 is 0
            std::memcpy(&bits, &along, sizeof bits);
            hash = (hash ^ (bits ^ bits >> 29)) * 0x9E3779B97F4A7C15u;
        }
        return hash;
    }
};

}  // namespace adaptiso::detail

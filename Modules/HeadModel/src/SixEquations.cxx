#include "SixEquations.h"

#include <cmath>
#include <cstddef>
#include <utility>

namespace adaptiso {

std::optional<std::array<double, 6>> solved(SixEquations equations, double leastPivot) {
    SixEquations& e = equations;
    for (std::size_t c = 0; c < 6; ++c) {
        std::size_t pivot = c;
        for (std::size_t r = c + 1; r < 6; ++r) {
            if (std::abs(e[r][c]) > std::abs(e[pivot][c])) pivot = r;
        }
        if (!(std::abs(e[pivot][c]) > leastPivot)) return std::nullopt;
        std::swap(e[c], e[pivot]);
        for (std::size_t r = 0; r < 6; ++r) {
            if (r == c) continue;
            const double factor = e[r][c] / e[c][c];
            for (std::size_t k = c; k < 7; ++k) e[r][k] -= factor * e[c][k];
        }
    }
    std::array<double, 6> x{};
    for (std::size_t r = 0; r < 6; ++r) x[r] = e[r][6] / e[r][r];
    return x;
}

}  // namespace adaptiso

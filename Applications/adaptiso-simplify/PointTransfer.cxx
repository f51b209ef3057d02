#include <cstdint>

#include "Run.h"

namespace adaptiso::simplifier {

PointData transferred(PointData data, const PointTransfer& transfer) {
    data.points = static_cast<std::int64_t>(transfer.size());
    for (PointValues& array : data.arrays) {
        const auto columns = static_cast<std::size_t>(array.columns);
        if (const auto* const numbers = std::get_if<std::vector<float>>(&array.values)) {
            array.values = transfer.mixed(numbers->data(), columns);
        } else {
            array.values =
                transfer.nearest(std::get<std::vector<std::int32_t>>(array.values).data(), columns);
        }
    }
    return data;
}

}  // namespace adaptiso::simplifier

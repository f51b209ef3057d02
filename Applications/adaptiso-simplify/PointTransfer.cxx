#include <algorithm>
#include <cstdint>

#include "Run.h"

namespace adaptiso::simplifier {

PointArray transferred(const PointArray& array, const PointTransfer& transfer) {
    const auto columns = static_cast<std::size_t>(array.components);
    PointArray taken{array.name, {}, array.components};
    if (const auto* const colors = std::get_if<std::vector<Color>>(&array.values)) {
        const std::vector<std::uint8_t> shades = transfer.mixed(colors->front().data(), 3);
        std::vector<Color> mixed(transfer.size());
        for (std::size_t p = 0; p < mixed.size(); ++p) {
            std::copy_n(shades.data() + 3 * p, 3, mixed[p].data());
        }
        taken.values = std::move(mixed);
    } else if (const auto* const numbers = std::get_if<std::vector<double>>(&array.values)) {
        taken.values = transfer.mixed(numbers->data(), columns);
    } else {
        taken.values =
            transfer.nearest(std::get<std::vector<std::int64_t>>(array.values).data(), columns);
    }
    return taken;
}

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

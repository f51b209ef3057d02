// libFuzzer target: bytes that claim to be a file of values at points with the ending
// fuzz::ending(). Whatever they hold, they are refused with a FileError or give values, one
// for each point and column.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "Ending.h"
#include "OneLine.h"
#include "adaptiso/MeshIO/PointData.h"

namespace adaptiso {
namespace {

void requireNoControls(std::string_view text) {
    for (const char c : text) {
        if (static_cast<unsigned char>(c) < ' ') std::abort();
    }
}

void requireSound(const PointData& data) {
    if (data.points < 1 || data.arrays.empty()) std::abort();
    for (const PointValues& array : data.arrays) {
        const auto size = [](const auto& values) { return std::ssize(values); };
        if (std::visit(size, array.values) != data.points * array.columns) std::abort();
        requireNoControls(array.intent);
        for (const auto& [name, value] : array.metadata) requireNoControls(name + value);
    }
    for (const PointLabel& label : data.labels) requireNoControls(label.name);
}

}  // namespace
}  // namespace adaptiso

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace adaptiso;
    static const PointDataFormat format = findPointDataFormat("fuzzed" + fuzz::ending());
    try {
        requireSound(
            decodePointData({reinterpret_cast<const char*>(data), size}, format, "fuzzed"));
    } catch (const FileError& refusal) {
        fuzz::requireOneLine(refusal);
    }
    return 0;
}

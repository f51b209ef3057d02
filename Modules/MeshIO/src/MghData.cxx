// FreeSurfer's .mgh, big endian: int32 1, width, height, depth, frames, type, degrees of freedom;
// int16 whether a place in space follows; values from byte 284 on, frame after frame. What may
// follow them (times, commands, names) is nobody's. Of a surface's values each frame has
// width x height x depth, one a point.
#include "MghData.h"

#include <array>
#include <limits>

#include "ByteSource.h"

namespace adaptiso::meshio {
namespace {

constexpr auto kBig = std::endian::big;
constexpr std::size_t kHeader = 284;
enum MghType : std::int32_t { UChar = 0, Int = 1, Float = 3, Short = 4 };

std::size_t bytesOf(std::int32_t type) {
    switch (type) {
        case UChar:
            return 1;
        case Short:
            return 2;
        case Int:
        case Float:
            return 4;
        default:
            unsupported("it holds values of type " + std::to_string(type),
                        "save it as numbers of type float, int, short or uchar");
    }
}

template <class Stored, class Value>
std::vector<Value> readFrame(ByteSource& source, std::int64_t points) {
    std::vector<Value> values(static_cast<std::size_t>(points));
    for (Value& value : values) value = source.number<Stored>(kBig);
    return values;
}

PointValues frameOf(ByteSource& source, std::int64_t points, std::int32_t type) {
    if (type == Float) return {{}, readFrame<float, float>(source, points), 1, {}};
    if (type == Int) return {{}, readFrame<std::int32_t, std::int32_t>(source, points), 1, {}};
    if (type == Short) return {{}, readFrame<std::int16_t, std::int32_t>(source, points), 1, {}};
    return {{}, readFrame<std::uint8_t, std::int32_t>(source, points), 1, {}};
}

}  // namespace

PointData decodeMghData(std::string_view bytes) {
    ByteSource source(bytes);
    if (source.number<std::int32_t>(kBig) != 1) {
        damaged("it does not begin as FreeSurfer's .mgh does");
    }
    PointData data;
    data.format = PointDataFormat::FreeSurferMgh;
    data.points = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t size = source.number<std::int32_t>(kBig);
        if (size == 0) damaged("it holds no values");
        requireRoom("values", size, data.points, bytes.size());
        data.points *= size;
    }
    const std::int64_t frames = source.number<std::int32_t>(kBig);
    const auto type = source.number<std::int32_t>(kBig);
    const auto each = static_cast<std::int64_t>(bytesOf(type));
    if (frames < 1) damaged("it holds no values");
    source.take(kHeader - source.position());
    requireRoom("values", data.points, each, source.left());
    requireRoom("frames", frames, data.points * each, source.left());
    for (std::int64_t n = 0; n < frames; ++n) {
        data.arrays.push_back(frameOf(source, data.points, type));
    }
    return data;
}

void encodeMghData(const PointData& data, ByteSink& sink) {
    const bool areLabels = data.arrays.front().areLabels();
    for (const std::int64_t number :
         {std::int64_t{1}, data.points, std::int64_t{1}, std::int64_t{1},
          static_cast<std::int64_t>(data.arrays.size()), std::int64_t{areLabels ? Int : Float}}) {
        sink.bigEndian(static_cast<std::int32_t>(number));
    }
    sink << std::string(kHeader - 6 * sizeof(std::int32_t), '\0');
    for (const PointValues& frame : data.arrays) {
        std::visit(
            [&](const auto& values) {
                for (const auto value : values) sink.bigEndian(value);
            },
            frame.values);
    }
}

}  // namespace adaptiso::meshio

#pragma once

#include <cstdint>
#include <memory>
#include <variant>

#include "BlockSearch.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace adaptiso {

class SpanSpaceIndex::Impl {
public:
    template <class T>
    using Search = std::unique_ptr<const detail::BlockSearch<T>>;
    using AnySearch =
        std::variant<Search<std::uint8_t>, Search<std::int8_t>, Search<std::uint16_t>,
                     Search<std::int16_t>, Search<std::uint32_t>, Search<std::int32_t>,
                     Search<std::uint64_t>, Search<std::int64_t>, Search<float>, Search<double>>;

    BlockGrid grid;
    PixelType pixelType;
    BlockSearchKind kind;
    AnySearch search;
};

}  // namespace adaptiso

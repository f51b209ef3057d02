#include "adaptiso/Core/MghFooter.h"

#include <bit>
#include <cstring>

#include "adaptiso/Core/Bytes.h"

namespace adaptiso {
namespace {

template <class T>
T bigEndianAt(std::string_view bytes, std::size_t at) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return std::endian::native == std::endian::big ? value : swappedBytes(value);
}

}  // namespace

MghFooter mghFooterOf(std::string_view head, std::uint64_t byteCount) {
    constexpr std::size_t kLeastNumbers = 4 * sizeof(float), kNumbers = 5 * sizeof(float);
    if (byteCount == 0 || byteCount == kLeastNumbers) return MghFooter::Whole;
    if (byteCount < kNumbers) return MghFooter::CutOff;
    bool isCutOff = false;
    for (std::size_t at = kNumbers; at < head.size();) {
        // utils/tags.cpp: old tags have another kind of length, or none
        constexpr std::int32_t kOldColourTable = 1, kOldRealRas = 2, kOldSurface = 20,
                               kOldXform = 30;
        constexpr std::int32_t kLastTag = 1000, kEndTag = -1;
        if (head.size() - at < sizeof(std::int32_t)) return MghFooter::CutOff;
        const auto tag = bigEndianAt<std::int32_t>(head, at);
        at += sizeof(std::int32_t);
        const bool isEnd = tag == kEndTag && head.size() - at <= sizeof(std::int64_t);
        if (isEnd) return MghFooter::Whole;
        if (tag < 1 || tag > kLastTag) return MghFooter::None;
        if (tag == kOldRealRas) continue;
        if (tag == kOldColourTable || tag == kOldSurface) return MghFooter::OpenEnded;
        const std::size_t lengthBytes = tag == kOldXform ? 4 : 8;
        if (head.size() - at < lengthBytes) return MghFooter::CutOff;
        const std::int64_t length = tag == kOldXform ? bigEndianAt<std::int32_t>(head, at)
                                                     : bigEndianAt<std::int64_t>(head, at);
        at += lengthBytes;
        if (length < 0) return MghFooter::None;
        isCutOff = static_cast<std::uint64_t>(length) > byteCount - at;
        if (isCutOff || static_cast<std::uint64_t>(length) > head.size() - at) break;
        at += static_cast<std::size_t>(length);
    }
    return isCutOff ? MghFooter::CutOff : MghFooter::Whole;
}

}  // namespace adaptiso

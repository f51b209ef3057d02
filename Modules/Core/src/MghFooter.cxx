#include "adaptiso/Core/MghFooter.h"

#include <bit>
#include <cstring>
#include <optional>
#include <utility>

#include "adaptiso/Core/Bytes.h"

namespace adaptiso {
namespace {

template <class T>
T bigEndianAt(std::string_view bytes, std::size_t at) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return std::endian::native == std::endian::big ? value : swappedBytes(value);
}

/// utils/colortab.cpp (CTABwriteIntoBinary): big-endian numbers and texts behind their lengths.
/// \return  where it ends; empty: the bytes are no such table, or do not hold all of it
std::optional<std::size_t> endOfColorTable(std::string_view bytes, std::size_t at) {
    constexpr std::int32_t kVersion2 = -2, kMostEntries = 1 << 20, kLongestName = 1 << 16;
    constexpr std::size_t kColor = 4 * sizeof(std::int32_t);
    const auto number = [&](std::int32_t least, std::int32_t most) {
        if (bytes.size() < at || bytes.size() - at < sizeof(std::int32_t)) {
            at = std::string_view::npos;
        }
        if (at == std::string_view::npos) return std::int32_t{0};
        const auto value = bigEndianAt<std::int32_t>(bytes, at);
        at = value < least || value > most ? std::string_view::npos : at + sizeof(std::int32_t);
        return value;
    };
    const auto skip = [&](std::size_t count) {
        if (at == std::string_view::npos) return;
        at = bytes.size() - at < count ? std::string_view::npos : at + count;
    };
    const auto skipText = [&] {
        const std::int32_t length = number(0, kLongestName);
        skip(static_cast<std::size_t>(length));
    };
    std::int32_t count = number(kVersion2, kMostEntries);
    const bool isVersion2 = count == kVersion2;
    if (isVersion2) number(0, kMostEntries);  // the largest label
    skipText();
    if (isVersion2) count = number(0, kMostEntries);
    if (count < 0) return std::nullopt;
    for (std::int32_t n = 0; n < count && at != std::string_view::npos; ++n) {
        if (isVersion2) number(0, kMostEntries);
        skipText();
        skip(kColor);
    }
    return at == std::string_view::npos ? std::nullopt : std::optional(at);
}

}  // namespace

MghFooter mghFooterOf(std::string_view head, std::uint64_t byteCount) {
    constexpr std::size_t kLeastNumbers = 4 * sizeof(float), kNumbers = 5 * sizeof(float);
    if (byteCount == 0 || byteCount == kLeastNumbers) return MghFooter::Whole;
    if (byteCount < kNumbers) return MghFooter::CutOff;
    bool isCutOff = false, hasRealRas = false;
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
        if (tag == kOldRealRas) {
            if (std::exchange(hasRealRas, true)) return MghFooter::None;
            continue;
        }
        if (tag == kOldSurface) return MghFooter::OpenEnded;
        if (tag == kOldColourTable) {
            const auto end = endOfColorTable(head, at);
            if (!end) return head.size() < byteCount ? MghFooter::OpenEnded : MghFooter::None;
            at = *end;
            continue;
        }
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

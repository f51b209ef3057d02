#include "DataTail.h"

#include <fmt/core.h>

#include "FileFault.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr const char* kRemedy =
    "correct the header's size, type or number of volumes, or cut the file to one image";

/// "2 more images of that size", "3 more slices", "more than half as much again"
std::string amountOf(std::uint64_t extra, const ImageExtent& extent) {
    const auto times = [&](std::uint64_t unit, const char* name) {
        const std::uint64_t count = extra / unit;
        return fmt::format("{} more {}{}", count, name, count > 1 ? "s" : "");
    };
    if (extra % extent.whole == 0) return times(extent.whole, "image") + " of that size";
    if (extra % extent.piece == 0) return times(extent.piece, "slice");
    return "half as much again or more";
}

}  // namespace

ImageExtent ImageExtent::of(const SampleLayout& layout, const Index3& size) {
    const std::uint64_t slice =
        static_cast<std::uint64_t>(size[0] * size[1]) * bytesPerPixel(layout.stored);
    return {slice, slice * static_cast<std::uint64_t>(size[2])};
}

bool isMoreImage(std::uint64_t extraBytes, const ImageExtent& extent) {
    return extraBytes > 0 && (extraBytes % extent.piece == 0 || extraBytes >= extent.whole / 2);
}

void checkTail(const fs::path& file, const ByteTail& tail, const ImageExtent& extent,
               bool isChosenPart, std::vector<Warning>& warnings) {
    if (tail.hasSecondStream) {
        refuse(file, "holds more compressed data behind the image that its header describes",
               kRemedy);
    }
    if (tail.hasStray) {
        warnings.push_back({"trailing-bytes",
                            "something that is no compressed data follows the compressed image; "
                            "it was left out"});
    }
    if (tail.byteCount == 0) return;
    const bool isMore = !tail.isZeros && isMoreImage(tail.byteCount, extent);
    if (isMore && !isChosenPart) {
        refuse(file,
               fmt::format("holds {} bytes behind the image that its header describes: {}",
                           tail.byteCount, amountOf(tail.byteCount, extent)),
               kRemedy);
    }
    warnings.push_back(
        {"trailing-bytes",
         fmt::format("{} bytes{} follow the image that its header describes; they were left out",
                     tail.byteCount, tail.isZeros ? ", all 0," : "")});
}

void checkBytesBefore(const fs::path& file, std::uint64_t byteCount, const ImageExtent& extent) {
    if (byteCount < extent.whole) return;
    refuse(file,
           fmt::format("holds {} bytes before the image that its header describes, which is the "
                       "file's end: as much as another image",
                       byteCount),
           kRemedy);
}

}  // namespace adaptiso::detail

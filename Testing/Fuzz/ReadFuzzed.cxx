#include "ReadFuzzed.h"

#include <cmath>
#include <cstdlib>

#include "OneLine.h"
#include "adaptiso/ImageIO/ListSeries.h"

namespace adaptiso::fuzz {
namespace {

void requireSound(const VolumeView& volume) {
    const ImageGeometry& geometry = volume.geometry();
    for (int axis = 0; axis < 3; ++axis) {
        if (geometry.size[axis] < 2 || !std::isfinite(geometry.originMm[axis])) std::abort();
    }
    const double cell = determinant(geometry.indexToPhysical);
    if (!std::isfinite(cell) || cell == 0) std::abort();
    // every sample is there: the sanitizer sees reads beyond their memory
    const auto* bytes = static_cast<const volatile unsigned char*>(volume.samples());
    for (std::size_t at = 0; at < volume.byteCount(); at += 64) static_cast<void>(bytes[at]);
    static_cast<void>(bytes[volume.byteCount() - 1]);
}

}  // namespace

void readFuzzed(const std::filesystem::path& input, ReadOptions options) {
    options.sandbox = false;
    try {
        const ReadVolume read = readVolume(input, options);
        requireSound(read.volume.view());
    } catch (const FileError& refusal) {
        requireOneLine(refusal);
    }
}

void listFuzzed(const std::filesystem::path& input) {
    try {
        static_cast<void>(listSeries(input));
    } catch (const FileError& refusal) {
        requireOneLine(refusal);
    }
}

}  // namespace adaptiso::fuzz

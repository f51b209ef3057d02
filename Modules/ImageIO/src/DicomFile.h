#pragma once

#include <cstdint>
#include <filesystem>

#include "DicomHeader.h"
#include "adaptiso/Core/Volume.h"

namespace adaptiso::detail {

struct DicomFile {
    std::filesystem::path path;
    DicomHeader header;
};

/// Pixel description in a DICOM file's header (PS3.3, C.7.6.3.1).
struct DicomPixelFormat {
    std::int64_t columns = 0, rows = 0, frames = 1;
    PixelType stored = PixelType::UInt16;
    int bitsStored = 16, highBit = 15;
    bool isPacked = false;  ///< 1 bit a pixel, the first in a byte's lowest; frames follow without
                            ///< padding (PS3.5, 8.1.1). `stored` is that of one unpacked

    /// Unpacked.
    std::uint64_t frameBytes() const { return framePixels() * bytesPerPixel(stored); }
    /// In the file, where it is not compressed.
    std::uint64_t nativeBytes(std::uint64_t pixels) const {
        return isPacked ? (pixels + 7) / 8 : pixels * bytesPerPixel(stored);
    }
    std::uint64_t framePixels() const { return static_cast<std::uint64_t>(columns * rows); }
    bool isSigned() const {
        return stored == PixelType::Int8 || stored == PixelType::Int16 ||
               stored == PixelType::Int32;
    }
};

}  // namespace adaptiso::detail

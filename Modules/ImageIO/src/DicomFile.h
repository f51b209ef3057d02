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

/// What a DICOM file's header says of its pixels (PS3.3, C.7.6.3.1).
struct DicomPixelFormat {
    std::int64_t columns = 0, rows = 0, frames = 1;
    PixelType stored = PixelType::UInt16;
    int bitsStored = 16, highBit = 15;

    std::uint64_t frameBytes() const {
        return static_cast<std::uint64_t>(columns * rows) * bytesPerPixel(stored);
    }
    bool isSigned() const {
        return stored == PixelType::Int8 || stored == PixelType::Int16 ||
               stored == PixelType::Int32;
    }
};

}  // namespace adaptiso::detail

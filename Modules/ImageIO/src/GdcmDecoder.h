#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "adaptiso/Core/Volume.h"

namespace adaptiso::detail {

/// What a DICOM file's header says of its pixels.
struct DicomPixelFormat {
    std::int64_t columns = 0, rows = 0, frames = 1;
    PixelType stored = PixelType::UInt16;
    int bitsStored = 16;

    std::uint64_t byteCount() const {
        return static_cast<std::uint64_t>(columns * rows * frames) * bytesPerPixel(stored);
    }
    friend bool operator==(const DicomPixelFormat&, const DicomPixelFormat&) = default;
};

/// Has GDCM decode a file's stored samples (before rescale), frame after frame.
///
/// \throws FileError when GDCM can't, or finds other sizes than the header walked here
void decodeWithGdcm(const std::filesystem::path& file, const DicomPixelFormat& format,
                    std::vector<std::byte>& samples);

}  // namespace adaptiso::detail

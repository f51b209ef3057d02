#include "Fence.h"
#include "FileFault.h"
#include "GdcmDecoder.h"
#include "Readers.h"

/// A build without GDCM: compressed DICOM and ITK's formats are refused, so that nothing needs a
/// sandbox process.
namespace adaptiso::detail {

void decodeWithGdcm(const std::filesystem::path& file, std::string_view, const std::string&,
                    const Codestream&, std::span<std::byte>) {
    refuse(file, "is compressed DICOM (JPEG), which this build doesn't decode",
           "convert it to NIfTI with dcm2niix, or use the programs");
}

FenceLimits fenceLimitsFor(const std::filesystem::path&) {
    return {};
}

ReadVolume readBehindFence(const std::filesystem::path&, const FenceLimits&,
                           const std::function<ReadVolume()>& read) {
    return read();
}

void blameBehindFence(const std::filesystem::path&) {}

bool isBehindFence() {
    return false;
}

std::shared_ptr<std::byte[]> allocateSharedBytes(std::uint64_t) {
    return {};
}

bool hasItkReaders() {
    return false;
}

std::optional<ReadVolume> readWithItk(const std::filesystem::path&, const ReadOptions&) {
    return std::nullopt;
}

}  // namespace adaptiso::detail

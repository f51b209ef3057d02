#include "FileFault.h"
#include "GdcmDecoder.h"
#include "Readers.h"
#include "Sandbox.h"

/// A build without GDCM: compressed DICOM and ITK's formats are refused, so that nothing needs a
/// sandbox process.
namespace adaptiso::detail {

void decodeWithGdcm(const std::filesystem::path& file, std::string_view, const std::string&,
                    const Codestream&, std::span<std::byte>) {
    refuse(file, "is compressed DICOM (JPEG), which this build doesn't decode",
           "convert it to NIfTI with dcm2niix, or use the programs");
}

SandboxLimits sandboxLimitsFor(const std::filesystem::path&) {
    return {};
}

ReadVolume readInSandbox(const std::filesystem::path&, const SandboxLimits&,
                         const std::function<ReadVolume()>& read) {
    return read();
}

void blameInSandbox(const std::filesystem::path&) {}

bool isInSandbox() {
    return false;
}

std::shared_ptr<std::byte[]> allocateSharedBytes(std::uint64_t) {
    return {};
}

std::string withoutItkText() {
    return "convert MINC and other formats of ITK to NIfTI, e.g. with mnc2nii";
}

std::optional<ReadVolume> readWithItk(const std::filesystem::path&, const ReadOptions&) {
    return std::nullopt;
}

}  // namespace adaptiso::detail

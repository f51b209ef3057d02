#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "adaptiso/ImageIO/ReadVolume.h"

/// One reader a format, one .cxx a reader; all keep readVolume's contract.
namespace adaptiso::detail {

ReadVolume readNifti(const std::filesystem::path& file, const ReadOptions& options);
ReadVolume readNrrd(const std::filesystem::path& file, const ReadOptions& options);
ReadVolume readMetaImage(const std::filesystem::path& file, const ReadOptions& options);
ReadVolume readMgh(const std::filesystem::path& file, const ReadOptions& options);
ReadVolume readDicomFile(const std::filesystem::path& file, const ReadOptions& options);
ReadVolume readZarr(const std::filesystem::path& folder, const ReadOptions& options);
ReadVolume readDicomFolder(const std::filesystem::path& folder, const ReadOptions& options);

/// By ITK's readers of other formats. Empty where none takes the file, or they are not installed.
std::optional<ReadVolume> readWithItk(const std::filesystem::path& file,
                                      const ReadOptions& options);
/// Says what to do with a format that ITK alone reads. Empty where ITK's readers are installed.
std::string withoutItkText();

/// Signs that turn a point of the space into LPS.
constexpr Mat3 toLps(ImageSpace space) {
    return space == ImageSpace::Lps ? Mat3::diagonal(1, 1, 1) : Mat3::diagonal(-1, -1, 1);
}

/// Format by the first bytes of a file (inflated, 1024 or all of them).
bool looksLikeNifti(std::string_view head);
bool looksLikeNrrd(std::string_view head);
bool looksLikeMetaImage(std::string_view head);
bool looksLikeDicom(std::string_view head);

/// Position of the samples of a NIfTI or MGH file, from its first bytes; 0 for a .hdr, which holds
/// no samples. Empty if it is no such file.
std::optional<std::uint64_t> niftiSamplesAt(std::string_view head);
std::optional<std::uint64_t> mghSamplesAt(std::string_view head);

}  // namespace adaptiso::detail

#pragma once

#include <filesystem>
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

/// What the first bytes of a file (inflated, 1024 or all of them) say.
bool looksLikeNifti(std::string_view head);
bool looksLikeNrrd(std::string_view head);
bool looksLikeMetaImage(std::string_view head);
bool looksLikeDicom(std::string_view head);

}  // namespace adaptiso::detail

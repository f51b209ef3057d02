#include "Common/InputKind.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include "Common/RunApp.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

/// The file begins as DICOM does.
bool isDicom(const fs::path& file) {
    std::array<char, 132> head{};
    std::ifstream in(file, std::ios::binary);
    in.read(head.data(), head.size());
    return in && std::string_view(head.data() + 128, 4) == "DICM";
}

bool hasImageName(const fs::path& file) {
    constexpr std::array<std::string_view, 13> kExtensions{
        ".nii.gz", ".nii", ".hdr.gz", ".hdr", ".img.gz", ".img", ".nrrd",
        ".nhdr",   ".mha", ".mhd",    ".mgh", ".mgz",    ".dcm"};
    const std::string name = lowerCase(file.filename().string());
    return std::any_of(kExtensions.begin(), kExtensions.end(), [&](std::string_view extension) {
        return name.size() > extension.size() && name.ends_with(extension);
    });
}

}  // namespace

std::string imageHint(const fs::path& file) {
    std::error_code error;
    if (fs::is_directory(file, error)) {
        return "this is a folder, not a surface; of the images in one adaptiso-mesh makes surfaces";
    }
    if (!fs::is_regular_file(file, error) || !(hasImageName(file) || isDicom(file))) return "";
    return "this is an image, not a surface; adaptiso-mesh makes surfaces of images";
}

const MeshFormat& meshFormatOf(const fs::path& file) {
    try {
        return findMeshFormat(file);
    } catch (const InvalidInput& error) {
        const std::string hint = imageHint(file);
        throw UsageError(hint.empty() ? error.what() : file.string() + ": " + hint);
    }
}

std::string surfaceHint(const fs::path& file) {
    try {
        findMeshFormat(file);
        readMesh(file, {.keepsFaults = true});
    } catch (const Error&) {
        return "";
    }
    return "this is a surface, not an image; adaptiso-check, adaptiso-compare and "
           "adaptiso-simplify take surfaces";
}

}  // namespace adaptiso

#include "adaptiso/MeshIO/Formats.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "ByteSource.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

using Extensions = std::string_view[];
constexpr Extensions kVtkXml = {".vtp"};
constexpr Extensions kVtkLegacy = {".vtk"};
constexpr Extensions kPly = {".ply"};
constexpr Extensions kStl = {".stl"};
constexpr Extensions kObj = {".obj"};
constexpr Extensions kOff = {".off"};
constexpr Extensions kGifti = {".gii"};
constexpr Extensions kOpenMeeg = {".tri"};
constexpr Extensions kFreeSurfer = {".surf",    ".pial",  ".white",    ".inflated",     ".orig",
                                    ".sphere",  ".reg",   ".smoothwm", ".midthickness", ".graymid",
                                    ".qsphere", ".nofix", ".seghead"};

constexpr std::int64_t kInt32 = std::numeric_limits<std::int32_t>::max();
constexpr std::int64_t kInt64 = std::numeric_limits<std::int64_t>::max();

constexpr auto F64 = CoordinatePrecision::Float64;
constexpr auto F32 = CoordinatePrecision::Float32;
constexpr auto Text = CoordinatePrecision::NineDigits;
constexpr bool yes = true, no = false;

// clang-format off
constexpr std::array<MeshFormat, 9> kFormats{{
    //                         name                extensions   digits normals frame voxel geometry arrays colors vertices most
    {MeshFormatId::VtkXml,     "VTK XML PolyData", kVtkXml,     F64,   yes,    yes,  yes,  no,      yes,    yes,    yes,      kInt64},
    {MeshFormatId::VtkLegacy,  "VTK legacy",       kVtkLegacy,  F64,   yes,    yes,  yes,  no,      yes,    yes,    yes,      kInt64},
    {MeshFormatId::Ply,        "PLY (binary)",     kPly,        F64,   yes,    yes,  yes,  no,      yes,    yes,    yes,      kInt32},
    {MeshFormatId::Stl,        "STL (binary)",     kStl,        F32,   no,     yes,  yes,  no,      no,     no,     no,       kInt32},
    {MeshFormatId::Obj,        "Wavefront OBJ",    kObj,        Text,  yes,    yes,  yes,  no,      no,     yes,    yes,      kInt64},
    {MeshFormatId::Off,        "OFF",              kOff,        Text,  no,     yes,  yes,  no,      no,     yes,    yes,      kInt64},
    {MeshFormatId::Gifti,      "GIFTI",            kGifti,      F32,   no,     yes,  yes,  yes,     no,     no,     yes,      kInt32},
    {MeshFormatId::FreeSurfer, "FreeSurfer",       kFreeSurfer, F32,   no,     yes,  no,   yes,     no,     no,     yes,      kInt32},
    {MeshFormatId::OpenMeeg,   "OpenMEEG",         kOpenMeeg,   Text,  yes,    no,   yes,  no,      no,     no,     yes,      kInt32},
}};
// clang-format on

std::string listOfExtensions() {
    std::string list;
    for (const MeshFormat& format : kFormats) {
        for (const std::string_view extension : format.extensions) {
            list.append(list.empty() ? "" : " ").append(extension);
        }
    }
    return list;
}

}  // namespace

std::span<const MeshFormat> meshFormats() {
    return kFormats;
}

const MeshFormat& findMeshFormat(const std::filesystem::path& path) {
    const std::string extension = lowerCase(path.extension().string());
    for (const MeshFormat& format : kFormats) {
        if (std::ranges::find(format.extensions, extension) != format.extensions.end()) {
            return format;
        }
    }
    throw InvalidInput(path.string() + ": no surface format has the extension '" + extension +
                       "', must be one of " + listOfExtensions());
}

CoordinateFrame defaultFrame(const MeshFormat& format) {
    return format.id == MeshFormatId::FreeSurfer ? CoordinateFrame::TkRas : CoordinateFrame::Ras;
}

}  // namespace adaptiso

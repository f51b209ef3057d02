#include "adaptiso/MeshIO/Formats.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

#include "Bytes.h"
#include "Codecs.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ForeignContent.h"
#include "adaptiso/Core/TextLines.h"
#include "adaptiso/MeshIO/Xml.h"

namespace adaptiso {
namespace meshio {

// each at the end of its own .cxx
extern const Codec kVtkXmlCodec, kVtkLegacyCodec, kPlyCodec, kStlCodec, kObjCodec, kOffCodec,
    kGiftiCodec, kFreeSurferCodec, kOpenMeegCodec, kGlbCodec, k3mfCodec, kFiffCodec;

}  // namespace meshio

namespace {

using Extensions = std::string_view[];
constexpr Extensions kVtkXml = {".vtp"};
constexpr Extensions kVtkLegacy = {".vtk"};
constexpr Extensions kPly = {".ply"};
constexpr Extensions kStl = {".stl"};
constexpr Extensions kObj = {".obj"};
constexpr Extensions kOff = {".off"};
constexpr Extensions kGifti = {".gii"};
constexpr Extensions kFreeSurfer = {".surf",    ".pial",  ".white",    ".inflated",     ".orig",
                                    ".sphere",  ".reg",   ".smoothwm", ".midthickness", ".graymid",
                                    ".qsphere", ".nofix", ".seghead"};
constexpr Extensions kOpenMeeg = {".tri"};
constexpr Extensions kGlb = {".glb"};
constexpr Extensions k3mf = {".3mf"};
constexpr Extensions kFiff = {".fif"};

constexpr std::int64_t kInt32 = std::numeric_limits<std::int32_t>::max();
constexpr std::int64_t kInt64 = std::numeric_limits<std::int64_t>::max();

constexpr auto F64 = CoordinatePrecision::Float64;
constexpr auto F32 = CoordinatePrecision::Float32;
constexpr auto Text = CoordinatePrecision::NineDigits;
constexpr auto Ras = CoordinateFrame::Ras, TkRas = CoordinateFrame::TkRas;
constexpr bool yes = true, no = false;

// clang-format off
constexpr MeshFormat kFormats[] = {
    // name              extensions   codec                   digits used in normals frame voxel geometry arrays colors cells vertices most
    {"VTK XML PolyData", kVtkXml,     &meshio::kVtkXmlCodec,     F64,  Ras,   yes,    yes,  yes,  no,      yes,    yes,   yes,  yes,      kInt64},
    {"VTK legacy",       kVtkLegacy,  &meshio::kVtkLegacyCodec,  F64,  Ras,   yes,    yes,  yes,  no,      yes,    yes,   no,   yes,      kInt64},
    {"PLY",              kPly,        &meshio::kPlyCodec,        F64,  Ras,   yes,    yes,  yes,  no,      yes,    yes,   no,   yes,      kInt32},
    {"STL",              kStl,        &meshio::kStlCodec,        F32,  Ras,   no,     yes,  yes,  no,      no,     no,    no,   no,       kInt32},
    {"Wavefront OBJ",    kObj,        &meshio::kObjCodec,        Text, Ras,   yes,    yes,  yes,  no,      no,     yes,   no,   yes,      kInt64},
    {"OFF",              kOff,        &meshio::kOffCodec,        Text, Ras,   no,     yes,  yes,  no,      no,     yes,   no,   yes,      kInt64},
    {"GIFTI",            kGifti,      &meshio::kGiftiCodec,      F32,  Ras,   no,     yes,  yes,  yes,     no,     no,    no,   yes,      kInt32},
    {"FreeSurfer",       kFreeSurfer, &meshio::kFreeSurferCodec, F32,  TkRas, no,     yes,  no,   yes,     no,     no,    no,   yes,      kInt32},
    {"OpenMEEG",         kOpenMeeg,   &meshio::kOpenMeegCodec,   Text, Ras,   yes,    no,   yes,  no,      no,     no,    no,   yes,      kInt32},
    {"GLB (glTF 2.0)",   kGlb,        &meshio::kGlbCodec,        F32,  Ras,   yes,    yes,  no,   no,      no,     yes,   no,   yes,      kInt32},
    {"3MF",              k3mf,        &meshio::k3mfCodec,        Text, Ras,   no,     yes,  no,   no,      no,     no,    no,   yes,      kInt32},
    // read alone
    {"FIFF (MNE)",       kFiff,       &meshio::kFiffCodec,       F32,  TkRas, no,     yes,  no,   no,      no,     no,    no,   yes,      kInt32},
};
// clang-format on
constexpr std::size_t kReadAlone = 1;

}  // namespace

std::span<const MeshFormat> meshFormats() {
    return std::span(kFormats).first<std::size(kFormats) - kReadAlone>();
}

std::string meshExtensions() {
    std::string list;
    for (const MeshFormat& format : meshFormats()) {
        for (const std::string_view extension : format.extensions) {
            list.append(list.empty() ? "" : " ").append(extension);
        }
    }
    return list;
}

const MeshFormat& findMeshFormat(const std::filesystem::path& path) {
    const std::string extension = lowerCase(path.extension().string());
    for (const MeshFormat& format : meshFormats()) {
        if (std::ranges::find(format.extensions, extension) != format.extensions.end()) {
            return format;
        }
    }
    throw InvalidInput(path.string() + ": no surface format has the extension '" + extension +
                       "', must be one of " + meshExtensions());
}

namespace {

using namespace std::string_view_literals;
using meshio::ByteSource, meshio::firstLine, meshio::isNumber;

struct Other {
    std::string_view begin;  ///< how the file, or its first line of text, begins
    std::string_view fault, remedy;
};

constexpr std::string_view kMeshLab = "save it as PLY or STL, e.g. with MeshLab or Blender";
constexpr std::string_view kGmsh = "save it as STL, e.g. with gmsh or meshio";
constexpr std::string_view kCad = "mesh it and save it as STL, e.g. with FreeCAD";
constexpr std::string_view kImage = "adaptiso-mesh makes surfaces of images";

constexpr Other kOthers[] = {
    {"Kaydara FBX"sv, "is an FBX scene", kMeshLab},
    {"BLENDER"sv, "is a Blender scene", kMeshLab},
    {"DRACO"sv, "is a mesh packed with Draco", kMeshLab},
    {"OCTM"sv, "is an OpenCTM mesh", kMeshLab},
    {"#VRML"sv, "is a VRML scene", kMeshLab},
    {"#Inventor"sv, "is an Open Inventor scene", kMeshLab},
    {"#usda"sv, "is a USD scene", kMeshLab},
    {"PXR-USDC"sv, "is a USD scene", kMeshLab},
    {"3D Geometry File Format"sv, "is a Rhino model", kCad},
    {"ISO-10303-21"sv, "is a STEP model", kCad},
    {"AutoCAD Binary DXF"sv, "is a DXF drawing", kCad},
    {"$MeshFormat"sv, "is a gmsh mesh", kGmsh},
    {"MeshVersionFormatted"sv, "is a Medit mesh", kGmsh},
    {"ascii"sv, "is a BrainVISA mesh", "convert it to GIFTI with AimsFileConvert"},
    {"binarABCD"sv, "is a BrainVISA mesh", "convert it to GIFTI with AimsFileConvert"},
    {"binarDCBA"sv, "is a BrainVISA mesh", "convert it to GIFTI with AimsFileConvert"},
    {"DFS_LE"sv, "is a BrainSuite surface", "save it as PLY or OBJ with BrainSuite"},
    {"DFS_BE"sv, "is a BrainSuite surface", "save it as PLY or OBJ with BrainSuite"},
    {"DUFF"sv, "is a BrainSuite surface", "save it as PLY or OBJ with BrainSuite"},
    {"POINT_DESCRIPTION START_LIST"sv, "is a Curry surface", "export it from Curry as STL"},
    {"BeginHeader"sv, "is a Caret file", "convert it: caret_command -file-convert"},
    {"NRRD0"sv, "this is an image, not a surface", kImage},
    {"ObjectType"sv, "this is an image, not a surface", kImage},
    {"NDims"sv, "this is an image, not a surface", kImage},
};

bool isNifti(std::string_view head) {
    const auto has = [&](std::size_t at, std::string_view magic) {
        return head.size() >= at + 4 && head.substr(at, 4) == magic;
    };
    return has(344, "n+1\0"sv) || has(344, "ni1\0"sv) || has(4, "n+2\0"sv) || has(4, "ni2\0"sv) ||
           head.starts_with("\x5C\x01\0\0"sv) || head.starts_with("\0\0\x01\x5C"sv);  // Analyze
}

bool isDicom(std::string_view head) {
    return head.size() >= 132 && head.substr(128, 4) == "DICM";
}

/// FreeSurfer's volumes: version 1, sizes that may be.
bool isMgh(std::string_view head) {
    if (!head.starts_with("\0\0\0\1"sv) || head.size() < 284) return false;
    const auto type = meshio::loadAs<std::int32_t>(head.data() + 20, std::endian::big);
    return type >= 0 && type <= 10 &&
           meshio::loadAs<std::int32_t>(head.data() + 4, std::endian::big) > 0;
}

/// "P 0.3 0.3 0.4 10 1 40962": the surface's properties and its number of points.
bool isMniObj(std::string_view head) {
    ByteSource line(firstLine(head));
    if (line.word() != "P") return false;
    for (int n = 0; n < 6; ++n) {
        if (!isNumber(line.word())) return false;
    }
    return true;
}

std::optional<Other> otherSurface(std::string_view head, std::uint64_t byteCount) {
    if (isDicom(head) || isNifti(head) || isMgh(head)) {
        return Other{{}, "this is an image, not a surface", kImage};
    }
    if (meshio::isCurv(head, byteCount)) {
        return Other{{},
                     "holds FreeSurfer's values at points (curv), no surface",
                     "give the surface they belong to"};
    }
    if (isMniObj(head)) {
        return Other{{},
                     "is a surface of MNI (BIC .obj, as CIVET writes)",
                     "convert it to Wavefront OBJ: obj_mni2wf (pip install pybicpl)"};
    }
    if (head.starts_with("#!ascii"sv)) {
        return Other{{}, "is FreeSurfer's text (.asc)", "convert it with mris_convert"};
    }
    const std::string_view root = meshio::xmlRoot(head);
    for (const std::string_view scene : {"COLLADA"sv, "X3D"sv, "amf"sv, "AMF"sv}) {
        if (root == scene) return Other{{}, "is an XML scene of another format", kMeshLab};
    }
    const std::string_view line = firstLine(head);
    for (const Other& other : kOthers) {
        if (head.starts_with(other.begin) || line.starts_with(other.begin)) return other;
    }
    return {};
}

}  // namespace

const MeshFormat* recognizeMeshFormat(std::string_view head, std::uint64_t byteCount) {
    if (isDicom(head)) return nullptr;
    const std::string_view text = withoutByteOrderMark(head);
    for (const bool isText : {false, true}) {
        for (const MeshFormat& format : kFormats) {
            if (format.codec->isText == isText &&
                format.codec->recognizes(isText ? text : head, byteCount)) {
                return &format;
            }
        }
    }
    return nullptr;
}

namespace meshio {

bool isNumber(std::string_view word) {
    return !word.empty() && word.find_first_not_of("0123456789+-.eEdD,") == std::string_view::npos;
}

std::string_view firstLine(std::string_view text) {
    ByteSource source(text);
    while (!source.atEnd()) {
        const std::string_view line = trimmed(source.line());
        if (!line.empty() && !line.starts_with('#')) return line;
    }
    return {};
}

void refuseOtherContent(std::string_view head, std::uint64_t byteCount,
                        const std::filesystem::path& path, bool isInflated) {
    const auto foreign = isDicom(head) ? std::nullopt : foreignContentOf(head, path, isInflated);
    if (foreign) unsupported(foreign->fault, foreign->remedy);
    if (const auto other = otherSurface(head, byteCount)) {
        unsupported(std::string(other->fault), std::string(other->remedy));
    }
}

}  // namespace meshio

}  // namespace adaptiso

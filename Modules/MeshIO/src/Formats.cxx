#include "adaptiso/MeshIO/Formats.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>

#include "Bytes.h"
#include "Codecs.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ForeignContent.h"
#include "adaptiso/Core/TextLines.h"

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

namespace {

using namespace std::string_view_literals;
using meshio::ByteSource;

bool isNumber(std::string_view word) {
    return !word.empty() && word.find_first_not_of("0123456789+-.eEdD,") == std::string_view::npos;
}

/// The name of the outermost element; empty if the text is not XML.
std::string_view xmlRoot(std::string_view text) {
    text = trimmed(text);
    while (text.starts_with("<?") || text.starts_with("<!")) {
        const bool isComment = text.starts_with("<!--");
        const std::string_view end = text.starts_with("<?") ? "?>"sv : isComment ? "-->"sv : ">"sv;
        const std::size_t at = text.find(end);
        if (at == std::string_view::npos) return {};
        text = trimmed(text.substr(at + end.size()));
    }
    if (!text.starts_with('<')) return {};
    text.remove_prefix(1);
    return text.substr(0, text.find_first_of(" \t\r\n/>"));
}

/// The first line that is neither empty nor a comment.
std::string_view firstLine(std::string_view text) {
    ByteSource source(text);
    while (!source.atEnd()) {
        const std::string_view line = trimmed(source.line());
        if (!line.empty() && !line.starts_with('#')) return line;
    }
    return {};
}

/// FF FF FF begins both FreeSurfer's surfaces of quadrangles and its values at points (curv).
bool isCurv(std::string_view head, std::uint64_t byteCount) {
    constexpr std::uint64_t kHeaderBytes = 15;
    if (!head.starts_with("\xFF\xFF\xFF") || head.size() < kHeaderBytes) return false;
    const auto points = meshio::loadAs<std::uint32_t>(head.data() + 3, std::endian::big);
    const auto columns = meshio::loadAs<std::uint32_t>(head.data() + 11, std::endian::big);
    return columns == 1 && byteCount == kHeaderBytes + 4 * std::uint64_t{points};
}

bool isFreeSurfer(std::string_view head, std::uint64_t byteCount) {
    return head.starts_with("\xFF\xFF\xFE") || head.starts_with("\xFF\xFF\xFD") ||
           (head.starts_with("\xFF\xFF\xFF") && !isCurv(head, byteCount));
}

bool isOff(std::string_view head) {
    const std::string_view line = firstLine(head);
    const std::string_view word = line.substr(0, line.find_first_of(" \t"));
    return word.ends_with("OFF") && word.find_first_not_of("STCN4nOF") == std::string_view::npos;
}

bool isStl(std::string_view head, std::uint64_t byteCount) {
    constexpr std::uint64_t kHeaderBytes = 84, kTriangleBytes = 50;
    if (head.size() >= kHeaderBytes) {
        const auto count = meshio::loadAs<std::uint32_t>(head.data() + 80, std::endian::little);
        if (count > 0 && byteCount == kHeaderBytes + kTriangleBytes * count) return true;
    }
    const std::string text = lowerCase(trimmed(withoutByteOrderMark(head)));
    return text.starts_with("solid") && text.find("facet") != std::string::npos &&
           text.find('\0') == std::string::npos;
}

bool isOpenMeeg(std::string_view head) {
    ByteSource source(head);
    const bool hasDash = source.word() == "-";
    const std::string_view count = source.word();
    return hasDash && !count.empty() &&
           count.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Lines of Wavefront's keywords up to a point.
bool isObj(std::string_view head) {
    constexpr std::array kOthers{"mtllib"sv, "usemtl"sv, "o"sv,  "g"sv,
                                 "s"sv,      "vt"sv,     "vn"sv, "vp"sv};
    ByteSource source(head);
    while (!source.atEnd()) {
        ByteSource line(source.line());
        const std::string_view word = line.word();
        if (word.empty() || word.starts_with('#') || std::ranges::count(kOthers, word)) continue;
        return word == "v" && isNumber(line.word()) && isNumber(line.word()) &&
               isNumber(line.word());
    }
    return false;
}

struct Other {
    std::string_view begin;  ///< how the file, or its first line of text, begins
    std::string_view fault, remedy;
};

constexpr std::string_view kMeshLab = "save it as PLY or STL, e.g. with MeshLab or Blender";
constexpr std::string_view kGmsh = "save it as STL, e.g. with gmsh or meshio";
constexpr std::string_view kCad = "mesh it and save it as STL, e.g. with FreeCAD";
constexpr std::string_view kImage = "adaptiso-mesh makes surfaces of images";

constexpr Other kOthers[] = {
    {"glTF"sv, "is a glTF scene", kMeshLab},
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
    if (isCurv(head, byteCount)) {
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
    const std::string_view root = xmlRoot(head);
    for (const std::string_view scene : {"COLLADA"sv, "X3D"sv, "amf"sv, "AMF"sv}) {
        if (root == scene) return Other{{}, "is an XML scene of another format", kMeshLab};
    }
    const std::string_view line = firstLine(head);
    for (const Other& other : kOthers) {
        if (head.starts_with(other.begin) || line.starts_with(other.begin)) return other;
    }
    return {};
}

const MeshFormat* formatOf(MeshFormatId id) {
    const auto formats = meshFormats();
    return &*std::ranges::find(formats, id, &MeshFormat::id);
}

}  // namespace

const MeshFormat* recognizeMeshFormat(std::string_view head, std::uint64_t byteCount) {
    if (isFreeSurfer(head, byteCount)) return formatOf(MeshFormatId::FreeSurfer);
    if (isDicom(head)) return nullptr;
    if (isStl(head, byteCount)) return formatOf(MeshFormatId::Stl);
    head = withoutByteOrderMark(head);
    const std::string_view text = trimmed(head);
    if (text.starts_with("# vtk DataFile")) return formatOf(MeshFormatId::VtkLegacy);
    if (lowerCase(text.substr(0, text.find_first_of(" \t\r\n"))) == "ply") {
        return formatOf(MeshFormatId::Ply);
    }
    const std::string_view root = xmlRoot(head);
    if (root == "VTKFile") return formatOf(MeshFormatId::VtkXml);
    if (root == "GIFTI") return formatOf(MeshFormatId::Gifti);
    if (isOff(head)) return formatOf(MeshFormatId::Off);
    if (isOpenMeeg(head)) return formatOf(MeshFormatId::OpenMeeg);
    if (isObj(head)) return formatOf(MeshFormatId::Obj);
    return nullptr;
}

namespace meshio {

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

#include "adaptiso/Core/ForeignContent.h"

#include <algorithm>
#include <fstream>
#include <system_error>

#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextLines.h"

namespace adaptiso {
namespace fs = std::filesystem;

namespace {

using namespace std::string_view_literals;

struct Magic {
    std::size_t offset;
    std::string_view bytes;
    ForeignKind kind;
    std::string_view fault, remedy;  ///< FILE in the remedy becomes the file's name
};

constexpr auto Packed = ForeignKind::Packed;
constexpr auto Other = ForeignKind::Other;
constexpr auto StandIn = ForeignKind::StandIn;

constexpr std::string_view kPicture =
    "convert pictures to NRRD or NIfTI with their voxel size (3D Slicer, Fiji)";
constexpr std::string_view kShortcut = "give the file that it leads to";
constexpr std::string_view kDownload = "download the file again, logged in where it needs that";
constexpr std::string_view kAnnex =
    "fetch them: git annex get FILE, or datalad get FILE, in their folder";

// clang-format off
constexpr Magic kMagics[] = {
    {0, "BZh"sv,                            Packed,  "is packed with bzip2",        "unpack it: bunzip2 -k FILE"},
    {0, "\xFD" "7zXZ\0"sv,                  Packed,  "is packed with xz",           "unpack it: unxz -k FILE"},
    {0, "\x28\xB5\x2F\xFD"sv,               Packed,  "is packed with Zstandard",    "unpack it: unzstd FILE"},
    {0, "\x04\x22\x4D\x18"sv,               Packed,  "is packed with LZ4",          "unpack it: unlz4 FILE"},
    {0, "LZIP\x01"sv,                       Packed,  "is packed with lzip",         "unpack it: lzip -dk FILE"},
    {0, "\x5D\0\0\x80\0"sv,                 Packed,  "is packed with LZMA",         "unpack it: unlzma -k FILE"},
    {0, "\x1F\x9D"sv,                       Packed,  "is packed with compress",     "unpack it: gunzip -k FILE"},
    {0, "PK\x03\x04"sv,                     Packed,  "is a zip archive",            "unpack it: unzip FILE"},
    {0, "PK\x05\x06"sv,                     StandIn, "is an empty zip archive",     "get the file again"},
    {0, "PK\x07\x08"sv,                     Packed,  "is a part of a zip archive",  "unpack it with its other parts: 7z x FILE"},
    {0, "7z\xBC\xAF\x27\x1C"sv,             Packed,  "is a 7z archive",             "unpack it: 7z x FILE"},
    {0, "Rar!\x1A\x07"sv,                   Packed,  "is a rar archive",            "unpack it: unrar x FILE"},
    {257, "ustar"sv,                        Packed,  "is a tar archive",            "unpack it: tar -xf FILE"},
    {0, "version https://git-lfs"sv,        StandIn, "is a git-lfs pointer",        "fetch them: git lfs pull, in their repository"},
    {0, "version https://hawser"sv,         StandIn, "is a git-lfs pointer",        "fetch them: git lfs pull, in their repository"},
    {0, "outs:\n- md5:"sv,                  StandIn, "is a DVC pointer, the data are not here", "fetch them: dvc pull FILE"},
    {0, "[InternetShortcut]"sv,             StandIn, "is a link of Windows to a web page", kShortcut},
    {0, "[Desktop Entry]"sv,                StandIn, "is a shortcut",               kShortcut},
    {0, "L\0\0\0\x01\x14\x02\0"sv,          StandIn, "is a shortcut of Windows",    kShortcut},
    {0, "book\0\0\0\0mark"sv,               StandIn, "is an alias of macOS",        kShortcut},
    {0, "\0\x05\x16\x07"sv,                 StandIn, "holds what macOS notes of another file, not data", "give the file without '._' before its name"},
    {0, "bplist00"sv,                       StandIn, "is a property list of macOS, perhaps a placeholder of iCloud", "download the file in Finder"},
    {0, "\x89PNG\r\n"sv,                    Other,   "is a PNG picture",            kPicture},
    {0, "\xFF\xD8\xFF"sv,                   Other,   "is a JPEG picture",           kPicture},
    {0, "\0\0\0\x0CjP  "sv,                 Other,   "is a JPEG 2000 picture",      kPicture},
    {0, "GIF8"sv,                           Other,   "is a GIF picture",            kPicture},
    {0, "II*\0"sv,                          Other,   "is a TIFF picture",           kPicture},
    {0, "MM\0*"sv,                          Other,   "is a TIFF picture",           kPicture},
    {0, "II+\0"sv,                          Other,   "is a BigTIFF picture",        kPicture},
    {8, "WEBPVP8"sv,                        Other,   "is a WebP picture",           kPicture},
    {0, "%PDF-"sv,                          Other,   "is a PDF document",           "give the data"},
    {0, "{\\rtf"sv,                         Other,   "is an RTF document",          "give the data"},
    {0, "\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"sv, Other, "is a document of Microsoft Office", "give the data"},
    {0, "MATLAB 5.0 MAT-file"sv,            Other,   "is a MATLAB file",            "save the volume with niftiwrite, a surface with stlwrite"},
    {0, "\x93NUMPY"sv,                      Other,   "is a NumPy array",            "save the volume with nibabel, a surface with trimesh"},
    {0, "CDF\x01"sv,                        Other,   "is netCDF, as MINC 1 is",     "convert MINC with mnc2nii FILE"},
    {0, "CDF\x02"sv,                        Other,   "is netCDF, as MINC 1 is",     "convert MINC with mnc2nii FILE"},
    {0, "\x89HDF\r\n\x1A\n"sv,              Other,   "is HDF5, as MINC 2 and MATLAB 7.3 files are", "convert MINC with mnc2nii FILE, save others as NIfTI"},
    {0, "MATRIX7"sv,                        Other,   "is an ECAT 7 image",          "convert it with ecat2nii or medcon"},
    {0, "!INTERFILE"sv,                     Other,   "is an Interfile header",      "convert it: medcon -c nifti -f FILE"},
    {0, "# === DATA DESCRIPTION FILE"sv,    Other,   "is a PAR header of Philips",  "convert it: dcm2niix FILE"},
};
// clang-format on

/// FILE as a shell takes it.
std::string withName(std::string_view remedy, const fs::path& file) {
    std::string text(remedy);
    const std::string name = file.filename().string();
    const bool isPlain = std::ranges::all_of(name, [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
               "._-+=,@%"sv.find(c) != std::string_view::npos;
    });
    if (!isPlain || name.starts_with('-')) return text;
    for (std::size_t at = text.find("FILE"); at != std::string::npos; at = text.find("FILE", at)) {
        text.replace(at, 4, name);
        at += name.size();
    }
    return text;
}

/// The whole number behind `key` in a pointer's lines; empty if missing.
std::string digitsBehind(std::string_view text, std::string_view key) {
    const std::size_t place = text.find(key);
    if (place == std::string_view::npos) return {};
    text.remove_prefix(place + key.size());
    return std::string(text.substr(0, text.find_first_not_of("0123456789")));
}

std::string notHere(const std::string& byteCount) {
    return byteCount.empty() ? ", the data are not here"
                             : ", its " + byteCount + " bytes of data are not here";
}

/// "/annex/objects/SHA256E-s1234--..." of an unlocked file, or the path of a locked one's link.
bool namesAnnexObject(std::string_view text) {
    text = text.substr(0, text.find('\n'));
    return text.find("annex/objects/") != std::string_view::npos &&
           (text.starts_with("/annex/") || text.find(".git/") != std::string_view::npos) &&
           text.find_first_of("<>{}\"'=") == std::string_view::npos &&
           text.find('\0') == std::string_view::npos;
}

ForeignContent annexed(std::string_view key, const fs::path& file) {
    const std::string what = "is a git-annex pointer" + notHere(digitsBehind(key, "-s"));
    return {StandIn, what, withName(kAnnex, file)};
}

bool isText(std::string_view head) {
    return std::ranges::none_of(head, [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return byte < 0x20 && c != '\n' && c != '\r' && c != '\t';
    });
}

/// Pages and messages of servers, saved under a data file's name.
std::optional<ForeignContent> serversAnswer(std::string_view head) {
    head = withoutByteOrderMark(head);
    const std::string text = lowerCase(trimmed(head));
    if (text.starts_with("<!doctype html") || text.starts_with("<html") ||
        (text.starts_with("<") && (text.find("<html") != std::string::npos ||
                                   text.find("<!doctype html") != std::string::npos))) {
        return ForeignContent{StandIn, "is a web page", std::string(kDownload)};
    }
    if (!isText(head)) return {};
    const bool isXmlError = text.starts_with("<") && text.find("<error>") != std::string::npos;
    const bool isStatus = text.starts_with("404") || text.starts_with("403") ||
                          text.starts_with("not found") || text.starts_with("access denied");
    constexpr std::size_t kLongestMessage = 200;
    if (text.find("= string-attribute") != std::string::npos ||
        text.find("= integer-attribute") != std::string::npos) {
        return ForeignContent{Other, "is an AFNI header", "convert it: 3dAFNItoNIFTI"};
    }
    if (isXmlError || (isStatus && text.size() < kLongestMessage &&
                       text.find_first_of("abcdefghijklmnopqrstuvwxyz") != std::string::npos)) {
        return ForeignContent{StandIn, "is an error message of a server", std::string(kDownload)};
    }
    if (text.starts_with("{\"") || text.starts_with("{\n") || text.starts_with("{ ") ||
        text.starts_with("{\r")) {
        return ForeignContent{
            Other, "is JSON text: perhaps an error message of a server or a sidecar of the data",
            "give the data file"};
    }
    return {};
}

/// A link of git where links can't be made: its target's path alone.
bool isLinkText(std::string_view head) {
    return head.size() < kForeignHeadBytes && head.starts_with("../") && isText(head) &&
           head.find_first_of(" \t\r\n") == std::string_view::npos;
}

/// Placeholders that only their names tell: ".scan.dcm.icloud", "scan.nii.gz.nextcloud".
std::optional<ForeignContent> placeholder(const fs::path& file) {
    const std::string ending = lowerCase(file.extension().string());
    const bool isHidden = file.filename().string().starts_with('.');
    if (ending == ".icloud" && isHidden) {
        return ForeignContent{StandIn, "is a placeholder of iCloud, the data are not here",
                              "download the file in Finder, or with brctl download"};
    }
    if (ending == ".nextcloud" || ending == ".owncloud") {
        return ForeignContent{StandIn, "is a placeholder of a cloud folder, the data are not here",
                              "make it available locally in the folder's program"};
    }
    return {};
}

/// NIfTI-2 with one of CIFTI's intents, 3000 to 3099, in either byte order.
bool isCifti(std::string_view head) {
    constexpr std::size_t kIntent = 504;
    if (head.size() < kIntent + 4 || head.substr(4, 3) != "n+2") return false;
    const auto byte = [&](std::size_t n) { return static_cast<unsigned char>(head[kIntent + n]); };
    const int little = byte(0) | byte(1) << 8, big = byte(3) | byte(2) << 8;
    return (little >= 3000 && little < 3100) || (big >= 3000 && big < 3100);
}

bool isZeros(std::string_view bytes) {
    return bytes.find_first_not_of('\0') == std::string_view::npos;
}

ForeignContent zeros() {
    return {StandIn, "holds zeros alone: its copy or download broke off", "get the file again"};
}

bool isWholeFileZeros(std::ifstream& stream) {
    std::string piece(std::size_t{1} << 20, '\0');
    while (stream.read(piece.data(), std::ssize(piece)), stream.gcount() > 0) {
        if (!isZeros(std::string_view(piece).substr(0, stream.gcount()))) return false;
    }
    return true;
}

}  // namespace

std::optional<ForeignContent> foreignContentOf(std::string_view head, const fs::path& file,
                                               bool isInflated) {
    head = head.substr(0, kForeignHeadBytes);
    const auto found = [&]() -> std::optional<ForeignContent> {
        if (head.empty()) return ForeignContent{StandIn, "is an empty file", "get the file again"};
        if (head.size() < kForeignHeadBytes && isZeros(head)) return zeros();
        if (head.starts_with("\x1F\x8B")) {
            return ForeignContent{Packed, "is packed with gzip", "unpack it: gunzip -k FILE"};
        }
        for (const Magic& magic : kMagics) {
            if (head.size() < magic.offset || !head.substr(magic.offset).starts_with(magic.bytes))
                continue;
            ForeignContent content{magic.kind, std::string(magic.fault), std::string(magic.remedy)};
            if (content.fault.ends_with("git-lfs pointer"))
                content.fault += notHere(digitsBehind(head, "\nsize "));
            return content;
        }
        if (isUtf16(head)) return ForeignContent{Other, "is text in UTF-16", "save it as UTF-8"};
        if (isCifti(head)) {
            return ForeignContent{
                Other, "is CIFTI: values at points of surfaces, no volume and no surface",
                "take volumes and values out of it with wb_command -cifti-separate"};
        }
        if (namesAnnexObject(head)) return annexed(head, file);
        if (isLinkText(head)) {
            return ForeignContent{
                StandIn, "is a link that git checked out as text: it holds the path of a file",
                "give the file that it leads to"};
        }
        return serversAnswer(head);
    }();
    if (!found) return found;
    if (!isInflated)
        return ForeignContent{found->kind, found->fault, withName(found->remedy, file)};
    if (found->fault == "is a tar archive") {
        return ForeignContent{Packed, "is a tar archive packed with gzip",
                              withName("unpack it: tar -xzf FILE", file)};
    }
    return ForeignContent{found->kind, "is packed with gzip, and what is inside " + found->fault,
                          withName(found->remedy, file.stem())};
}

std::optional<ForeignContent> findForeignContent(const fs::path& file) {
    std::error_code error;
    if (const auto content = placeholder(file)) return content;
    const fs::file_status status = fs::status(file, error);
    if (status.type() == fs::file_type::not_found) {
        const fs::path target = fs::read_symlink(file, error);
        if (!error && namesAnnexObject(target.string())) return annexed(target.string(), file);
        return {};
    }
    if (!fs::is_regular_file(status)) return {};
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return {};
    std::string head(kForeignHeadBytes, '\0');
    stream.read(head.data(), std::ssize(head));
    if (stream.bad()) return {};
    head.resize(static_cast<std::size_t>(stream.gcount()));
    if (isZeros(head) && !head.empty()) {
        if (isWholeFileZeros(stream)) return zeros();
        return {};
    }
    if (head.starts_with("\x1F\x8B")) return {};
    return foreignContentOf(head, file);
}

}  // namespace adaptiso

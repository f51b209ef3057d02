#include "Common/CommonFrame.h"

#include <algorithm>
#include <string_view>

#include "Common/Naming.h"
#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Json/Json.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso {
namespace {

const std::vector<std::string> kFrameWords{"ras", "lps", "tkras", "voxel"};
constexpr CoordinateFrame kFrames[] = {CoordinateFrame::Ras, CoordinateFrame::Lps,
                                       CoordinateFrame::TkRas, CoordinateFrame::Voxel};

bool lacksVolume(const NamedMesh& mesh) {
    return mesh.file.frame && needsVolume(*mesh.file.frame) && !mesh.file.volume;
}

std::string nameOf(const NamedMesh& mesh) {
    return mesh.path.filename().string();
}

/// "a.stl and b.stl", "a.stl, b.stl and c.stl"
std::string namesOf(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t n = 0; n < names.size(); ++n) {
        text += (n == 0 ? "" : n + 1 == names.size() ? " and " : ", ") + names[n];
    }
    return text;
}

std::string namesOf(std::span<const NamedMesh> meshes) {
    std::vector<std::string> names;
    for (const NamedMesh& mesh : meshes) names.push_back(nameOf(mesh));
    return namesOf(names);
}

std::string frameText(const NamedMesh& mesh) {
    return nameOf(mesh) + " is in " + std::string(toString(*mesh.file.frame));
}

/// Advice to state the frames of `meshes`: once for all if every frame is unknown, else for each.
std::string adviceFor(std::span<const NamedMesh> meshes, bool areAllUnknown) {
    if (areAllUnknown) return kStateIt;
    std::string text = "; state both by";
    if (meshes.size() > 2) text = "; state all by";
    for (const NamedMesh& mesh : meshes) {
        text += " --input-coordinates ";
        text += mesh.file.frame ? frameWord(*mesh.file.frame) : "FRAME";
    }
    return text + ", FRAME being ras, lps, tkras or voxel";
}

/// Frames that no file says: taken for one where nothing but how the surfaces lie to each other
/// depends on it, else refused.
void placeUnknownFrames(std::span<NamedMesh> meshes, bool isInImage, CommonFrame& common) {
    std::vector<std::string> unknown;
    const NamedMesh* known = nullptr;
    for (const NamedMesh& mesh : meshes) {
        if (mesh.file.frame) {
            known = &mesh;
        } else {
            unknown.push_back(nameOf(mesh));
        }
    }
    if (unknown.empty()) return;
    const bool isOne = unknown.size() == 1;
    const std::string what =
        namesOf(unknown) + (isOne ? " does not say its" : " don't say their") + " coordinate frame";
    const auto refuse = [&](const std::string& why) {
        throw InvalidInput(what + ", " + why + adviceFor(meshes, known == nullptr));
    };
    if (isInImage) refuse("so where it lies in the image is not known");
    if (known != nullptr) refuse("and " + frameText(*known));
    const bool areAlike = std::all_of(meshes.begin(), meshes.end(), [&](const NamedMesh& mesh) {
        return areOfOneFormat(mesh, meshes[0]);
    });
    if (!areAlike) refuse("and files of different formats may differ in it");
    for (NamedMesh& mesh : meshes) mesh.file.frame = CoordinateFrame::Ras;
    common.isKnown = false;
    common.warnings.push_back(
        isOne ? Warning{"guessed-frame", "does not say its coordinate frame", unknown[0]}
              : Warning{"guessed-frame", what + "; taken for one and the same"});
}

void requireNoLooseVoxels(const NamedMesh& mesh, const std::string& remedy) {
    if (mesh.file.frame == CoordinateFrame::Voxel && lacksVolume(mesh)) {
        throw InvalidInput(frameText(mesh) + ", which says nothing of mm; " + remedy);
    }
}

/// tkRAS whose volume is not known.
void placeLooseTkRas(std::span<NamedMesh> meshes, const std::string& remedy, CommonFrame& common) {
    const auto loose = std::find_if(meshes.begin(), meshes.end(), lacksVolume);
    if (loose == meshes.end()) return;
    const auto stranger = std::find_if(meshes.begin(), meshes.end(), [](const NamedMesh& m) {
        return m.file.frame != CoordinateFrame::TkRas;
    });
    if (stranger != meshes.end()) {
        const NamedMesh &first = *std::min(loose, stranger), &second = *std::max(loose, stranger);
        throw InvalidInput(frameText(first) + " and " + frameText(second) +
                           ", and the files don't say how the two relate; " + remedy);
    }
    const auto placed = std::find_if_not(meshes.begin(), meshes.end(), lacksVolume);
    const ImageGeometry volume = placed == meshes.end() ? standInVolume() : *placed->file.volume;
    if (placed == meshes.end()) {
        common.frame = CoordinateFrame::TkRas;
        common.volume = volume;
    }
    for (NamedMesh& mesh : meshes) {
        if (!mesh.file.volume) mesh.file.volume = volume;
    }
    if (meshes.size() == 1) return;
    common.warnings.push_back(
        {"guessed-frame", namesOf(meshes) + (meshes.size() == 2 ? " are both" : " are all") +
                              " in tkRAS mm; taken for surfaces of one volume"});
}

bool isNamedLikeMesh(const std::filesystem::path& path) {
    try {
        findMeshFormat(path);
    } catch (const InvalidInput&) {
        return false;
    }
    return true;
}

}  // namespace

void declareInputCoordinates(const OptionGroup& group, std::vector<CoordinateFrame>& stated,
                             const std::string& surfaces) {
    const auto take = [&stated](const std::vector<std::string>& texts) {
        for (const std::string& text : texts) {
            stated.push_back(kFrames[parseChoice("--input-coordinates", text, kFrameWords)]);
        }
    };
    group.values("--input-coordinates", choiceName(kFrameWords), take,
                 "The frame of " + surfaces +
                     ", overriding the file's own: scanner RAS mm, scanner LPS mm, "
                     "FreeSurfer's surface RAS mm, or voxel indices (default: as the file says)");
}

void declareCoordinates(const OptionGroup& group, const std::function<void(CoordinateFrame)>& take,
                        const std::string& help, const std::vector<std::string>& words) {
    const auto choose = [take, words](const std::string& text) {
        const std::string& word = words[parseChoice("--coordinates", text, words)];
        take(kFrames[std::ranges::find(kFrameWords, word) - kFrameWords.begin()]);
    };
    group.value("--coordinates", choiceName(words), choose, help);
}

void checkInputCoordinates(const std::vector<CoordinateFrame>& stated, std::size_t surfaces) {
    if (stated.size() <= 1 || stated.size() == surfaces) return;
    throw UsageError("--input-coordinates: is given " + std::to_string(stated.size()) +
                     " times for " + std::to_string(surfaces) +
                     (surfaces == 1 ? " surface" : " surfaces") + "; give it once" +
                     (surfaces == 1 ? "" : ", or once for each"));
}

std::optional<CoordinateFrame> statedFrame(const std::vector<CoordinateFrame>& stated,
                                           std::size_t n) {
    if (stated.empty()) return std::nullopt;
    return stated.size() == 1 ? stated.front() : stated.at(n);
}

std::string frameText(const std::optional<CoordinateFrame>& frame) {
    return frame ? std::string(toString(*frame)) : "frame not said";
}

std::string fileText(const std::filesystem::path& file, const MeshFormat& format,
                     const std::optional<CoordinateFrame>& frame) {
    return baseName(file) + " (" + std::string(format.name) + ", " + frameText(frame) + ")";
}

bool areOfOneFormat(const NamedMesh& a, const NamedMesh& b) {
    const auto isOfPrinters = [](const NamedMesh& mesh) {
        const std::string_view extension = mesh.file.format->extensions.front();
        return extension == ".stl" || extension == ".3mf";
    };
    return a.file.format == b.file.format || (isOfPrinters(a) && isOfPrinters(b));
}

CommonFrame bringToOneFrame(std::span<NamedMesh> meshes, const std::optional<ImageGeometry>& image,
                            const std::string& remedy) {
    CommonFrame common;
    placeUnknownFrames(meshes, image.has_value(), common);
    for (NamedMesh& mesh : meshes) {
        if (image && lacksVolume(mesh)) mesh.file.volume = frameVolume(*mesh.file.frame, *image);
        requireNoLooseVoxels(mesh, remedy);
    }
    placeLooseTkRas(meshes, remedy, common);
    for (NamedMesh& mesh : meshes) {
        mesh.file.mesh = fromFrame(mesh.file.mesh, *mesh.file.frame, mesh.file.volume);
    }
    return common;
}

const MeshFormat& meshFormatOf(const std::filesystem::path& file) {
    try {
        return findMeshFormat(file);
    } catch (const InvalidInput& error) {
        throw UsageError(error.what());
    }
}

CoordinateFrame outputFrame(std::optional<CoordinateFrame> wanted, const MeshFormat& format) {
    const CoordinateFrame frame = wanted.value_or(format.defaultFrame);
    if (frame == CoordinateFrame::Voxel && !format.holdsVoxelFrame) {
        throw UsageError("--coordinates voxel: " + std::string(format.name) +
                         " holds points in mm only");
    }
    return frame;
}

bool isFolder(const std::filesystem::path& path) {
    std::error_code error;
    if (path.empty() || !path.has_filename()) return !path.empty();
    return std::filesystem::is_directory(path, error) && !isNamedLikeMesh(path);
}

void requireFolderName(const std::string& option, const std::filesystem::path& folder,
                       const std::string& instead) {
    std::error_code error;
    if (folder.empty() || std::filesystem::is_directory(folder, error)) return;
    if (!isNamedLikeMesh(folder)) return;
    throw UsageError(option + " " + folder.string() + ": is a folder to make, and named like a " +
                     "file; " + instead);
}

std::string surfaceHint(const std::filesystem::path& file) {
    try {
        readMesh(file, {.keepsFaults = true});
    } catch (const Error&) {
        return "";
    }
    return "this is a surface, not an image; adaptiso-check, adaptiso-compare and "
           "adaptiso-simplify take surfaces";
}

}  // namespace adaptiso

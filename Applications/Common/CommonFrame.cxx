#include "Common/CommonFrame.h"

#include <algorithm>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/FrameTransform.h"

namespace adaptiso {
namespace {

bool lacksVolume(const NamedMesh& mesh) {
    const bool needsVolume =
        mesh.file.frame == CoordinateFrame::TkRas || mesh.file.frame == CoordinateFrame::Voxel;
    return needsVolume && !mesh.file.volume;
}

std::string nameOf(const NamedMesh& mesh) {
    return mesh.path.filename().string();
}

/// "a.stl and b.stl", "a.stl, b.stl and c.stl"
std::string namesOf(std::span<const NamedMesh> meshes) {
    std::string text;
    for (std::size_t n = 0; n < meshes.size(); ++n) {
        text += (n == 0 ? "" : n + 1 == meshes.size() ? " and " : ", ") + nameOf(meshes[n]);
    }
    return text;
}

std::string frameText(const NamedMesh& mesh) {
    return nameOf(mesh) + " is in " + std::string(toString(*mesh.file.frame));
}

/// A conformed volume around the origin: its tkRAS is scanner RAS itself.
ImageGeometry standInVolume() {
    return conformedGeometry({{256, 256, 256}, {-128, -128, -128}, {}});
}

void assumeRas(std::span<NamedMesh> meshes, CommonFrame& common) {
    for (NamedMesh& mesh : meshes) mesh.file.frame = CoordinateFrame::Ras;
    const std::size_t count = meshes.size();
    common.warnings.push_back(
        count == 1 ? Warning{"guessed-frame", "does not say its coordinate frame; taken for RAS mm",
                             nameOf(meshes[0])}
                   : Warning{"guessed-frame",
                             namesOf(meshes) + " don't say their coordinate frame; " +
                                 (count == 2 ? "both" : "all") + " are taken for RAS mm"});
}

void assumeUnknownFrames(std::span<NamedMesh> meshes, CommonFrame& common) {
    const auto known = std::find_if(meshes.begin(), meshes.end(),
                                    [](const NamedMesh& m) { return m.file.frame.has_value(); });
    if (known == meshes.end()) return assumeRas(meshes, common);
    for (NamedMesh& mesh : meshes) {
        if (mesh.file.frame) continue;
        mesh.file.frame = known->file.frame;
        mesh.file.volume = known->file.volume;
        common.warnings.push_back(
            {"guessed-frame",
             "does not say its coordinate frame; taken for that of " + frameText(*known),
             nameOf(mesh)});
    }
}

void requireNoLooseVoxels(const NamedMesh& mesh) {
    if (mesh.file.frame == CoordinateFrame::Voxel && lacksVolume(mesh)) {
        throw InvalidInput(frameText(mesh) +
                           ", which says nothing of mm; give the image by --volume");
    }
}

/// tkRAS whose volume is not known.
void placeLooseTkRas(std::span<NamedMesh> meshes, CommonFrame& common) {
    const auto loose = std::find_if(meshes.begin(), meshes.end(), lacksVolume);
    if (loose == meshes.end()) return;
    const auto stranger = std::find_if(meshes.begin(), meshes.end(), [](const NamedMesh& m) {
        return m.file.frame != CoordinateFrame::TkRas;
    });
    if (stranger != meshes.end()) {
        const NamedMesh &first = *std::min(loose, stranger), &second = *std::max(loose, stranger);
        throw InvalidInput(frameText(first) + " and " + frameText(second) +
                           ", and the files don't say how the two relate; give the image by "
                           "--volume");
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

}  // namespace

CommonFrame bringToOneFrame(std::span<NamedMesh> meshes,
                            const std::optional<ImageGeometry>& image) {
    CommonFrame common;
    assumeUnknownFrames(meshes, common);
    for (NamedMesh& mesh : meshes) {
        if (image && lacksVolume(mesh)) mesh.file.volume = frameVolume(*mesh.file.frame, *image);
        requireNoLooseVoxels(mesh);
    }
    placeLooseTkRas(meshes, common);
    for (NamedMesh& mesh : meshes) {
        mesh.file.mesh = fromFrame(mesh.file.mesh, *mesh.file.frame, mesh.file.volume);
    }
    return common;
}

}  // namespace adaptiso

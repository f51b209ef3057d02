#include "CommonFrame.h"

#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/FrameTransform.h"

namespace adaptiso {
namespace {

bool needsVolume(const MeshFile& file) {
    return file.frame == CoordinateFrame::TkRas || file.frame == CoordinateFrame::Voxel;
}

bool lacksVolume(const MeshFile& file) {
    return needsVolume(file) && !file.volume;
}

std::string nameOf(const NamedMesh& mesh) {
    return mesh.path.filename().string();
}

std::string frameText(const NamedMesh& mesh) {
    return nameOf(mesh) + " is in " + std::string(toString(*mesh.file.frame));
}

/// A conformed volume around the origin: its tkRAS is scanner RAS itself.
ImageGeometry standInVolume() {
    return conformedGeometry({{256, 256, 256}, {-128, -128, -128}, {}});
}

void takeFrameOf(const NamedMesh& known, NamedMesh& unknown, CommonFrame& common) {
    unknown.file.frame = known.file.frame;
    unknown.file.volume = known.file.volume;
    common.warnings.push_back(nameOf(unknown) +
                              " does not say its coordinate frame; taken for that of " +
                              frameText(known));
}

void assumeUnknownFrames(NamedMesh& a, NamedMesh& b, CommonFrame& common) {
    if (a.file.frame && b.file.frame) return;
    if (!a.file.frame && !b.file.frame) {
        a.file.frame = b.file.frame = CoordinateFrame::Ras;
        common.warnings.push_back(
            "neither surface says its coordinate frame; both are taken for RAS mm");
    } else if (!a.file.frame) {
        takeFrameOf(b, a, common);
    } else {
        takeFrameOf(a, b, common);
    }
}

void takeImage(MeshFile& file, const ImageGeometry& image) {
    if (!lacksVolume(file)) return;
    file.volume = frameVolume(*file.frame, image);
}

void requireNoLooseVoxels(const NamedMesh& mesh) {
    if (mesh.file.frame == CoordinateFrame::Voxel && !mesh.file.volume) {
        throw InvalidInput(frameText(mesh) +
                           ", which says nothing of mm; give the image by --volume");
    }
}

/// tkRAS whose volume is not known.
void placeLooseTkRas(NamedMesh& a, NamedMesh& b, CommonFrame& common) {
    if (!lacksVolume(a.file) && !lacksVolume(b.file)) return;
    if (a.file.frame != b.file.frame) {
        throw InvalidInput(frameText(a) + " and " + frameText(b) +
                           ", and the files don't say how the two relate; give the image by "
                           "--volume");
    }
    if (lacksVolume(a.file) && lacksVolume(b.file)) {
        common.frame = CoordinateFrame::TkRas;
        common.volume = a.file.volume = b.file.volume = standInVolume();
    } else if (lacksVolume(a.file)) {
        a.file.volume = b.file.volume;
    } else {
        b.file.volume = a.file.volume;
    }
    common.warnings.push_back("both surfaces are in tkRAS mm; taken for surfaces of one volume");
}

void moveToLps(MeshFile& file) {
    file.mesh = fromFrame(file.mesh, *file.frame, file.volume);
}

}  // namespace

CommonFrame bringToOneFrame(NamedMesh& a, NamedMesh& b, const std::optional<ImageGeometry>& image) {
    CommonFrame common;
    assumeUnknownFrames(a, b, common);
    for (NamedMesh* const mesh : {&a, &b}) {
        if (image) takeImage(mesh->file, *image);
        requireNoLooseVoxels(*mesh);
    }
    placeLooseTkRas(a, b, common);
    moveToLps(a.file);
    moveToLps(b.file);
    return common;
}

}  // namespace adaptiso

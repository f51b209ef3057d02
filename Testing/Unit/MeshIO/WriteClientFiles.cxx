// Writes a sphere in every format for clients.py: writeClientFiles <folder>
#include <filesystem>
#include <iostream>

#include "MeshIOTestSupport.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Scene.h"

namespace adaptiso {
namespace {

// clients.py knows these numbers: LPS mm
const TriangleMesh kSphere = testing::icosphere(3, {12, -34, 56}, 40);

void writeAll(const std::filesystem::path& folder) {
    for (const char* name :
         {"ras.vtp", "ras.vtk", "ras.ply", "ras.stl", "ras.obj", "ras.gii", "ras.surf"}) {
        writeMesh(kSphere, folder / name);
    }
    const CoordinateFrame lps = CoordinateFrame::Lps, tkRas = CoordinateFrame::TkRas;
    for (const char* name : {"ras.glb", "ras.3mf", "lps.glb"}) {
        writeScene({{"ball", Color{255, 0, 0}, kSphere}, {"cell", {}, testing::tetrahedron()}},
                   folder / name, {name[0] == 'l' ? lps : CoordinateFrame::Ras, std::nullopt, ""});
    }
    writeMesh(kSphere, folder / "lps.gii", {lps, std::nullopt, ""});
    writeMesh(kSphere, folder / "lps.surf", {lps, std::nullopt, ""});
    writeMesh(kSphere, folder / "voxel.gii",
              {CoordinateFrame::Voxel, testing::obliqueVolume(), ""});
    writeMesh(kSphere, folder / "oblique.gii", {tkRas, testing::obliqueVolume(), ""});
    writeMesh(kSphere, folder / "oblique.surf", {tkRas, testing::obliqueVolume(), "T1.mgz"});
    writeMesh(kSphere, folder / "mirrored.surf", {tkRas, testing::mirroredVolume(), "T1.mgz"});
    writeMesh(kSphere, folder / "conformed.surf",
              {tkRas, conformedGeometry(testing::obliqueVolume()), "orig.mgz"});
}

}  // namespace
}  // namespace adaptiso

int main(int argc, char** argv) {
    try {
        if (argc != 2) throw adaptiso::InvalidInput("writeClientFiles: give one folder");
        adaptiso::writeAll(argv[1]);
        return 0;
    } catch (const adaptiso::Error& error) {
        std::cerr << error.what() << "\n";
        return 3;
    }
}

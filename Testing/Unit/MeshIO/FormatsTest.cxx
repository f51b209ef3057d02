#include <gtest/gtest.h>

#include <set>

#include "MeshIOTestSupport.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso {
namespace {

using testing::messageOf;

TEST(MeshFormats, EveryExtensionFindsItsOwnFormat) {
    std::set<std::string_view> seen;
    for (const MeshFormat& format : meshFormats()) {
        for (const std::string_view extension : format.extensions) {
            EXPECT_TRUE(seen.insert(extension).second) << extension << " is listed twice";
            EXPECT_EQ(findMeshFormat("folder/name" + std::string(extension)).id, format.id);
        }
    }
    EXPECT_EQ(meshFormats().size(), 9u);
}

TEST(MeshFormats, ClassicFreeSurferNamesAreKnown) {
    for (const char* name :
         {"lh.pial", "rh.white", "lh.inflated", "rh.orig", "lh.smoothwm", "lh.sphere",
          "lh.sphere.reg", "lh.seghead", "rh.midthickness", "bem/inner_skull.surf"}) {
        EXPECT_EQ(findMeshFormat(name).id, MeshFormatId::FreeSurfer) << name;
    }
}

TEST(MeshFormats, ExtensionIsFoundWhateverItsCase) {
    EXPECT_EQ(findMeshFormat("HEAD.STL").id, MeshFormatId::Stl);
    EXPECT_EQ(findMeshFormat("lh.pial.surf.gii").id, MeshFormatId::Gifti);
}

TEST(MeshFormats, UnknownExtensionListsTheKnownOnes) {
    const std::string message = messageOf<InvalidInput>([] { findMeshFormat("head.xyz"); });
    EXPECT_NE(message.find("head.xyz"), std::string::npos) << message;
    for (const char* known :
         {".vtp", ".vtk", ".ply", ".stl", ".obj", ".off", ".gii", ".surf", ".tri"}) {
        EXPECT_NE(message.find(known), std::string::npos) << message;
    }
    EXPECT_THROW(findMeshFormat("no-extension"), InvalidInput);
    EXPECT_THROW(findMeshFormat(""), InvalidInput);
}

TEST(MeshFormats, FreeSurferDefaultsToTkRasAndOthersToRas) {
    for (const MeshFormat& format : meshFormats()) {
        EXPECT_EQ(defaultFrame(format), format.id == MeshFormatId::FreeSurfer
                                            ? CoordinateFrame::TkRas
                                            : CoordinateFrame::Ras);
    }
}

TEST(CoordinateFrame, NameAndMarkerAreReadBack) {
    for (const CoordinateFrame frame : {CoordinateFrame::Ras, CoordinateFrame::Lps,
                                        CoordinateFrame::TkRas, CoordinateFrame::Voxel}) {
        EXPECT_EQ(parseCoordinateFrame(toString(frame)), frame);
        EXPECT_EQ(findFrameMarker("# made by hand, " + frameMarker(frame) + ", v1"), frame);
    }
    EXPECT_EQ(findFrameMarker("CoordinateFrame: sideways"), std::nullopt);
    EXPECT_EQ(findFrameMarker("RAS mm"), std::nullopt);
    EXPECT_EQ(parseCoordinateFrame("ras"), std::nullopt);
}

}  // namespace
}  // namespace adaptiso

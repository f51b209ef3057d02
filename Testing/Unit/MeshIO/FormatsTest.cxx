#include <gtest/gtest.h>

#include <set>
#include <string>

#include "MeshIOTestSupport.h"
#include "Support/Pages.h"
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
            EXPECT_EQ(&findMeshFormat("folder/name" + std::string(extension)), &format);
        }
    }
}

TEST(MeshFormats, ClassicFreeSurferNamesAreKnown) {
    for (const char* name :
         {"lh.pial", "rh.white", "lh.inflated", "rh.orig", "lh.smoothwm", "lh.sphere",
          "lh.sphere.reg", "lh.seghead", "rh.midthickness", "bem/inner_skull.surf"}) {
        EXPECT_EQ(findMeshFormat(name).name, "FreeSurfer") << name;
    }
}

TEST(MeshFormats, ExtensionIsFoundWhateverItsCase) {
    EXPECT_EQ(findMeshFormat("HEAD.STL").name, "STL");
    EXPECT_EQ(findMeshFormat("lh.pial.surf.gii").name, "GIFTI");
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
        EXPECT_EQ(format.defaultFrame,
                  format.name == "FreeSurfer" ? CoordinateFrame::TkRas : CoordinateFrame::Ras);
    }
}

TEST(MeshFormats, AreThoseOfTheirPage) {
    const auto word = [](bool isSo) { return isSo ? "yes" : "no"; };
    const std::string header = "| format | extension | coordinates | normals | says its frame |\n";
    std::string table = header + "|---|---|---|---|---|\n";
    for (const MeshFormat& format : meshFormats()) {
        const char* const digits = format.precision == CoordinatePrecision::Float64 ? "double"
                                   : format.precision == CoordinatePrecision::Float32
                                       ? "float"
                                       : "nine digits";
        table += "| " + std::string(format.name) + " | " + testing::quotedList(format.extensions) +
                 " | " + digits + " | " + word(format.holdsNormals) + " | " +
                 word(format.holdsFrame) + " |\n";
    }
    testing::expectOnPage(FORMATS_PAGE, header, "\nRead alone", table);
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

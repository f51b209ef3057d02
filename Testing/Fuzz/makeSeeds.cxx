// makeSeeds FOLDER: writes the seeds, FOLDER/<target>/<number>.

#include <cstdio>
#include <exception>
#include <fstream>

#include "Sandbox.h"
#include "Seeds.h"
#include "SmallVolume.h"
#include "adaptiso-giant/GiantPlan.h"
#include "adaptiso-giant/PieceFile.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::fuzz {

void Seeds::add(const std::string& target, std::string_view bytes) {
    const std::filesystem::path folder = folder_ / target;
    std::filesystem::create_directories(folder);
    const std::filesystem::path file = folder / std::to_string(++counts_[target]);
    std::ofstream stream(file, std::ios::binary);
    stream << bytes;
    stream.close();
    if (!stream) throw FileError(file.string() + ": can't be written");
}

void addSandboxSeeds(Seeds& seeds) {
    detail::SandboxAnswer answer;
    answer.kind = detail::SandboxAnswer::Kind::Volume;
    answer.pixelType = PixelType::Int16;
    answer.geometry = smallVolume(0).view().geometry();
    answer.byteCount = 2 * 7 * 6 * 5;
    answer.format = "DICOM";
    answer.warnings = {{"gantry-tilt", "one"}, {"stray-bits", "and another"}};
    seeds.add("sandbox", detail::packSandboxAnswer(answer));
    answer.kind = detail::SandboxAnswer::Kind::FileError;
    answer.message = "x.dcm: is damaged";
    answer.warnings.clear();
    seeds.add("sandbox", detail::packSandboxAnswer(answer));
}

void addOpenMeegSeeds(Seeds& seeds) {
    const std::string geometry = "# Domain Description 1.1\n\n";
    const std::string conductivities = "# Properties Description 1.0 (Conductivities)\n\n";
    seeds.add("openmeeg", geometry +
                              "Interfaces 1\n\nInterface Scalp: \"a.tri\"\n\n"
                              "Domains 2\n\nDomain Skin: -Scalp\nDomain Air: +Scalp\n" +
                              conductivities + "Air 0\nSkin 0.33\n");
    seeds.add("openmeeg", geometry +
                              "Interfaces 3\n\nInterface Inner: \"a.tri\"\nInterface Outer: "
                              "\"b.tri\"\nInterface Scalp: \"c.tri\"\n\nDomains 4\n\n"
                              "Domain Brain: -Inner\nDomain Skull: -Outer +Inner\n"
                              "Domain Skin: -Scalp +Outer\nDomain Air: +Scalp\n" +
                              conductivities + "Air 0\nSkin 0.33\nBrain 0.33\nSkull 0.0041\n");
}

void addLabelSeeds(Seeds& seeds) {
    for (const char* const text :
         {"index\tname\tabbreviation\tcolor\n1\tGray Matter\tGM\t#ff0000\n2\tb\tn/a\tn/a\n",
          "LabelValue,Name,Color_R,Color_G,Color_B,Color_A\n1,\"a, \"\"b\"\"\",255,128,0,255\n",
          "# LUT\n0 Unknown 0 0 0 0\r\n1001 ctx-lh 25 100 40 0\r\n",
          "1 a 1 2 3\n2 b 1 2 3\n",
          "# Color table file x\n1 left_side 255 0 0 255\n",
          "# ITK-SnAP\n 1 255 0 0 1 1 1 \"Label 1\"\n",
          "1 Precentral_L 2001\n2 b 2002\n",
          "0\tUnclassified\n1\tc\xf4t\xe9 x\n",
          "1;a;2\n2;b;3\n",
          "17 L 220 216 20 0\n819 Left-H 0 80 0 0 2\n",
          "1 0.4 0.07 0.5 7N_Vis\n2 0 1 0 b\n",
          "1 L.B ctx-lh 25 5 25 255\n2 L.C ctx-c 1 2 3 255\n",
          "Left\n1 255 0 0 255\n",
          "FAG\tPrecentral_L\t2001\nFAD\tb\t2002\n",
          "1 \"a b\" #ff8000 # c\n2 d #000000\n",
          "ROIid;ROIabbr;ROIname;r;g;b\n1;a;\"b;c\";0,5;0;1\n",
          "index\tname\tcolor\n1\ta\trgb(1,2,3)\n",
          "<GIFTI><LabelTable><Label Key=\"1\" Red=\"1\" Green=\"0.5\" Blue=\"0\">a</Label>"
          "</LabelTable></GIFTI>",
          "<atlas><header><type>Label</type></header><data><label index=\"0\">a</label></data>"
          "</atlas>",
          R"({"1": "a", "2": {"name": "b", "color": "#ff8000"}})",
          R"([{"id": 8, "acronym": "g", "name": "Grey", "rgb_triplet": [255, 128, 0]}])",
          R"({"R": [0, 255], "G": [0, 1], "B": [0, 0], "I": [0, 9], "labels": ["", "b"]})"}) {
        seeds.add("labels", text);
    }
    seeds.add("labels", std::string(767, '\0') + "\xff");
    seeds.add("labels",
              "NRRD0004\nSegment0_Name:=a\nSegment0_LabelValue:=3\nSegment0_Layer:=0\n"
              "Segment0_Color:=1 0.5 0\nSegment1_ID:=b\n\n");
    const std::string table =
        "<LabelTable><Label Key=\"1\" Red=\"1\" Green=\"0\" Blue=\"0\">a</Label></LabelTable>";
    std::string nifti = "\x5c\1" + std::string(342, '\0') + std::string("n+1\0\1\0\0\0", 8);
    const auto size = static_cast<char>((table.size() + 8 + 15) / 16 * 16);
    nifti += size + std::string("\0\0\0\36\0\0\0", 7) + table;
    nifti.resize(352 + static_cast<unsigned char>(size), '\0');
    seeds.add("labels", nifti);
    for (const char* const text : {"01,2,10-20", "0-5--2,2147483647", "1Thalamus=10,49",
                                   "1a=1-3\nb=4\na=b=5,6", "21=0.33,2=0.0066", "2-7=1e-3"}) {
        seeds.add("lists", text);
    }
    for (const char* const text :
         {"0a.nii\nscans/b.nii\tsecond\r\n# c\n", "1in.stl\tout.stl\n",
          "2participant_id\tage\r\nsub-01\t3\n02\tn/a\n", "2age;participant_id\n3;\"sub-01\"\n",
          "3/sub-01\n**/*_acq-[!a-c]*_*\nsub-0?/\n!sub-04/\n*a*a*a*b\n\\*\n",
          R"(4{"Name": "a", "BIDSVersion": "1.8.0"})"}) {
        std::string seed = text;
        seed[0] = static_cast<char>(seed[0] - '0');
        seeds.add("sides", seed);
    }
}

void addRecordSeeds(Seeds& seeds) {
    seeds.add("record",
              R"({"schema":"adaptiso-record/1","program":{"name":"adaptiso-mesh"},"build":"x",)"
              R"("ended":true,"date":"2026","says":"x","name":"a","files":["a.nii"],"exitCode":0,)"
              R"("signal":null,"error":null,"warnings":[],"outputs":["a.vtp"],"seconds":1.0,)"
              R"("report":{},"options":[{"name":"--iso","sha256":"0"}],"inputs":[{"file":"a.nii",)"
              R"("bytes":1,"sha256":"0","modifiedNs":1,"changedNs":1,"place":"a.nii"}],)"
              R"("keptOutputs":[{"file":"a.vtp","bytes":1,"sha256":"0","modifiedNs":1,)"
              R"("changedNs":1,"option":"--output"}]})");
}

/// Nested as deep as the fuzzers' longest input lets it.
void addDeepSeeds(Seeds& seeds) {
    constexpr std::size_t kDepth = 30'000;
    const std::string deep = std::string(kDepth, '[') + std::string(kDepth, ']');
    for (const char* const target : {"labels", "record"}) {
        seeds.add(target, "{\"1\":" + deep + "}");
        seeds.add(target, "[{\"index\":" + deep + "}]");
    }
    seeds.add("giant", '\1' + deep);
    std::string elements = "<VTKFile>";
    while (elements.size() < 2 * kDepth) elements += "<a>";
    for (const char* const target : {"vtp", "gii", "labels"}) seeds.add(target, elements);
}

void addGiantSeeds(Seeds& seeds) {
    using namespace giant;
    const VolumeView volume = smallVolume(0).view();
    GiantPlan plan;
    plan.version = "0";
    plan.input = "/a.zarr";
    plan.geometry = volume.geometry();
    plan.pixelType = volume.pixelType();
    plan.maxErrorMm = 0.1;
    plan.side = TileCut::kStep;
    plan.tiles = {{0, 0, 0}};
    seeds.add("giant", std::string(1, '\1') + encodePlan(plan));
    const double isovalue = 50;
    for (const bool isOpen : {false, true}) {
        Piece piece;
        piece.summary.stage = "tile";
        piece.summary.id = "0_0_0";
        piece.mesh =
            extractTile(volume, {0, 0, 0}, volume.geometry(), isovalue, plan.cut(), {0, 0, 0});
        if (isOpen && !piece.mesh.triangles.empty()) piece.mesh.triangles.pop_back();
        piece.mesh = withoutUnusedPoints(std::move(piece.mesh));
        summarize(piece.mesh, volume.geometry(), piece.summary);
        seeds.add("giant", std::string(1, '\0') + encodePiece(piece));
    }
}

/// One element above and one below a triangle, as the meshers' files have them.
void addMesherSeeds(Seeds& seeds) {
    const std::string nodes =
        "5 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 0 0 -1\n# by tetgen\n";
    const std::string elements = "2 4 1\n0 0 1 2 3 1\n1 0 1 2 4 2\n# by tetgen\n";
    seeds.add("tetgen", nodes + '\0' + elements);
    seeds.add("gmsh",
              "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n"
              "4 0 0 1\n5 0 0 -1\n$EndNodes\n$Elements\n4\n1 15 2 0 1 3\n2 2 2 0 1 1 2 3\n"
              "3 4 2 1 1 1 2 3 4\n4 4 2 2 2 1 2 3 5\n$EndElements\n");
}

}  // namespace adaptiso::fuzz

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fputs("usage: makeSeeds FOLDER\n", stderr);
        return 2;
    }
    try {
        adaptiso::fuzz::Seeds seeds(argv[1]);
        adaptiso::fuzz::addImageSeeds(seeds);
        adaptiso::fuzz::addDicomSeeds(seeds);
        adaptiso::fuzz::addMeshSeeds(seeds);
        adaptiso::fuzz::addZarrSeeds(seeds);
        adaptiso::fuzz::addSandboxSeeds(seeds);
        adaptiso::fuzz::addOpenMeegSeeds(seeds);
        adaptiso::fuzz::addLabelSeeds(seeds);
        adaptiso::fuzz::addGiantSeeds(seeds);
        adaptiso::fuzz::addRecordSeeds(seeds);
        adaptiso::fuzz::addDeepSeeds(seeds);
        adaptiso::fuzz::addMesherSeeds(seeds);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "makeSeeds: %s\n", error.what());
        return 3;
    }
    return 0;
}

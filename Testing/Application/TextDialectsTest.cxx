// Every reader of text, on its text as different programs save it: what is read is the same, or the
// message names the cause. OpenMEEG's .geom and .cond are read to check what was written, by
// OpenMEEG's own rules.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "Common/Batch.h"
#include "Common/Naming.h"
#include "FolderTest.h"
#include "adaptiso-bids/SideFiles.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/ImageIO/ImageNames.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/LabelNames/LabelTable.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/MeshIO/PointFiles.h"
#include "adaptiso/Tetrahedra/MesherFiles.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
}

/// A reader: what it makes of a text, in words.
struct Reader {
    std::string name, text;
    std::function<std::string(const std::string& text, const fs::path& folder)> read;
    std::string behind = {};  ///< binary data that follow the text in its file
};

std::string inWords(const TriangleMesh& mesh) {
    std::ostringstream words;
    for (const Vec3& p : mesh.points) words << p.x << ' ' << p.y << ' ' << p.z << '\n';
    for (const Triangle& t : mesh.triangles) words << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
    return words.str();
}

Reader meshReader(const std::string& name, const std::string& text) {
    return {name, text, [name](const std::string& bytes, const fs::path& folder) {
                write(folder / name, bytes);
                return inWords(readMesh(folder / name).mesh);
            }};
}

Reader imageReader(const std::string& name, const std::string& text, const std::string& behind) {
    return {name, text,
            [name](const std::string& bytes, const fs::path& folder) {
                write(folder / name, bytes);
                write(folder / "data.raw", "abcdefgh");
                const ReadVolume read = readVolume(folder / name);
                std::ostringstream words;
                words << read.format;
                for (const auto& column : read.volume.view().geometry().indexToPhysical.column) {
                    words << ' ' << norm(column);
                }
                const auto* const samples = static_cast<const char*>(read.volume.view().samples());
                words << ' ' << std::string(samples, samples + 8);
                return words.str();
            },
            behind};
}

Reader pointReader(const std::string& name, const std::string& text) {
    return {"electrodes " + name, text, [name](const std::string& bytes, const fs::path&) {
                std::ostringstream words;
                for (const NamedPoint& p : decodePoints(bytes, name, "points").points) {
                    words << p.name << ' ' << p.point.x << ' ' << p.point.y << ' ' << p.point.z
                          << '\n';
                }
                return words.str();
            }};
}

Reader tableReader(const std::string& name, const std::string& text) {
    return {"names " + name, text, [](const std::string& bytes, const fs::path&) {
                std::ostringstream words;
                const LabelTable table = decodeLabelTable(bytes, "table");
                for (const LabelEntry& entry : table.entries) {
                    words << entry.value << ' ' << entry.name << ' ' << entry.abbreviation << ' '
                          << (entry.color ? hexText(*entry.color) : "none") << '\n';
                }
                words << table.warnings.size();
                return words.str();
            }};
}

std::string joined(const std::vector<BatchItem>& items) {
    std::string words;
    for (const BatchItem& item : items) {
        words += item.name;
        for (const fs::path& input : item.inputs) words += " " + input.string();
        words += '\n';
    }
    return words;
}

std::vector<Reader> allReaders() {
    const std::string eight = "abcdefgh";
    const std::string nrrd =
        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n"
        "spacings: 1 2 3\n";
    const std::string meta =
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = 2 2 2\n"
        "ElementSpacing = 1 2 3\nElementType = MET_UCHAR\nElementDataFile = ";
    const std::string off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    std::vector<Reader> readers{
        imageReader("a.nrrd", nrrd + "\n", eight),
        imageReader("a.nhdr", nrrd + "data file: data.raw\n", ""),
        imageReader("a.mha", meta + "LOCAL\n", eight),
        imageReader("a.mhd", meta + "data.raw\n", ""),
        meshReader("a.off", off),
        meshReader("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        meshReader("a.ply",
                   "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                   "property float y\nproperty float z\nelement face 1\n"
                   "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n"
                   "0 1 0\n3 0 1 2\n"),
        meshReader("a.stl",
                   "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                   "vertex 0 1 0\nendloop\nendfacet\nendsolid a\n"),
        meshReader("a.vtk",
                   "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\n"
                   "POINTS 3 float\n0 0 0\n1 0 0\n0 1 0\nPOLYGONS 1 4\n3 0 1 2\n"),
        meshReader("a.tri", "- 3\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n- 1 1 1\n0 1 2\n"),
        meshReader("b.tri", "3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n1\n1 1 2 3\n"),
        meshReader("a.vtp",
                   "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\">\n"
                   "<PolyData>\n<Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\">\n<Points>\n"
                   "<DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">\n"
                   "0 0 0\n1 0 0\n0 1 0\n</DataArray>\n</Points>\n<Polys>\n"
                   "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">\n0 1 2\n"
                   "</DataArray>\n<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">\n3\n"
                   "</DataArray>\n</Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n"),
        pointReader(".tsv", "name\tx\ty\tz\nCz\t0\t0\t92\nOz\t-95\t0\t0.5\n"),
        pointReader(".sfp", "Cz\t0\t0\t92\nOz\t-95\t0\t0.5\n"),
        pointReader(".elc", "UnitPosition\tmm\nPositions\n0 0 92\n-95 0 0.5\nLabels\nCz\nOz\n"),
        pointReader(".loc", "1\t0\t0\tCz\n2\t180\t.5\tOz\n"),
        pointReader(".xyz", "1\t0\t0\t92\tCz\n2\t-95\t0\t0.5\tOz\n"),
        pointReader(".elp", "EEG Cz 0 0\nEEG Oz 90 -90\n"),
        pointReader(".hsp", "%F 0 90 0\n%F -70 0 0\n%F 70 0 0\n1 3\n0 0 92\n"),
        pointReader(".pos", "2\nCz 0 0 92\n2 Oz -95 0 0.5\n"),
        pointReader(".hpts", "eeg Cz 0 0 92\neeg Oz -95 0 0.5\n"),
        pointReader(".csd", "Cz 0 90 1 0 0 1 0\nOz -90 0 1 0 -1 0 0\n"),
        pointReader(".txt", "Site\tTheta\tPhi\nCz\t0\t0\nOz\t90\t-90\n"),
        tableReader("BIDS", "index\tname\tcolor\n1\tLeft Femur\t#ff8000\n2\tb\t#000001\n"),
        tableReader("FreeSurfer", "# LUT\n1 Femur_L 255 128 0 0\n2 b 0 0 1 0\n"),
        tableReader("FreeSurfer 8", "1 Femur_L 255 128 0 0\n2 b 0 0 1 0 2\n"),
        tableReader("FSLeyes", "1 1 0.5 0 Left Femur\n2 0 0 0.25 b\n"),
        tableReader("ITK-SNAP", "1 255 128 0 1 1 1 \"Left Femur\"\n2 0 0 1 1 1 1 \"b\"\n"),
        tableReader("MRIcron", "1 Femur_L 2001\n2 Femur_R 2002\n"),
        tableReader("3D Slicer", "# Color table file x\n1 Femur_L 255 128 0 255\n2 b 0 0 1 255\n"),
        tableReader("commas", "LabelValue,Name,Color_R,Color_G,Color_B\n1,\"a, b\",255,128,0\n"),
        tableReader("CAT12", "ROIid;ROIabbr;ROIname\n1;lF;Left Femur\n2;rF;Right Femur\n"),
        tableReader("MRtrix", "1 L.F Femur_L 255 128 0 255\n2 R.F Femur_R 0 0 1 255\n"),
        tableReader("AAL", "FAG\tPrecentral_L\t2001\nFAD\tPrecentral_R\t2002\n"),
        tableReader("Workbench", "Left Femur\n1 255 128 0 255\nb\n2 0 0 1 255\n"),
        tableReader("GIFTI",
                    "<?xml version=\"1.0\"?>\n<GIFTI>\n<LabelTable>\n"
                    "<Label Key=\"1\" Red=\"1\" Green=\"0.5\" Blue=\"0\">a</Label>\n"
                    "</LabelTable>\n</GIFTI>\n"),
        tableReader("JSON", "{\n\"1\": \"Left Femur\",\n\"2\": {\"name\": \"b\"}\n}\n"),
    };
    readers.push_back({"names in NRRD",
                       "NRRD0004\ntype: uchar\nSegment0_Name:=a\n"
                       "Segment0_LabelValue:=3\n\n",
                       [](const std::string& bytes, const fs::path&) {
                           const LabelTable table = decodeEmbeddedTable(bytes);
                           return table.entries.empty() ? std::string("none")
                                                        : std::to_string(table.entries[0].value) +
                                                              table.entries[0].name;
                       },
                       "\1\2"});
    readers.push_back(
        {"--list", "a.nii\nscans/b.nii\tsecond\n", [](const std::string& bytes, const fs::path&) {
             return joined(listedItems(bytes, "--list x", false, inputStem));
         }});
    readers.push_back({"--list of heads", "in.stl\tout.stl\nb/in.stl\tb/out.stl\n",
                       [](const std::string& bytes, const fs::path&) {
                           return joined(listedItems(bytes, "--list x", true, inputStem));
                       }});
    readers.push_back({"participants.tsv", "participant_id\tage\nsub-01\t3\n02\tn/a\nn/a\t4\n",
                       [](const std::string& bytes, const fs::path&) {
                           std::string words;
                           for (const std::string& id : bids::participantsIn(bytes)) {
                               words += id + ' ';
                           }
                           return words;
                       }});
    readers.push_back({".bidsignore", "# left out\nsub-0[3-4]/\n*_acq-bad_*\n!sub-04/\n",
                       [](const std::string& bytes, const fs::path&) {
                           const bids::BidsIgnore ignored(bytes);
                           std::string words;
                           for (const char* const path : {"sub-01", "sub-03", "sub-04",
                                                          "sub-01/anat/sub-01_acq-bad_T1w.nii"}) {
                               words += ignored.contains(path) ? '1' : '0';
                           }
                           return words;
                       }});
    readers.push_back(
        {"dataset_description.json", "{\n\"Name\": \"a\"\n}\n",
         [](const std::string& bytes, const fs::path&) { return bids::missingKeyOf(bytes); }});
    readers.push_back({"tetgen", "4 3 0 0\n# points\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n",
                       [](const std::string& bytes, const fs::path&) {
                           const auto mesh = decodeTetgen(bytes, "1 4 1\n0 0 1 2 3 2\n", "tetgen");
                           return std::to_string(mesh.points.size()) + ' ' +
                                  std::to_string(mesh.labels.at(0));
                       }});
    return readers;
}

std::string replacedAll(const std::string& text, char c, const std::string& by) {
    std::string result;
    for (const char each : text) each == c ? result += by : result += each;
    return result;
}

std::string inUtf16(const std::string& text, bool hasMark) {
    std::string result = hasMark ? "\xFF\xFE" : "";
    for (const char c : text) result.append({c, '\0'});
    return result;
}

using Rewrite = std::function<std::string(const std::string&)>;

const std::map<std::string, Rewrite> kDialects{
    {"as it is", [](const std::string& text) { return text; }},
    {"byte order mark", [](const std::string& text) { return "\xEF\xBB\xBF" + text; }},
    {"CRLF", [](const std::string& text) { return replacedAll(text, '\n', "\r\n"); }},
    {"CR", [](const std::string& text) { return replacedAll(text, '\n', "\r"); }},
    {"byte order mark and CRLF",
     [](const std::string& text) { return "\xEF\xBB\xBF" + replacedAll(text, '\n', "\r\n"); }},
    {"byte order mark and CR",
     [](const std::string& text) { return "\xEF\xBB\xBF" + replacedAll(text, '\n', "\r"); }},
    {"blanks at the ends", [](const std::string& text) { return replacedAll(text, '\n', "  \n"); }},
    {"tabs at the ends", [](const std::string& text) { return replacedAll(text, '\n', "\t\n"); }},
};

class TextDialects : public FolderTest {};

TEST_F(TextDialects, AreReadByEveryReader) {
    int cases = 0;
    for (const Reader& reader : allReaders()) {
        const std::string expected = reader.read(reader.text + reader.behind, folder_);
        for (const auto& [dialect, rewritten] : kDialects) {
            SCOPED_TRACE(reader.name + ", " + dialect);
            ++cases;
            EXPECT_EQ(reader.read(rewritten(reader.text) + reader.behind, folder_), expected);
        }
        if (!reader.behind.empty()) continue;
        for (const char* const ends : {"", "\n\n", "\r\n\r\n"}) {
            SCOPED_TRACE(reader.name + ", the last line's end");
            ++cases;
            const std::string_view text = trimmed(reader.text);
            EXPECT_EQ(reader.read(std::string(text) + ends, folder_), expected);
        }
    }
    RecordProperty("cases", cases);
}

TEST_F(TextDialects, OfUtf16AreNamed) {
    for (const Reader& reader : allReaders()) {
        const bool isXml = reader.text.starts_with("<?xml");  // which names its encoding
        const bool isFound = reader.name == "names in NRRD" || reader.name == "tetgen";
        if (isXml || isFound) continue;
        for (const bool hasMark : {true, false}) {
            SCOPED_TRACE(reader.name);
            try {
                const std::string read =
                    reader.read(inUtf16(reader.text, hasMark) + reader.behind, folder_);
                ADD_FAILURE() << "was read: " << read;
            } catch (const Error& error) {
                EXPECT_NE(std::string(error.what()).find("UTF-16"), std::string::npos)
                    << error.what();
            }
        }
    }
}

}  // namespace
}  // namespace adaptiso

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <utility>

#include "BemFileKinds.h"
#include "adaptiso/Core/Bytes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadModel/ExportMatlab.h"
#include "adaptiso/HeadModel/ExportOpenMeeg.h"
#include "adaptiso/MeshIO/FiffSurfaces.h"
#include "adaptiso/MeshIO/PointFiles.h"
#include "adaptiso/Tetrahedra/Tetrahedra.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;
using Files = std::vector<std::string>;
using Source = BemFileSource;

constexpr double kMetresPerMm = 0.001;

BemFileKind oneFile(const Files& files, const std::function<void(const fs::path&)>& write,
                    const std::function<BemFileFault(const fs::path&)>& check) {
    return {[=](const PlaceFile& place) { write(place(files.front())); },
            [=](const fs::path& folder) { return check(folder / files.front()); }};
}

std::string bytesOf(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw FileError(path.string() + ": can't be read");
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// The largest distance of two points of one index; infinity of other lengths and of NaN.
double farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double most = a.size() == b.size() ? 0 : HUGE_VAL;
    for (std::size_t n = 0; n < a.size() && most < HUGE_VAL; ++n) {
        const double distance = norm(a[n] - b[n]);
        most = std::isnan(distance) ? HUGE_VAL : std::max(most, distance);
    }
    return most;
}

double farthest(const AffineTransform& a, const AffineTransform& b) {
    const auto columns = [](const AffineTransform& t) {
        return std::vector<Vec3>{t.linear.column[0], t.linear.column[1], t.linear.column[2],
                                 t.offset};
    };
    return farthest(columns(a), columns(b));
}

BemFileFault faultUnless(bool isGood, const Source& source, const std::string& what) {
    return isGood ? std::nullopt : std::optional(source.fault(what));
}

// Tables of numbers

/// Lines of as many numbers each.
struct Table {
    std::size_t columns;
    std::vector<double> values{};

    void add(const Vec3& v) { values.insert(values.end(), {v.x, v.y, v.z}); }
};

/// \param begins  each line begins with a name
std::vector<double> numbersIn(const fs::path& path, bool begins) {
    std::istringstream lines(bytesOf(path));
    std::vector<double> values;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string name;
        if (begins) words >> name;
        for (double value = 0; words >> value;) values.push_back(value);
        if (!words.eof()) throw FileError(path.string() + ": holds '" + visibleAscii(line) + "'");
    }
    return values;
}

BemFileFault checkTable(const Table& table, const fs::path& path, const Source& source,
                        bool begins = false) {
    constexpr double kDigits = 1e-6;  // six decimals
    const std::vector<double> stored = numbersIn(path, begins);
    if (stored.size() != table.values.size()) {
        return source.fault("it holds " + formatCount(std::ssize(stored)) + " numbers, must hold " +
                            formatCount(std::ssize(table.values)));
    }
    for (std::size_t n = 0; n < stored.size(); ++n) {
        if (std::abs(stored[n] - table.values[n]) <= kDigits) continue;
        return source.fault("line " + formatCount(static_cast<long long>(n / table.columns + 1)) +
                            " holds " + formatNumber(stored[n]) + ", must hold " +
                            formatNumber(table.values[n]));
    }
    return std::nullopt;
}

BemFileKind tableFile(const Source& source, const Files& files, const Table& table,
                      std::string (*format)(double)) {
    return oneFile(
        files,
        [=](const fs::path& path) {
            std::string text;
            for (std::size_t n = 0; n < table.values.size(); ++n) {
                text += format(table.values[n]) + ((n + 1) % table.columns == 0 ? "\n" : " ");
            }
            writeText(path, text);
        },
        [=](const fs::path& path) { return checkTable(table, path, source); });
}

std::string sixDecimals(double value) {
    return formatFixed(value, 6);
}

double unitOf(const Source& source) {
    return source.options.unit == OpenMeegUnit::Metres ? kMetresPerMm : 1;
}

// Electrodes

std::vector<NamedPoint> pointsIn(CoordinateFrame frame, const Source& source) {
    if (!source.model.electrodes) return {};
    std::vector<NamedPoint> points = source.model.electrodes->all();
    const AffineTransform move = source.into(frame);
    for (NamedPoint& p : points) p.point = move(p.point);
    return points;
}

bool hasPoints(const Source& source) {
    return source.model.electrodes && !source.model.electrodes->all().empty();
}

/// Formats write blanks and colons of names in their own ways.
std::string plainName(const std::string& name) {
    std::string plain;
    for (const char c : name) {
        if (c == ':') plain += "{COLON}";
        if (c != ' ' && c != '_' && c != ':') plain += c;
    }
    return plain;
}

BemFileFault checkPoints(const std::vector<NamedPoint>& expected, CoordinateFrame frame,
                         const fs::path& path, const Source& source) {
    const PointFile file = readPoints(path);
    if (file.points.size() != expected.size()) {
        return source.fault("it holds " + formatCount(std::ssize(file.points)) +
                            " points, must hold " + formatCount(std::ssize(expected)));
    }
    if (file.frame.value_or(frame) != frame) return source.fault("it names another frame");
    for (std::size_t n = 0; n < expected.size(); ++n) {
        const NamedPoint &stored = file.points[n], &point = expected[n];
        const bool isLandmark = point.kind != PointKind::Electrode && stored.kind == point.kind;
        if (!isLandmark && plainName(stored.name) != plainName(point.name)) {
            return source.fault("it names " + visibleAscii(stored.name) + " where " +
                                visibleAscii(point.name) + " is due");
        }
        const double mm = norm(stored.point - point.point);
        if (mm <= kFileRoundingMm) continue;
        return source.fault(visibleAscii(point.name) + " lies " + formatNumber(mm) +
                            " mm from where it should");
    }
    return std::nullopt;
}

BemFileKind bidsFiles(const Source& source, const Files& files) {
    const CoordinateFrame frame = source.options.frame;
    std::vector<NamedPoint> points = pointsIn(frame, source);
    return {[=](const PlaceFile& place) {
                const fs::path tsv = place(files[0]);
                writeBidsElectrodes(points, tsv, place(files[1]), frame);
            },
            [=](const fs::path& folder) {
                // the landmarks of the JSON in the order of their names there: LPA, NAS, RPA
                std::vector<NamedPoint> expected = points;
                if (source.hasLandmarks()) std::swap(*(expected.end() - 3), *(expected.end() - 2));
                return checkPoints(expected, frame, folder / files[0], source);
            }};
}

using WritePoints = void (*)(std::span<const NamedPoint>, const fs::path&);

/// \param named  the frame that the file says
BemFileKind pointFile(const Source& source, const Files& files, WritePoints write,
                      const std::vector<NamedPoint>& points, CoordinateFrame named) {
    return oneFile(
        files, [=](const fs::path& path) { write(points, path); },
        [=](const fs::path& path) { return checkPoints(points, named, path, source); });
}

/// Without the nasion, "Nz" there, where the electrode of this name of the 10-10 system is: readers
/// refuse names that stand twice.
BemFileKind elcFile(const Source& source, const Files& files) {
    const CoordinateFrame frame = source.options.frame;
    std::vector<NamedPoint> points = pointsIn(frame, source);
    if (std::ranges::count(points, "Nz", &NamedPoint::name) > 0) {
        std::erase_if(points, [](const NamedPoint& p) { return p.kind == PointKind::Nasion; });
    }
    return pointFile(source, files, writeElc, points, frame);
}

/// The same move of points in metres.
AffineTransform inMetres(AffineTransform mm) {
    mm.offset = kMetresPerMm * mm.offset;
    return mm;
}

BemFileKind headToMriFile(const Source& source, const Files& files) {
    const AffineTransform toHead = toNeuromag(*source.model.electrodes->landmarks);
    const AffineTransform toMri = inMetres(source.into(source.mriFrame()) * inverse(toHead));
    return oneFile(
        files, [=](const fs::path& path) { writeFiffHeadToMri(toMri, path); },
        [=](const fs::path& path) {
            return faultUnless(farthest(readFiffHeadToMri(path), toMri) <= 1e-6, source,
                               "its transform is another");
        });
}

BemFileKind electrodesText(const Source& source, const Files& files) {
    Table table{3};
    for (const NamedPoint& p : pointsIn(source.options.frame, source)) {
        if (p.kind == PointKind::Electrode) table.add(unitOf(source) * p.point);
    }
    return tableFile(source, files, table, sixDecimals);
}

/// Landmarks first, as BESA wants them.
BemFileKind besaFile(const Source& source, const Files& files) {
    const CoordinateFrame frame = source.options.frame;
    std::vector<NamedPoint> points = pointsIn(frame, source);
    std::stable_partition(points.begin(), points.end(),
                          [](const NamedPoint& p) { return p.kind != PointKind::Electrode; });
    std::int64_t number = 0;
    for (const Vec3& p : source.model.meshes.back().points) {
        points.push_back({"S" + std::to_string(++number), PointKind::Other, source.into(frame)(p)});
    }
    Table table{3};
    for (const NamedPoint& p : points) table.add(p.point);
    return oneFile(
        files, [=](const fs::path& path) { writeSfp(points, path); },
        [=](const fs::path& path) { return checkTable(table, path, source, true); });
}

// Sources

struct Dipoles {
    std::vector<Vec3> places, directions;
};

Dipoles dipolesOf(const Source& source) {
    const AffineTransform move = source.into(source.options.frame);
    Dipoles dipoles;
    for (const SourceSpace& space : source.model.sources->spaces) {
        for (const std::int64_t point : space.used) {
            for (const Vec3& direction : space.orientations(point)) {
                dipoles.places.push_back(move(space.surface.points[point]));
                dipoles.directions.push_back(space.grid ? direction : move.linear * direction);
            }
        }
    }
    return dipoles;
}

BemFileKind dipolesText(const Source& source, const Files& files) {
    const auto [places, directions] = dipolesOf(source);
    Table table{6};
    for (std::size_t n = 0; n < places.size(); ++n) {
        table.add(unitOf(source) * places[n]);
        table.add(directions[n]);
    }
    return tableFile(source, files, table, sixDecimals);
}

FiffSources::Grid gridIn(const ImageGeometry& grid, const AffineTransform& toMri,
                         const std::optional<ImageGeometry>& image) {
    const auto sizeOf = [](const ImageGeometry& geometry) {
        std::array<std::int32_t, 3> size{};
        std::copy(geometry.size.begin(), geometry.size.end(), size.begin());
        return size;
    };
    const auto placeOf = [&](const ImageGeometry& geometry) {
        AffineTransform place =
            toMri * AffineTransform{geometry.indexToPhysical, geometry.originMm};
        for (Vec3& column : place.linear.column) column = kMetresPerMm * column;
        return inMetres(place);
    };
    const ImageGeometry& parent = image ? *image : grid;
    const AffineTransform toRas = lpsToFrame(CoordinateFrame::Ras, {}) * inverse(toMri);
    return {sizeOf(grid), sizeOf(parent), placeOf(grid), placeOf(parent), inMetres(toRas)};
}

std::vector<FiffSources> spacesOf(const Source& source) {
    const BemModel& model = source.model;
    const AffineTransform toMri = source.into(source.mriFrame());
    const double middleX = boundingBox(model.meshes.front()).middle().x;
    std::vector<FiffSources> spaces;
    for (const SourceSpace& space : model.sources->spaces) {
        FiffSources& written = spaces.emplace_back();
        written.mesh = transformed(space.surface, toMri);
        for (Vec3& p : written.mesh.points) p = kMetresPerMm * p;
        written.used = space.used;
        if (space.grid) {
            written.mesh.normals.assign(written.mesh.points.size(), Normal{0, 0, 1});
            written.grid = gridIn(*space.grid, toMri, model.tkRasVolume);
            continue;
        }
        const bool isRight = model.sources->spaces.size() == 2
                                 ? spaces.size() == 2
                                 : boundingBox(space.surface).middle().x < middleX;
        written.id = isRight ? FiffSources::kRightHemisphere : FiffSources::kLeftHemisphere;
    }
    return spaces;
}

/// Coordinates are floats, in metres.
bool isSame(const FiffSources& a, const FiffSources& b) {
    constexpr double kRounding = kMetresPerMm * kFileRoundingMm, kDirections = 1e-5;
    const auto normals = [](const FiffSources& sources) {
        std::vector<Vec3> list;
        for (const Normal& normal : sources.mesh.normals) list.push_back(toVec3(normal));
        return list;
    };
    if (a.used != b.used || a.mesh.triangles != b.mesh.triangles ||
        a.grid.has_value() != b.grid.has_value()) {
        return false;
    }
    if (!(farthest(a.mesh.points, b.mesh.points) <= kRounding)) return false;
    if (!(farthest(normals(a), normals(b)) <= kDirections)) return false;
    if (!a.grid) return a.id == b.id;
    return a.grid->size == b.grid->size && a.grid->imageSize == b.grid->imageSize &&
           farthest(a.grid->toMri, b.grid->toMri) <= kRounding &&
           farthest(a.grid->imageToMri, b.grid->imageToMri) <= kRounding &&
           farthest(a.grid->mriToRas, b.grid->mriToRas) <= kRounding;
}

BemFileKind sourcesFile(const Source& source, const Files& files) {
    return oneFile(
        files, [=](const fs::path& path) { writeFiffSources(spacesOf(source), path); },
        [=](const fs::path& path) {
            const auto written = readFiffSources(path), wanted = spacesOf(source);
            const bool areSame =
                std::equal(written.begin(), written.end(), wanted.begin(), wanted.end(), isSame);
            return faultUnless(areSame, source, "its sources are others");
        });
}

BemFileKind leadFieldFile(const Source& source, const Files& files) {
    return oneFile(
        files,
        [=](const fs::path& path) {
            const BemLeadField& made = *source.model.leadField;
            LeadField field{made.solver, made.gain, {}, {}, {}};
            for (const NamedPoint& p : pointsIn(source.options.frame, source)) {
                if (p.kind == PointKind::Electrode) field.electrodes.push_back(p);
            }
            Dipoles dipoles = dipolesOf(source);
            field.places = std::move(dipoles.places);
            field.directions = std::move(dipoles.directions);
            writeLeadField(field, path, source.options.frame);
        },
        [=](const fs::path& path) {
            return faultUnless(readLeadFieldGain(path) == source.model.leadField->gain, source,
                               "its numbers are others");
        });
}

BemFileKind forwardFile(const Source& source, const Files& files) {
    return oneFile(
        files, [=](const fs::path& path) { writeText(path, source.model.leadField->forward); },
        [=](const fs::path& path) {
            return faultUnless(bytesOf(path) == source.model.leadField->forward, source,
                               "its bytes are others");
        });
}

// Tetrahedra

/// In the order of regions, as some formats hold them.
TetrahedralMesh byRegion(const TetrahedralMesh& mesh) {
    std::vector<std::size_t> order(mesh.labels.size());
    for (std::size_t n = 0; n < order.size(); ++n) order[n] = n;
    std::ranges::stable_sort(order, {}, [&](std::size_t n) { return mesh.labels[n]; });
    TetrahedralMesh sorted{mesh.points, {}, {}};
    for (const std::size_t n : order) {
        sorted.tetrahedra.push_back(mesh.tetrahedra[n]);
        sorted.labels.push_back(mesh.labels[n]);
    }
    return sorted;
}

using WriteTetrahedra = void (*)(const TetrahedralMesh&, std::span<const TetrahedraRegion>,
                                 const fs::path&);

/// \param arePlaces  labels are stored as places in allTissues()
BemFileKind tetrahedraFile(const Source& source, const Files& files, WriteTetrahedra write,
                           bool arePlaces = false) {
    const auto expected = [=] {
        const AffineTransform move = source.into(source.options.frame);
        return transformed(source.model.tetrahedra->mesh, move.linear, move.offset);
    };
    return oneFile(
        files,
        [=](const fs::path& path) { write(expected(), headRegions(source.model.meshes), path); },
        [=](const fs::path& path) {
            TetrahedralMesh stored = decodeTetrahedra(bytesOf(path), path.string());
            if (arePlaces) {
                for (std::int32_t& label : stored.labels)
                    label += allTissues(source.model.meshes.size()).front().label;
            }
            stored = byRegion(stored);
            const TetrahedralMesh mesh = byRegion(expected());
            if (stored.tetrahedra != mesh.tetrahedra || stored.labels != mesh.labels) {
                return BemFileFault(source.fault("its tetrahedra, or their tissues, are others"));
            }
            return faultUnless(farthest(stored.points, mesh.points) <= kFileRoundingMm, source,
                               "its points lie elsewhere");
        });
}

/// BEM-FMM's list: ">tissue : file : S/m : enclosing tissue", from outside in.
BemFileKind tissueIndex(const Source& source, const Files& files) {
    std::string lines = "% BEM-FMM: tissue, surface (scanner RAS, mm), S/m, enclosing tissue\n";
    const std::size_t count = source.model.meshes.size();
    std::string enclosing = "FreeSpace";
    for (std::size_t n = count; n-- > 0;) {
        const std::string tissue(tissueWithin(source.surface(n), count).domain);
        lines += ">" + tissue + " : " +
                 stlFileNames()[static_cast<std::size_t>(source.surface(n))] + " : " +
                 formatNumber(source.conductivity(n)) + " : " + enclosing + "\n";
        enclosing = tissue;
    }
    if (source.model.spongyBone) {
        lines += std::string(">Spongy : ") + kSpongyStl + " : " +
                 formatNumber(kSpongyBoneConductivity) + " : " +
                 std::string(tissueWithin(HeadSurface::OuterSkull, count).domain) + "\n";
    }
    return oneFile(
        files, [=](const fs::path& path) { writeText(path, lines); },
        [=](const fs::path& path) {
            return faultUnless(bytesOf(path) == lines, source, "its lines are others");
        });
}

bool hasTetrahedra(const Source& source) {
    return source.model.tetrahedra.has_value();
}

}  // namespace

std::vector<BemFileRow> pointFileRows() {
    constexpr auto kHasSources = [](const Source& s) { return s.model.sources.has_value(); };
    return {
        {"electrodes.tsv", {"electrodes.tsv", "coordsystem.json"}, hasPoints, bidsFiles},
        {"electrodes.elc", {"electrodes.elc"}, hasPoints, elcFile},
        {"electrodes.sfp",
         {"electrodes.sfp"},
         hasPoints,
         [](const Source& s, const Files& files) {
             return pointFile(s, files, writeSfp, pointsIn(s.options.frame, s), s.options.frame);
         }},
        {"electrodes-dig.fif",
         {"electrodes-dig.fif"},
         hasPoints,
         [](const Source& s, const Files& files) {
             return pointFile(s, files, writeFiffPoints, pointsIn(s.mriFrame(), s),
                              CoordinateFrame::TkRas);
         }},
        {"head-mri-trans.fif",
         {"head-mri-trans.fif"},
         [](const Source& s) { return s.hasLandmarks(); },
         headToMriFile},
        {"electrodes.txt",
         {"electrodes.txt"},
         [](const Source& s) { return s.model.electrodes && !s.model.electrodes->points.empty(); },
         electrodesText},
        {"dipoles.txt", {"dipoles.txt"}, kHasSources, dipolesText},
        {"sources-src.fif", {"sources-src.fif"}, kHasSources, sourcesFile},
        {"lead-field.mat",
         {"lead-field.mat"},
         [](const Source& s) { return s.model.leadField.has_value(); },
         leadFieldFile},
        {kFiffForward,
         {kFiffForward},
         [](const Source& s) { return s.model.leadField && !s.model.leadField->forward.empty(); },
         forwardFile},
        {"head.sfp", {"head.sfp"}, [](const Source& s) { return s.options.writesBesa; }, besaFile},
        {"tissue_index.txt",
         {"tissue_index.txt"},
         [](const Source& s) { return s.options.writesBemFmm; },
         tissueIndex},
        {"head.msh",
         {"head.msh"},
         hasTetrahedra,
         [](const Source& s, const Files& files) {
             return tetrahedraFile(s, files, [](const auto& mesh, auto regions, const auto& path) {
                 writeMsh22(mesh, regions, path, true);
             });
         }},
        {"head-4.1.msh",
         {"head-4.1.msh"},
         hasTetrahedra,
         [](const Source& s, const Files& files) { return tetrahedraFile(s, files, writeMsh41); }},
        {"head.vtu",
         {"head.vtu"},
         hasTetrahedra,
         [](const Source& s, const Files& files) {
             return tetrahedraFile(
                 s, files, [](const auto& mesh, auto, const auto& path) { writeVtu(mesh, path); });
         }},
        {"head.dgf",
         {"head.dgf"},
         hasTetrahedra,
         [](const Source& s, const Files& files) {
             return tetrahedraFile(
                 s, files,
                 [](const auto& mesh, auto regions, const auto& path) {
                     writeDgf(mesh, allTissues(regions.size()), path);
                 },
                 true);
         }},
        {"head.cond", {"head.cond"}, hasTetrahedra, [](const Source& s, const Files& files) {
             return tableFile(
                 s, files,
                 {1, tissueConductivities(s.model.options.conductivities, s.model.meshes.size())},
                 formatNumber);
         }}};
}

}  // namespace adaptiso

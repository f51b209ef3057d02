#include "adaptiso/MeshIO/PointFiles.h"

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "Bytes.h"
#include "Counts.h"
#include "Fiff.h"
#include "PointCodec.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/ParseJson.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextCells.h"
#include "adaptiso/Core/TextLines.h"

namespace adaptiso {

using namespace meshio;
using Json = nlohmann::json;

namespace {

constexpr std::string_view kAxes = "xyz";

/// Names stand for channels, so each is to be there once. Head points are numbered only.
void requireOneEach(const PointFile& file) {
    std::set<std::string_view> names;
    const auto require = [&](const std::string& name) {
        if (names.insert(name).second) return;
        unsupported("two of its points have the name " + printable(name),
                    "rename or remove one of them");
    };
    for (const NamedPoint& point : file.points) {
        if (point.kind != PointKind::Other) require(point.name);
    }
    for (const std::string& name : file.placeless) require(name);
}

/// Frames that BIDS names; most others follow from landmarks.
std::optional<CoordinateFrame> bidsFrame(std::string_view name) {
    const std::string lower = lowerCase(name);
    if (lower == "scanras") return CoordinateFrame::Ras;
    if (lower == "scanlps" || lower == "dicom") return CoordinateFrame::Lps;
    return std::nullopt;
}

std::string textOf(const Json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

bool isNothing(const Json& value) {
    return value.is_null() || (value.is_string() && isMissing(value.get<std::string>()));
}

/// NaN where the value is "n/a".
Vec3 vectorOf(const Json& value) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    if (isNothing(value)) return {kNone, kNone, kNone};
    if (!value.is_array() || value.size() != 3 ||
        !std::ranges::all_of(value, [](const Json& n) { return n.is_number() || isNothing(n); })) {
        damaged("a landmark of its coordinate system has no three numbers");
    }
    Vec3 vector;
    for (int a = 0; a < 3; ++a) {
        const Json& number = value[static_cast<std::size_t>(a)];
        vector[a] = number.is_number() ? number.get<double>() : kNone;
    }
    return vector;
}

/// Adds unit, frame and landmarks from _coordsystem.json.
void applyCoordinateSystem(const std::string& text, PointFile& file) {
    if (const std::string fault = faultOfText(text); !fault.empty()) {
        throw FileError("its coordinate system (_coordsystem.json) " + fault);
    }
    const Json json = parseJson<Json>(text);
    if (!json.is_object()) damaged("its coordinate system (_coordsystem.json) is no JSON object");
    file.frameName = textOf(json, "EEGCoordinateSystem");
    file.frame = bidsFrame(file.frameName);
    const std::string unit = textOf(json, "EEGCoordinateUnits");
    if (!unit.empty() && lowerCase(unit) != "n/a") scalePoints(file, unitMm(unit));
    const std::string own = textOf(json, "AnatomicalLandmarkCoordinateSystem");
    if (!own.empty() && own != file.frameName) return;  // of another space
    const auto landmarks = json.find("AnatomicalLandmarkCoordinates");
    if (landmarks == json.end() || !landmarks->is_object()) return;
    const std::string landmarkUnit = textOf(json, "AnatomicalLandmarkCoordinateUnits");
    const std::string& used = landmarkUnit.empty() ? unit : landmarkUnit;
    const double mm = file.saysUnit && !used.empty() ? unitMm(used) : 1;
    for (const auto& [name, value] : landmarks->items()) {
        const PointKind kind = kindOf(name);
        if (kind != PointKind::Electrode) addPoint(file, name, mm * vectorOf(value), kind);
    }
}

/// Three words and no more; all of them "n/a" or the like where a point has no place.
Vec3 placeOf(ByteSource& words, std::string_view name, std::int64_t line) {
    Vec3 point;
    for (int a = 0; a < 3; ++a) {
        const std::string_view word = words.word();
        if (word.empty()) {
            damaged(linePlace(line) + "a point has " + std::to_string(a) +
                    " coordinates, must have 3");
        }
        point[a] = coordinate(word, kAxes.substr(static_cast<std::size_t>(a), 1), name, line);
    }
    if (const std::string_view more = words.word(); !more.empty() && more.front() != '#') {
        unsupported(linePlace(line) + "behind the three coordinates of " + printable(name) +
                        " stands " + printable(more),
                    "give x, y and z alone, and names without blanks");
    }
    return point;
}

/// The number of "NumberPositions= 3"; empty where none stands.
std::optional<std::int64_t> countOf(std::string_view line, std::string_view key) {
    const std::size_t digits = line.find_first_of("0123456789+-");
    if (digits == line.npos) return std::nullopt;
    return toInteger(line.substr(digits), key);
}

void requireCount(std::optional<std::int64_t> count, std::size_t there, const char* what) {
    if (!count || *count == static_cast<std::int64_t>(there)) return;
    unsupported(
        "it counts " + std::to_string(*count) + " " + what + " and holds " + std::to_string(there),
        "get the file again, or correct the count");
}

/// Labels may lack the blanks of names ("Oz 1" is "Oz1").
bool areSameName(std::string_view name, std::string_view label) {
    const auto plain = [](std::string_view text) {
        std::string letters;
        for (const char c : text) {
            if (c != ' ' && c != '\t' && c != '_') letters += c;
        }
        return letters;
    };
    return plain(name) == plain(label);
}

/// Newer files name the positions, and hold them in a plane and the head's shape as well.
PointFile decodeElc(std::string_view bytes) {
    TextLines lines(bytes);
    PointFile file;
    file.format = "ASA .elc";
    std::vector<std::string> names, labels;
    std::vector<Vec3> points, shape;
    double mm = 0, shapeMm = 0;
    std::optional<std::int64_t> positionCount, shapeCount;
    enum { Header, Positions, Labels, Shape } part = Header;
    while (const auto whole = lines.next()) {
        const std::string_view line = trimmed(*whole);
        if (line.empty() || line.front() == '#') continue;
        ByteSource words(line);
        const std::string_view first = words.word();
        if (first == "UnitPosition") {
            mm = unitMm(words.requireWord("a unit"));
        } else if (first == "UnitHeadShapePoints") {
            shapeMm = unitMm(words.requireWord("a unit"));
        } else if (first == "Positions") {
            part = Positions;
        } else if (first == "Labels") {
            part = Labels;
        } else if (first == "HeadShapePoints") {
            part = Shape;
        } else if (first.starts_with("NumberPositions")) {
            positionCount = countOf(line, "NumberPositions");
        } else if (first.starts_with("NumberHeadShapePoints")) {
            shapeCount = countOf(line, "NumberHeadShapePoints");
            part = Header;
        } else if (first == "Positions2D" || first == "Polygons" ||
                   first.starts_with("NumberPolygons")) {
            part = Header;
        } else if (part == Positions || part == Shape) {
            const std::size_t colon = line.find(':');
            const std::string_view name = trimmed(line.substr(0, colon == line.npos ? 0 : colon));
            if (part == Positions && colon != line.npos) names.emplace_back(name);
            ByteSource numbers(colon == line.npos ? line : line.substr(colon + 1));
            (part == Positions ? points : shape).push_back(placeOf(numbers, name, lines.number()));
        } else if (part == Labels) {
            for (std::string_view word = first; !word.empty(); word = words.word()) {
                labels.emplace_back(word);
            }
        }
        if (std::max(points.size() + shape.size(), labels.size()) > kMostPoints) {
            damaged("it holds more than 100,000 points");
        }
    }
    requireCount(positionCount, points.size(), "positions");
    requireCount(shapeCount, shape.size(), "head shape points");
    if (names.empty()) names = labels;
    if (names.size() != points.size() || (!labels.empty() && labels.size() != points.size())) {
        damaged("it has " + std::to_string(points.size()) + " positions and " +
                std::to_string(labels.empty() ? names.size() : labels.size()) + " labels");
    }
    for (std::size_t n = 0; n < points.size(); ++n) {
        if (!labels.empty() && !areSameName(names[n], labels[n])) {
            unsupported("the position " + std::to_string(n + 1) + " is of " + printable(names[n]) +
                            ", its label is " + printable(labels[n]),
                        "give names and labels in one order");
        }
        addPoint(file, names[n], points[n], kindOf(names[n]));
    }
    const double shapeUnits = mm > 0 && shapeMm > 0 ? shapeMm / mm : 1;
    for (std::size_t n = 0; n < shape.size(); ++n) {
        addPoint(file, "extra" + std::to_string(n + 1), shapeUnits * shape[n], PointKind::Other);
    }
    if (mm > 0) scalePoints(file, mm);
    return file;
}

/// Colons stand between names; MNE writes others so.
std::string withoutColons(std::string name) {
    for (std::size_t at = name.find(':'); at != name.npos; at = name.find(':', at)) {
        name.replace(at, 1, "{COLON}");
    }
    return name;
}

/// Channels of raw data lie where their electrode does. Of several at one place, as T3 and T7, each
/// is taken once.
std::optional<std::string> channelAt(const fiff::Content& content, const Vec3& metres,
                                     std::set<std::string>& taken) {
    for (const fiff::Tag& tag : content.tags) {
        if (tag.kind != fiff::kChannelInfo) continue;
        const fiff::Channel channel = fiff::toChannel(tag);
        constexpr std::int32_t kEeg = 2;
        constexpr double kSameMetres = 1e-6;
        if (channel.kind != kEeg || norm(channel.metres - metres) >= kSameMetres) continue;
        std::string name = toUtf8(channel.name);
        if (taken.insert(name).second) return name;
    }
    return std::nullopt;
}

/// The points of the first digitizer block.
PointFile decodeFiff(std::string_view bytes) {
    const fiff::Content content = fiff::decode(bytes);
    PointFile file;
    file.format = "FIFF digitizer points";
    const auto tags = static_cast<std::int64_t>(content.tags.size());
    requireNoMore({"tags", tags, static_cast<std::int64_t>(bytes.size())}, content.behind,
                  file.warnings);
    std::size_t block = 1;
    while (block < content.blocks.size() && content.blocks[block].kind != fiff::kIsotrak) ++block;
    if (block >= content.blocks.size()) {
        unsupported("it holds no digitizer points", "give a file of electrodes");
    }
    std::int32_t frame = fiff::kFrameHead;
    if (const fiff::Tag* tag = content.find(block, fiff::kMneCoordFrame)) frame = fiff::toInt(*tag);
    if (frame == fiff::kFrameMri) file.frame = CoordinateFrame::TkRas;
    file.frameName = frame == fiff::kFrameMri    ? "MRI"
                     : frame == fiff::kFrameHead ? "head"
                                                 : "FIFF frame " + std::to_string(frame);
    std::vector<std::string> names;  // of electrodes, in their order
    if (const fiff::Tag* tag = content.find(block, fiff::kMneChannelNames)) {
        std::istringstream list{toUtf8(tag->data)};
        for (std::string name; std::getline(list, name, ':');) names.push_back(name);
    }
    std::size_t electrodes = 0;
    std::set<std::string> taken;
    for (const fiff::Tag& tag : content.tags) {
        if (tag.block != block || tag.kind != fiff::kDigPoint) continue;
        const fiff::DigitizedPoint point = fiff::toPoint(tag);
        constexpr std::int32_t kCardinal = 1, kElectrode = 3;
        std::string digits = std::to_string(point.number);
        if (digits.size() < 3) digits.insert(0, 3 - digits.size(), '0');
        if (point.kind == kCardinal && point.number >= 1 && point.number <= 3) {
            constexpr std::array<const char*, 3> kNames{"LPA", "Nasion", "RPA"};
            const char* const name = kNames[static_cast<std::size_t>(point.number - 1)];
            addPoint(file, name, point.metres, kindOf(name));
        } else if (point.kind == kElectrode) {
            const std::string name =
                electrodes < names.size() && !names[electrodes].empty()
                    ? names[electrodes]
                    : channelAt(content, point.metres, taken).value_or("EEG" + digits);
            ++electrodes;
            addPoint(file, name, point.metres, PointKind::Electrode);
        } else {
            addPoint(file, "extra" + digits, point.metres, PointKind::Other);
        }
    }
    scalePoints(file, kMetreMm);
    return file;
}

struct PointFormat {
    std::string_view extension;
    PointFile (*decode)(std::string_view);
    bool isText = true;
};

constexpr PointFormat kFormats[] = {{".tsv", decodePointTable},
                                    {".csv", decodePointTable},
                                    {".ced", decodePointTable},
                                    {".elc", decodeElc},
                                    {".sfp", decodeSfp},
                                    {".fif", decodeFiff, false},
                                    {".loc", decodeLoc},
                                    {".locs", decodeLoc},
                                    {".eloc", decodeLoc},
                                    {".xyz", decodeXyz},
                                    {".elp", decodeElp},
                                    {".hsp", decodeElp},
                                    {".pos", decodePos},
                                    {".hpts", decodeHpts},
                                    {".csd", decodeCsd},
                                    {".txt", decodePointText},
                                    {".bvef", decodeBrainVision, false},
                                    {".bvct", decodeBrainVision, false}};

PointFile decoded(std::string_view bytes, std::string_view extension) {
    const auto format = std::ranges::find(kFormats, extension, &PointFormat::extension);
    if (format == std::end(kFormats)) {
        unsupported("electrodes are not read from '" + std::string(extension) + "' files",
                    "give " + pointExtensions());
    }
    if (!format->isText) return format->decode(bytes);
    if (const std::string fault = faultOfText(bytes); !fault.empty()) throw FileError(fault);
    return format->decode(toUtf8(bytes));
}

/// "sub-1_electrodes.tsv" -> "sub-1_coordsystem.json"; BIDS may leave out what is the same for all.
std::optional<std::string> coordinateSystemBeside(const std::filesystem::path& tsv) {
    namespace fs = std::filesystem;
    std::string stem = tsv.stem().string();
    const std::string suffix = "electrodes";
    if (!stem.ends_with(suffix)) return std::nullopt;
    stem.resize(stem.size() - suffix.size());
    std::vector<fs::path> tried{tsv.parent_path() / (stem + "coordsystem.json")};
    const std::size_t space = stem.find("_space-");
    if (space != stem.npos) {
        tried.push_back(tsv.parent_path() / (stem.substr(0, space) + "_coordsystem.json"));
    }
    std::error_code error;
    for (const fs::path& path : tried) {
        if (!fs::is_regular_file(path, error)) continue;
        requireBeside(path, tsv);
        return readBytes(path);
    }
    return std::nullopt;
}

const char* bidsName(CoordinateFrame frame) {
    return frame == CoordinateFrame::Ras ? "ScanRAS" : "Other";
}

Json numbersOf(const Vec3& p) {
    return {p.x, p.y, p.z};
}

std::string coordinateSystemText(std::span<const NamedPoint> points, CoordinateFrame frame) {
    Json json{{"EEGCoordinateSystem", bidsName(frame)}, {"EEGCoordinateUnits", "mm"}};
    const std::string description = frameMarker(frame);
    if (frame != CoordinateFrame::Ras) json["EEGCoordinateSystemDescription"] = description;
    Json landmarks = Json::object();
    for (const NamedPoint& point : points) {
        if (point.kind == PointKind::Nasion) landmarks["NAS"] = numbersOf(point.point);
        if (point.kind == PointKind::LeftEar) landmarks["LPA"] = numbersOf(point.point);
        if (point.kind == PointKind::RightEar) landmarks["RPA"] = numbersOf(point.point);
    }
    if (!landmarks.empty()) {
        json["AnatomicalLandmarkCoordinates"] = landmarks;
        json["AnatomicalLandmarkCoordinateSystem"] = bidsName(frame);
        json["AnatomicalLandmarkCoordinateUnits"] = "mm";
    }
    return json.dump(2) + "\n";
}

}  // namespace

std::string pointExtensions() {
    std::string list;
    for (const PointFormat& format : kFormats) {
        list.append(list.empty() ? "" : ", ").append(format.extension);
    }
    return list;
}

PointFile decodePoints(std::string_view bytes, std::string_view extension, std::string_view name,
                       const std::optional<std::string>& coordinateSystem) {
    return meshio::naming(name, [&] {
        PointFile file = decoded(bytes, extension);
        requireOneEach(file);
        if (coordinateSystem) applyCoordinateSystem(*coordinateSystem, file);
        if (!file.points.empty()) return file;
        if (file.placeless.empty()) damaged("it holds no point");
        unsupported("none of its " + std::to_string(file.placeless.size()) + " points has a place",
                    "give a file with coordinates");
    });
}

PointFile readPoints(const std::filesystem::path& path) {
    const std::string extension = lowerCase(path.extension().string());
    std::optional<std::string> coordinateSystem;
    if (extension == ".tsv") coordinateSystem = coordinateSystemBeside(path);
    return decodePoints(readBytes(path), extension, path.string(), coordinateSystem);
}

void writeBidsElectrodes(std::span<const NamedPoint> points, const std::filesystem::path& tsv,
                         const std::filesystem::path& json, CoordinateFrame frame) {
    writeBytes(tsv, [&](ByteSink& sink) {
        sink << "name\tx\ty\tz\n";
        for (const NamedPoint& point : points) {
            if (point.kind != PointKind::Electrode) continue;
            const Vec3& p = point.point;
            sink << writtenCell(point.name) << "\t" << p.x << "\t" << p.y << "\t" << p.z << "\n";
        }
    });
    writeBytes(json, [&](ByteSink& sink) { sink << coordinateSystemText(points, frame); });
}

void writeElc(std::span<const NamedPoint> points, const std::filesystem::path& path) {
    writeBytes(path, [&](ByteSink& sink) {
        sink << "# ASA electrode file\nReferenceLabel avg\nUnitPosition mm\nNumberPositions= "
             << static_cast<std::int64_t>(points.size()) << "\nPositions\n";
        for (const NamedPoint& point : points) sink << point.point << "\n";
        sink << "Labels\n";
        for (const NamedPoint& point : points) {
            // words are between spaces; MNE looks for Nz
            std::string name = point.kind == PointKind::Nasion ? "Nz" : point.name;
            std::replace(name.begin(), name.end(), ' ', '_');
            sink << name << "\n";
        }
    });
}

void writeSfp(std::span<const NamedPoint> points, const std::filesystem::path& path) {
    writeBytes(path, [&](ByteSink& sink) {
        for (const NamedPoint& point : points) {
            std::string name = point.name;
            std::replace(name.begin(), name.end(), ' ', '_');
            if (point.kind == PointKind::Nasion) name = "FidNz";
            if (point.kind == PointKind::LeftEar) name = "FidT9";
            if (point.kind == PointKind::RightEar) name = "FidT10";
            sink << name << "\t" << point.point.x << "\t" << point.point.y << "\t" << point.point.z
                 << "\n";
        }
    });
}

void writeFiffPoints(std::span<const NamedPoint> points, const std::filesystem::path& path) {
    writeBytes(path, [&](ByteSink& sink) {
        fiff::Writer writer(sink);
        writer.begin(fiff::kIsotrak);
        writer.put(fiff::kMneCoordFrame, fiff::kFrameMri);
        std::int32_t electrodes = 0, others = 0;
        std::string names;  // of the electrodes, as MNE 1.9 and newer take them
        for (const NamedPoint& point : points) {
            const Vec3 metres = (1 / kMetreMm) * point.point;
            constexpr std::int32_t kCardinal = 1, kElectrode = 3, kExtra = 4;
            switch (point.kind) {
                case PointKind::LeftEar:
                    writer.putPoint(kCardinal, 1, metres);
                    break;
                case PointKind::Nasion:
                    writer.putPoint(kCardinal, 2, metres);
                    break;
                case PointKind::RightEar:
                    writer.putPoint(kCardinal, 3, metres);
                    break;
                case PointKind::Electrode:
                    writer.putPoint(kElectrode, ++electrodes, metres);
                    names += (names.empty() ? "" : ":") + withoutColons(point.name);
                    break;
                case PointKind::Other:
                    writer.putPoint(kExtra, ++others, metres);
                    break;
            }
        }
        if (!names.empty()) writer.put(fiff::kMneChannelNames, std::string_view(names));
        writer.end(fiff::kIsotrak);
        writer.finish();
    });
}

}  // namespace adaptiso

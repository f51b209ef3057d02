// Electrodes' files of words between blanks, one point a row.

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "Bytes.h"
#include "PointCodec.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextCells.h"
#include "adaptiso/Core/TextLines.h"

namespace adaptiso::meshio {
namespace {

std::vector<std::string_view> wordsOf(std::string_view line) {
    std::vector<std::string_view> words;
    ByteSource source(line);
    for (auto word = source.word(); !word.empty(); word = source.word()) words.push_back(word);
    return words;
}

bool isNumber(std::string_view word) {
    return parseReal(word).has_value();
}

/// Three words as a place.
Vec3 placeOf(std::span<const std::string_view> words, std::string_view name, std::int64_t line) {
    if (words.size() < 3) {
        damaged(linePlace(line) + "a point has " + std::to_string(words.size()) +
                " coordinates, must have 3");
    }
    Vec3 point;
    for (int a = 0; a < 3; ++a) {
        const std::string_view axis =
            std::string_view("xyz").substr(static_cast<std::size_t>(a), 1);
        point[a] = coordinate(words[static_cast<std::size_t>(a)], axis, name, line);
    }
    if (words.size() > 3 && words[3].front() != '#') {
        unsupported(linePlace(line) + "behind the three coordinates of " + printable(name) +
                        " stands " + printable(words[3]),
                    "give x, y and z alone, and names without blanks");
    }
    return point;
}

/// Calls take(words, line number) for each row that is neither empty nor a comment.
template <class Take>
void forEachRow(std::string_view bytes, std::string_view comment, const Take& take) {
    TextLines lines(bytes);
    while (const auto whole = lines.next()) {
        const std::string_view line = trimmed(*whole);
        if (line.empty() || line.starts_with('#') || line.starts_with(comment)) continue;
        take(wordsOf(line), lines.number());
    }
}

/// What the words of a row are, a letter each: a its name, x y z or t (EEGLAB's angle) r (radius);
/// - is passed over, and so are more words.
PointFile decodeRows(std::string_view bytes, const char* format, std::string_view layout,
                     std::string_view comment = "#") {
    PointFile file;
    file.format = format;
    forEachRow(bytes, comment, [&](const std::vector<std::string_view>& words, std::int64_t line) {
        if (words.size() < layout.size()) {
            unsupported(linePlace(line) + "a row has " + std::to_string(words.size()) +
                            " words, must have " + std::to_string(layout.size()),
                        "give each row the words of this format");
        }
        const std::string_view name = words[layout.find('a')];
        const auto number = [&](char what) {
            return coordinate(words[layout.find(what)], std::string_view(&what, 1), name, line);
        };
        const Vec3 place = layout.find('t') != layout.npos
                               ? polarPlace(number('t'), number('r'))
                               : Vec3{number('x'), number('y'), number('z')};
        addPoint(file, name, place, kindOf(name));
    });
    return file;
}

/// Polhemus: "%F" leads nasion, left and right ear, "%N" a name; places stand in rows of their own.
PointFile decodePolhemus(std::string_view bytes) {
    constexpr std::array kFiducials{"Nasion", "LPA", "RPA"};
    PointFile file;
    file.format = "Polhemus";
    std::size_t fiducials = 0;
    std::string_view name;
    forEachRow(bytes, "//", [&](const std::vector<std::string_view>& words, std::int64_t line) {
        const std::span<const std::string_view> all(words);
        if (words[0] == "%F" && fiducials < kFiducials.size()) {
            const char* const fiducial = kFiducials[fiducials++];
            addPoint(file, fiducial, placeOf(all.subspan(1), fiducial, line), kindOf(fiducial));
            name = {};
        } else if (words[0] == "%N" && words.size() > 1) {
            name = words[1];
        } else if (words.size() == 3 && std::ranges::all_of(words, isNumber)) {
            const Vec3 place = placeOf(all, name, line);
            name.empty() ? addShapePoint(file, place) : addPoint(file, name, place, kindOf(name));
            name = {};
        }
    });
    return file;
}

/// BESA: [kind] name angle-from-vertex azimuth [radius], degrees.
PointFile decodeBesaElp(std::string_view bytes) {
    PointFile file;
    file.format = "BESA .elp";
    forEachRow(bytes, "#", [&](const std::vector<std::string_view>& words, std::int64_t line) {
        const bool hasKind = words.size() == 5 || (words.size() == 4 && !isNumber(words[1]));
        const std::size_t first = hasKind ? 1 : 0;
        if (words.size() < first + 3 || words.size() > first + 4) {
            unsupported(linePlace(line) + "a row has " + std::to_string(words.size()) + " words",
                        "BESA's have a name and two angles");
        }
        const std::string_view name = words[first];
        addPoint(file, name,
                 sphericalPlace(coordinate(words[first + 1], "theta", name, line),
                                coordinate(words[first + 2], "phi", name, line)),
                 kindOf(name));
    });
    return file;
}

/// What stands before the first tab where three words follow it: then blanks are part of the name.
/// Else the first word.
std::string_view nameOf(std::string_view line) {
    const std::size_t tab = line.find('\t');
    if (tab != line.npos && wordsOf(line.substr(tab)).size() == 3) {
        return trimmed(line.substr(0, tab));
    }
    return ByteSource(line).word();
}

}  // namespace

PointFile decodeXyz(std::string_view bytes) {
    return decodeRows(bytes, "EEGLAB .xyz", "-xyza");
}

PointFile decodeLoc(std::string_view bytes) {
    PointFile file = decodeRows(bytes, "EEGLAB .loc", "-tra", "%");
    for (NamedPoint& point : file.points) {  // dots fill names up to four characters
        const std::size_t end = point.name.find_last_not_of('.');
        if (end != point.name.npos) point.name.resize(end + 1);
        point.kind = kindOf(point.name);
    }
    return file;
}

PointFile decodeCsd(std::string_view bytes) {
    return decodeRows(bytes, "CSD Toolbox .csd", "a---xyz", "//");
}

PointFile decodeHpts(std::string_view bytes) {
    PointFile file;
    file.format = "MNE .hpts";
    forEachRow(bytes, "#", [&](const std::vector<std::string_view>& words, std::int64_t line) {
        const std::string kind = lowerCase(words[0]);
        const std::string_view name = words.size() > 1 ? words[1] : std::string_view();
        const Vec3 place =
            placeOf(std::span(words).subspan(std::min<std::size_t>(2, words.size())), name, line);
        if (kind == "cardinal") {
            const char* const landmark = name == "1"   ? "LPA"
                                         : name == "2" ? "Nasion"
                                         : name == "3" ? "RPA"
                                                       : "";
            addPoint(file, landmark, place, kindOf(landmark));
        } else if (kind == "eeg") {
            addPoint(file, name, place, PointKind::Electrode);
        } else if (kind == "extra") {
            addShapePoint(file, place);
        } else if (kind != "hpi") {
            unsupported(linePlace(line) + "a row is of the kind " + printable(words[0]),
                        "it must be cardinal, eeg, extra or hpi");
        }
    });
    return file;
}

PointFile decodePos(std::string_view bytes) {
    PointFile file;
    file.format = "Polhemus .pos";
    forEachRow(bytes, "%", [&](const std::vector<std::string_view>& words, std::int64_t line) {
        if (words.size() == 1 && file.points.empty() && isNumber(words[0])) return;  // the count
        const std::span<const std::string_view> all(words);
        // a number, a name or both
        const bool hasBoth = words.size() > 4 && isNumber(words[0]);
        const std::string_view name = words[hasBoth ? 1 : 0];
        const Vec3 place = placeOf(all.subspan(hasBoth ? 2 : 1), name, line);
        const std::string lower = lowerCase(name);
        const PointKind kind = lower == "left"    ? PointKind::LeftEar
                               : lower == "right" ? PointKind::RightEar
                                                  : kindOf(name);
        !hasBoth&& isNumber(name) ? addShapePoint(file, place) : addPoint(file, name, place, kind);
    });
    return file;
}

PointFile decodeElp(std::string_view bytes) {
    const bool isPolhemus = bytes.find("%F") != bytes.npos || bytes.find("%N") != bytes.npos;
    return isPolhemus ? decodePolhemus(bytes) : decodeBesaElp(bytes);
}

PointFile decodeSfp(std::string_view bytes) {
    TextLines lines(bytes);
    PointFile file;
    file.format = "BESA .sfp";
    while (const auto whole = lines.next()) {
        const std::string_view line = trimmed(*whole);
        if (line.empty() || line.front() == '#') continue;
        const std::string_view name = nameOf(line);
        const Vec3 place = placeOf(wordsOf(line.substr(name.size())), name, lines.number());
        lowerCase(name) == "headshape" ? addShapePoint(file, place)
                                       : addPoint(file, name, place, kindOf(name));
    }
    return file;
}

PointFile decodePointText(std::string_view bytes) {
    // a header of a table names columns; Polhemus FastSCAN's rows are places alone
    TextLines lines(bytes);
    const std::string first = lowerCase(lines.next().value_or(""));
    const std::vector<std::string_view> words = wordsOf(first);
    if (std::ranges::find(words, "theta") != words.end() ||
        std::ranges::find(words, "x") != words.end() || first.find(",x,") != first.npos) {
        return decodePointTable(bytes);
    }
    PointFile file;
    file.format = "text of points";
    forEachRow(bytes, "%", [&](const std::vector<std::string_view>& row, std::int64_t line) {
        const std::span<const std::string_view> all(row);
        if (row.size() == 3 && std::ranges::all_of(row, isNumber)) {
            addShapePoint(file, placeOf(all, "a point", line));
            return;
        }
        const std::size_t at = row.size() == 5 && isNumber(row[0]) ? 1 : 0;
        addPoint(file, row[at], placeOf(all.subspan(at + 1), row[at], line), kindOf(row[at]));
    });
    return file;
}

}  // namespace adaptiso::meshio

// Electrodes' tables, whose first line names the columns, and BrainVision's XML.

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "Bytes.h"
#include "PointCodec.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextCells.h"
#include "adaptiso/Core/TextLines.h"
#include "adaptiso/MeshIO/Xml.h"

namespace adaptiso::meshio {
namespace {

using CellTexts = std::vector<std::string>;

/// The column of this name, in whatever case.
std::optional<std::size_t> columnOf(const CellTexts& header, std::string_view name) {
    const auto isIt = [&](const std::string& cell) { return lowerCase(cell) == name; };
    const auto found = std::ranges::find_if(header, isIt);
    if (found == header.end()) return std::nullopt;
    if (std::any_of(found + 1, header.end(), isIt)) {
        unsupported("its first line names the column '" + std::string(name) + "' twice",
                    "rename or remove one of them");
    }
    return static_cast<std::size_t>(found - header.begin());
}

/// Which columns a table has its points in.
struct Columns {
    std::size_t name = 0;
    std::vector<std::string> axes{"x", "y", "z"};  ///< or angles
    std::vector<std::size_t> numbers{};            ///< of these
    Vec3 (*place)(const std::vector<double>&) = nullptr;
};

Columns columnsOf(const CellTexts& header) {
    const auto require = [&](std::string_view name) {
        if (const auto column = columnOf(header, name)) return *column;
        unsupported("its first line names no column '" + std::string(name) + "'",
                    "a table of electrodes begins with the columns name, x, y, z");
    };
    Columns columns;
    // as BIDS, EEGLAB, EASYCAP and Localite call it
    std::optional<std::size_t> name;
    for (const char* const word :
         {"name", "label", "labels", "site", "channel", "electrode", "id"}) {
        if (!name) name = columnOf(header, word);
    }
    columns.name = name ? *name : require("name");
    columns.place = [](const std::vector<double>& v) { return Vec3{v[0], v[1], v[2]}; };
    if (!columnOf(header, "x") && columnOf(header, "theta")) {
        const bool isPolar = columnOf(header, "radius") && !columnOf(header, "phi");
        columns.axes = {"theta", isPolar ? "radius" : "phi"};
        columns.place =
            isPolar ? [](const std::vector<double>& v) { return polarPlace(v[0], v[1]); }
                    : [](const std::vector<double>& v) { return sphericalPlace(v[0], v[1]); };
    }
    for (const std::string& axis : columns.axes) columns.numbers.push_back(require(axis));
    return columns;
}

/// Elements Name, and X, Y, Z or Theta, Phi, Radius, of each electrode.
class BrainVisionHandler : public XmlHandler {
public:
    explicit BrainVisionHandler(PointFile& file) : file_(file) {}

    void onStart(const std::string& element, const XmlAttributes&) override {
        if (isPoint(element)) values_.clear();
        text_.clear();
    }
    void onText(std::string_view text) override {
        constexpr std::size_t kMost = 1000;
        if (text_.size() < kMost) text_ += text;
    }
    void onEnd(const std::string& element) override {
        if (isPoint(element)) {
            add();
        } else {
            values_[element] = trimmed(text_);
        }
    }

private:
    static bool isPoint(const std::string& element) {
        return element == "Electrode" || element == "CapTrakElectrode";
    }
    double number(const char* key) { return coordinate(values_[key], key, values_["Name"], 0); }
    void add() {
        const std::string& name = values_["Name"];
        Vec3 place;
        if (values_.contains("X")) {
            place = {number("X"), number("Y"), number("Z")};
        } else {
            const double radius = number("Radius");
            place = radius * sphericalPlace(number("Theta"), number("Phi"));
            if (radius == 0) place.x = std::numeric_limits<double>::quiet_NaN();  // no place
        }
        addPoint(file_, name, place, kindOf(name));
    }

    PointFile& file_;
    std::map<std::string, std::string> values_;  ///< of the point being read
    std::string text_;
};

}  // namespace

PointFile decodePointTable(std::string_view bytes) {
    TextLines lines(bytes);
    PointFile file;
    file.format = "BIDS electrodes";
    const std::string_view first = lines.next().value_or("");
    // spreadsheets put commas or semicolons for BIDS's tabs
    const char separator = separatorOf(first);
    const auto cells = [&](std::string_view line) {
        if (separator == '\0') {
            CellTexts words;
            ByteSource source(line);
            for (auto word = source.word(); !word.empty(); word = source.word()) {
                words.emplace_back(word);
            }
            return words;
        }
        const auto found = cellsOf(line, separator);
        if (!found) unsupported(linePlace(lines.number()) + "a quote is not closed", "close it");
        return *found;
    };
    const CellTexts header = cells(first);
    const Columns columns = columnsOf(header);
    const std::size_t fewest = std::max(columns.name, std::ranges::max(columns.numbers)) + 1;
    bool hasComma = false, hasPoint = false;
    while (const auto line = lines.next()) {
        const CellTexts row = cells(*line);
        if (std::ranges::all_of(row, &std::string::empty)) continue;
        const auto isFilled = [](const std::string& cell) { return !cell.empty(); };
        const auto surplus = row.begin() + std::min(std::ssize(row), std::ssize(header));
        if (row.size() < fewest || std::any_of(surplus, row.end(), isFilled)) {
            unsupported(linePlace(lines.number()) + "a row has " + std::to_string(row.size()) +
                            " cells, the first line " + std::to_string(header.size()),
                        "give each row the cells that the first line names");
        }
        const std::string& name = row[columns.name];
        std::vector<double> numbers;
        for (std::size_t n = 0; n < columns.numbers.size(); ++n) {
            const std::string& cell = row[columns.numbers[n]];
            numbers.push_back(coordinate(cell, columns.axes[n], name, lines.number(), separator));
            hasComma = hasComma || cell.find(',') != cell.npos;
            hasPoint = hasPoint || cell.find('.') != cell.npos;
        }
        addPoint(file, name, columns.place(numbers), kindOf(name));
    }
    if (hasComma && hasPoint) {
        unsupported("its coordinates have decimal commas and decimal points",
                    "save it with decimal points alone");
    }
    return file;
}

PointFile decodeBrainVision(std::string_view bytes) {
    PointFile file;
    file.format = "BrainVision";
    BrainVisionHandler handler(file);
    parseXml(bytes, handler);
    return file;
}

}  // namespace adaptiso::meshio

#pragma once

#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "adaptiso/Json/Json.h"

namespace adaptiso {

/// How a page shows a figure.
enum class Shown {
    No,
    Plain,   ///< a number, or a text as it is
    Count,   ///< "12,345"
    Bound,   ///< rounded up: formatBound()
    Size,    ///< of three lengths: formatSizeMm()
    Measure  ///< an area or a volume: formatMeasure()
};

/// A reported figure: the report's JSON, the table of keys in the program's README and the tables
/// of its page are made from rows.
template <class Owner>
struct Figure {
    std::string_view key;      ///< "blocks.size" is `size` in the object `blocks`
    std::string_view meaning;  ///< in the README; empty: an object of rows of its own
    Json (*get)(const Owner&);
    std::string_view label{};  ///< a column of the page's table, with its unit: "Area, mm²"
    Shown shown = Shown::No;
};

template <class Owner>
using Figures = std::vector<Figure<Owner>>;

/// Puts a value in its place: "blocks.size". \pre no part of the key is a value already
void putFigure(Json& json, std::string_view key, Json value);

/// "–" for null. \pre shown is not No
std::string figureText(const Json& value, Shown shown);

template <class Owner>
Json figuresJson(const Figures<Owner>& rows, const std::type_identity_t<Owner>& owner) {
    Json json = Json::object();
    for (const Figure<Owner>& row : rows) putFigure(json, row.key, row.get(owner));
    return json;
}

/// The columns of a page's table; `columns` come first.
template <class Owner>
std::vector<std::string> figureColumns(std::vector<std::string> columns,
                                       const Figures<Owner>& rows) {
    for (const Figure<Owner>& row : rows) {
        if (row.shown != Shown::No) columns.emplace_back(row.label);
    }
    return columns;
}

/// A line of that table; `cells` come first.
template <class Owner>
std::vector<std::string> figureCells(std::vector<std::string> cells, const Figures<Owner>& rows,
                                     const std::type_identity_t<Owner>& owner) {
    for (const Figure<Owner>& row : rows) {
        if (row.shown != Shown::No) cells.push_back(figureText(row.get(owner), row.shown));
    }
    return cells;
}

/// The lines of a README's table of keys: "| `.genus` | handles of all components together |".
/// \param before  of each key: "."
template <class Owner>
std::string figureLines(const Figures<Owner>& rows, std::string_view before) {
    std::string text;
    for (const Figure<Owner>& row : rows) {
        if (row.meaning.empty()) continue;
        text.append("| `").append(before).append(row.key).append("` | ");
        text.append(row.meaning).append(" |\n");
    }
    return text;
}

}  // namespace adaptiso

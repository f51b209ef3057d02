#include "PageParts.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "Payload.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

/// A list of names and values under a heading.
std::string factList(const std::string& title, const std::vector<ReportFact>& facts) {
    if (facts.empty()) return "";
    std::string html = "<div>\n<h2>" + title + "</h2>\n<dl>\n";
    for (const auto& [name, value] : facts) {
        html += "<dt>" + escaped(name) + "</dt><dd>" + escaped(value) + "</dd>\n";
    }
    return html + "</dl>\n</div>\n";
}

struct OutcomeWords {
    const char *style, *text;
};

OutcomeWords wordsOf(ReportOutcome outcome) {
    switch (outcome) {
        case ReportOutcome::Passed:
            return {"passed", "✔ holds"};
        case ReportOutcome::Failed:
            return {"failed", "✘ FAILED"};
        case ReportOutcome::Noted:
            return {"noted", "▲ noted"};
        case ReportOutcome::Undecided:
            return {"undecided", "– undecided"};
    }
    throw InternalError("wordsOf: unknown outcome");
}

std::string pointText(const Vec3& rasMm) {
    char text[96];
    std::snprintf(text, sizeof text, "%.1f, %.1f, %.1f", rasMm.x, rasMm.y, rasMm.z);
    return text;
}

std::string checkRow(const ReportCheck& check) {
    const OutcomeWords words = wordsOf(check.outcome);
    return std::string("<tr><td class=\"outcome ") + words.style + "\">" + words.text +
           "</td><th scope=\"row\">" + escaped(check.name) + "</th><td>" + escaped(check.subject) +
           "</td><td>" + escaped(check.finding) + "</td></tr>\n";
}

std::string checkTable(const std::vector<const ReportCheck*>& checks) {
    std::string html =
        "<div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\">Result</th><th scope=\"col\">"
        "Question</th><th scope=\"col\">Of</th><th "
        "scope=\"col\">Found</th></tr></thead>\n<tbody>\n";
    for (const ReportCheck* check : checks) html += checkRow(*check);
    return html + "</tbody>\n</table></div>\n";
}

std::string tableHtml(const ReportTable& table) {
    std::string html =
        "<h3>" + escaped(table.title) + "</h3>\n<div class=\"scroll\"><table>\n<thead><tr>";
    for (const std::string& column : table.columns) {
        html += "<th scope=\"col\">" + escaped(column) + "</th>";
    }
    html += "</tr></thead>\n<tbody>\n";
    for (const std::vector<std::string>& row : table.rows) {
        html += "<tr>";
        for (std::size_t n = 0; n < row.size(); ++n) {
            html += n == 0 ? "<th scope=\"row\">" + escaped(row[n]) + "</th>"
                           : "<td>" + escaped(row[n]) + "</td>";
        }
        html += "</tr>\n";
    }
    return html + "</tbody>\n</table></div>\n";
}

}  // namespace

std::string escaped(const std::string& text) {
    using nlohmann::json;
    const std::string valid =
        json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace));
    std::string html;
    for (const char c : valid) {
        switch (c) {
            case '&':
                html += "&amp;";
                break;
            case '<':
                html += "&lt;";
                break;
            case '>':
                html += "&gt;";
                break;
            case '"':
                html += "&quot;";
                break;
            case '\'':
                html += "&#39;";
                break;
            default:
                if (static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\t') {
                    html += "\uFFFD";
                } else {
                    html += c;
                }
        }
    }
    return html;
}

std::string factsHtml(const Report& report) {
    std::vector<ReportFact> how = report.options;
    how.push_back({"Made by", report.program + " " + report.version + ", " + report.date});
    return factList("What was read", report.inputs) + factList("How", how);
}

std::string spotsHtml(const Scene& scene, bool hasViewer) {
    if (scene.spots.empty()) return "";
    std::string html =
        "<section aria-labelledby=\"spots-title\">\n<h2 id=\"spots-title\">Where to look</h2>\n";
    if (hasViewer) html += "<p>A click moves the crosshair of the viewer below to the place.</p>\n";
    html += "<ol class=\"spots\">\n";
    for (std::size_t n = 0; n < scene.spots.size(); ++n) {
        const SceneSpot& spot = scene.spots[n];
        const std::string where = "<span class=\"where\">(" + pointText(spot.pointMm) + ")</span>";
        const std::string what = escaped(spot.what);
        html += std::string("<li") + (spot.isFailure ? "" : " class=\"worth\"") +
                "><span class=\"number\">" + std::to_string(n + 1) +
                ".</span><span><span class=\"kind\">" + (spot.isFailure ? "✘ fails:" : "look:") +
                "</span> ";
        html += hasViewer ? "<button type=\"button\" data-spot=\"" + std::to_string(n) + "\">" +
                                what + "</button> " + where
                          : what + " " + where;
        html += "</span></li>\n";
    }
    return html + "</ol>\n</section>\n";
}

std::string checksHtml(const Report& report) {
    if (report.checks.empty()) return "<div id=\"checks\"></div>\n";
    std::vector<const ReportCheck*> first, rest;
    for (const ReportCheck& check : report.checks) {
        const bool isBad =
            check.outcome == ReportOutcome::Failed || check.outcome == ReportOutcome::Noted;
        (isBad ? first : rest).push_back(&check);
    }
    std::stable_sort(first.begin(), first.end(), [](const auto* a, const auto* b) {
        return a->outcome == ReportOutcome::Failed && b->outcome != ReportOutcome::Failed;
    });
    std::string html =
        "<section id=\"checks\" aria-labelledby=\"checks-title\">\n<h2 "
        "id=\"checks-title\">Checks</h2>\n";
    if (!first.empty()) html += checkTable(first);
    if (!rest.empty()) {
        html += "<details" + std::string(first.empty() ? " open" : "") + "><summary>" +
                std::to_string(rest.size()) + (first.empty() ? " checks" : " more checks") +
                "</summary>\n" + checkTable(rest) + "</details>\n";
    }
    return html + "</section>\n";
}

std::string tablesHtml(const Report& report) {
    if (report.tables.empty()) return "";
    std::string html =
        "<section aria-labelledby=\"tables-title\">\n<h2 id=\"tables-title\">Numbers</h2>\n";
    for (const ReportTable& table : report.tables) html += tableHtml(table);
    return html + "</section>\n";
}

std::string picturesHtml(const std::vector<Picture>& pictures) {
    if (pictures.empty()) return "";
    std::string html =
        "<section aria-labelledby=\"pictures-title\">\n<h2 "
        "id=\"pictures-title\">Pictures</h2>\n";
    for (const Picture& picture : pictures) {
        html += "<figure><img alt=\"" + escaped(picture.altText) + "\" width=\"" +
                std::to_string(picture.width) + "\" height=\"" + std::to_string(picture.height) +
                "\" src=\"data:image/png;base64," + base64(picture.png) + "\"><figcaption>" +
                escaped(picture.title) + "</figcaption></figure>\n";
    }
    return html + "</section>\n";
}

std::string notesHtml(const std::vector<std::string>& notes) {
    if (notes.empty()) return "";
    std::string html =
        "<section class=\"notes\" aria-labelledby=\"notes-title\">\n<h2 "
        "id=\"notes-title\">Notes</h2>\n<ul>\n";
    for (const std::string& note : notes) html += "<li>" + escaped(note) + "</li>\n";
    return html + "</ul>\n</section>\n";
}

}  // namespace adaptiso

#include "PageParts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

struct OutcomeWords {
    const char *style, *text;
};

OutcomeWords wordsOf(ReportOutcome outcome) {
    static constexpr OutcomeWords kWords[] = {{"passed", "✔ holds"},
                                              {"failed", "✘ FAILED"},
                                              {"noted", "▲ noted"},
                                              {"undecided", "– undecided"}};
    return kWords[static_cast<std::size_t>(outcome)];
}

std::string pointText(const Vec3& rasMm) {
    return formatFixed(rasMm.x, 1) + ", " + formatFixed(rasMm.y, 1) + ", " +
           formatFixed(rasMm.z, 1);
}

std::string checkRow(const ReportCheck& check) {
    const OutcomeWords words = wordsOf(check.outcome);
    return std::string("<tr><td class=\"outcome ") + words.style + "\">" + words.text +
           "</td><th scope=\"row\">" + escaped(check.name) + "</th>" + cell("Of", check.subject) +
           cell("Found", check.finding) + "</tr>\n";
}

std::string checkTable(const std::string& label, const std::vector<const ReportCheck*>& checks) {
    std::string html =
        "<table>\n<thead><tr><th scope=\"col\">Result</th><th scope=\"col\">"
        "Question</th><th scope=\"col\">Of</th><th "
        "scope=\"col\">Found</th></tr></thead>\n<tbody>\n";
    for (const ReportCheck* check : checks) html += checkRow(*check);
    return scrollable(label, html + "</tbody>\n</table>");
}

std::string tableHtml(const ReportTable& table) {
    std::string html = "<table>\n<thead><tr>";
    for (const std::string& column : table.columns) {
        html += "<th scope=\"col\">" + escaped(column) + "</th>";
    }
    html += "</tr></thead>\n<tbody>\n";
    for (const std::vector<std::string>& row : table.rows) {
        html += "<tr>";
        for (std::size_t n = 0; n < row.size(); ++n) {
            html += n == 0 ? "<th scope=\"row\">" + escaped(row[n]) + "</th>"
                           : cell(n < table.columns.size() ? table.columns[n] : "", row[n]);
        }
        html += "</tr>\n";
    }
    return "<h3>" + escaped(table.title) + "</h3>\n" +
           scrollable("Table: " + table.title, html + "</tbody>\n</table>");
}

}  // namespace

std::string failuresHtml(const Report& report) {
    std::string html;
    std::size_t failed = 0;
    for (const ReportCheck& check : report.checks) {
        if (check.outcome != ReportOutcome::Failed || ++failed > kNamed) continue;
        html += "<li><strong>" + escaped(check.name) + "</strong>: " + escaped(check.subject) +
                (check.finding.empty() ? "" : ", " + escaped(check.finding)) + "</li>\n";
    }
    return bannerList("What failed", html, failed, "checks");
}

std::string warningsHtml(const Report& report) {
    std::string html;
    for (std::size_t n = 0; n < std::min(report.warnings.size(), kNamed); ++n) {
        html += "<li><strong>Warning</strong>: " + escaped(report.warnings[n]) + "</li>\n";
    }
    return bannerList("Warnings", html, report.warnings.size(), "notes");
}

std::string faceHtml(const Report& report, const Scene& scene) {
    if (scene.surfaces.empty() && !report.volume) return "";
    const std::string begin = "<p class=\"face\"><strong>Faces.</strong> ";
    if (scene.face && scene.face->hidesAll()) {
        return begin +
               "Left out (<code>--deface-report</code>). Where the face lies could not be told, "
               "since " +
               escaped(scene.face->reason()) +
               ": neither the image nor a surface is shown that may hold it.</p>\n";
    }
    if (scene.face) {
        return begin +
               "Left out (<code>--deface-report</code>): of the image and of the surfaces "
               "nothing is shown below a plane that begins " +
               std::to_string(std::lround(scene.face->belowTopMm())) +
               " mm under the top of the head at the forehead and falls backwards, but the brain "
               "where "
               "its skull is known. Surfaces end there; that is no hole in them. Ears may be seen "
               "in "
               "part.</p>\n";
    }
    return begin +
           "Where the image or a surface holds a whole "
           "head, "
           "this page shows its face, in slices and in 3-D: share it as you would share the scan, "
           "or "
           "make it with <code>--deface-report</code>.</p>\n";
}

std::string scaleHtml(const Scene& scene) {
    const auto withValues =
        std::find_if(scene.surfaces.begin(), scene.surfaces.end(),
                     [](const SceneSurface& surface) { return !surface.valuesMm.empty(); });
    if (withValues == scene.surfaces.end()) return "";
    const double most = withValues->largestValueMm;
    const auto text = [](double mm) {
        char digits[32];
        std::snprintf(digits, sizeof digits, mm < 0.1 && mm > 0 ? "%.4f" : "%.2f", mm);
        return std::string(digits);
    };
    std::string stops;
    constexpr int kStops = 10;
    for (int n = 0; n < kStops; ++n) {
        const ReportColor c = viridis(n / double(kStops - 1));
        stops += ", rgb(" + std::to_string(c[0]) + " " + std::to_string(c[1]) + " " +
                 std::to_string(c[2]) + ")";
    }
    std::string html =
        "<div class=\"scale\" role=\"img\" aria-label=\"Colours of the 3-D view: distance " +
        escaped(withValues->valuesAre) + " from 0 mm, violet, to " + text(most) +
        " mm, yellow\"><span class=\"unit\">mm " + escaped(withValues->valuesAre) +
        "</span><span class=\"bar\" "
        "style=\"background: linear-gradient(to top" +
        stops + ")\"></span>";
    for (int tick = 4; tick >= 0; --tick) {
        html += "<span class=\"tick\" style=\"bottom: " + std::to_string(25 * tick) + "%\">" +
                text(most * tick / 4) + "</span>";
    }
    return html + "</div>\n";
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
    if (hasViewer) {
        html +=
            "<p class=\"spots-hint\">A click moves the crosshair of the viewer below to the "
            "place.</p>\n";
    }
    html += "<ol class=\"spots\" tabindex=\"0\" aria-label=\"Places to look at\">\n";
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

namespace {

/// "58 checks hold, 2 are undecided"
std::string summaryOf(const std::vector<const ReportCheck*>& checks) {
    const auto held = std::count_if(checks.begin(), checks.end(), [](const ReportCheck* check) {
        return check->outcome == ReportOutcome::Passed;
    });
    const auto other = std::ssize(checks) - held;
    std::string text = std::to_string(held) + (held == 1 ? " check holds" : " checks hold");
    if (other > 0) {
        text += ", " + std::to_string(other) + (other == 1 ? " is" : " are") + " undecided";
    }
    return text;
}

}  // namespace

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
    if (!first.empty()) html += checkTable("Checks that failed or are noted", first);
    if (!rest.empty()) {
        html += "<details><summary>" + summaryOf(rest) + "</summary>\n" +
                checkTable("Checks that hold", rest) + "</details>\n";
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
        // viewer.js puts it in the viewer's place where WebGL is missing
        const bool standsIn = picture.name == "surface-1.png" || picture.name == "regions.png";
        html += std::string(standsIn ? "<figure class=\"stands-in\">" : "<figure>") +
                "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"Picture: " +
                escaped(picture.title) + "\"><img alt=\"" + escaped(picture.altText) +
                "\" width=\"" + std::to_string(picture.width) + "\" height=\"" +
                std::to_string(picture.height) + "\" src=\"data:image/png;base64," +
                encodeBase64(picture.png) + "\"></div><figcaption>" + escaped(picture.title) +
                "</figcaption></figure>\n";
    }
    return html + "</section>\n";
}

std::string notesHtml(const Report& report, const std::vector<std::string>& notes) {
    std::vector<std::string> told;
    for (std::size_t n = kNamed; n < report.warnings.size(); ++n) {
        told.push_back("Warning: " + report.warnings[n]);
    }
    told.insert(told.end(), notes.begin(), notes.end());
    if (told.empty()) return "";
    std::string html =
        "<section class=\"notes\" id=\"notes\" aria-labelledby=\"notes-title\">\n<h2 "
        "id=\"notes-title\">Notes</h2>\n<ul>\n";
    for (const std::string& note : told) html += "<li>" + escaped(note) + "</li>\n";
    return html + "</ul>\n</section>\n";
}

}  // namespace adaptiso

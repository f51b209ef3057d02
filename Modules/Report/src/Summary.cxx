#include "adaptiso/Report/Summary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>

#include "Html.h"
#include "PageFiles.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

/// A link's target, percent-encoded.
std::string linkTo(const fs::path& target, const fs::path& page) {
    constexpr std::string_view kDigits = "0123456789ABCDEF";
    const fs::path folder = fs::absolute(page).parent_path();
    std::string link;
    for (const char c : fs::proximate(fs::absolute(target), folder).generic_string()) {
        const auto byte = static_cast<unsigned char>(c);
        const bool isPlain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
                             (c >= 'A' && c <= 'Z') ||
                             std::string_view("-._~/").find(c) != std::string_view::npos;
        if (isPlain) {
            link += c;
        } else {
            link += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
        }
    }
    return link;
}

std::string linkHtml(const std::string& link, const std::string& html) {
    return "<a href=\"" + link + "\">" + html + "</a>";
}

// ---- what all runs came to

struct StateWords {
    const char *style, *word, *counted;
};

const StateWords& stateWords(RunState state) {
    static constexpr StateWords kWords[] = {
        {"failed", "✘&nbsp;FAILED", "failed"},
        {"failed", "✘&nbsp;check FAILED", "with a failed check"},
        {"failed", "✘&nbsp;MISSING or CHANGED", "missing or changed"},
        {"noted", "▲&nbsp;not finished", "not finished"},
        {"failed", "✘&nbsp;not run", "not run"},
        {"noted", "▲&nbsp;done, unusual", "unusual"},
        {"noted", "▲&nbsp;done, with warnings", "with warnings"},
        {"passed", "✔&nbsp;done", "done"}};
    return kWords[static_cast<std::size_t>(state)];
}

constexpr RunState kBad[] = {RunState::Failed, RunState::CheckFailed, RunState::Changed,
                             RunState::NotFinished, RunState::NotRun};

bool isDone(const SummaryRow& row) {
    return row.state >= RunState::Unusual;
}

std::int64_t countOf(const std::vector<SummaryRow>& rows, RunState state) {
    return std::count_if(rows.begin(), rows.end(),
                         [state](const SummaryRow& row) { return row.state == state; });
}

/// Those that are not finished are no failure as long as nothing else is wrong.
ReportVerdict verdictWordOf(const std::vector<SummaryRow>& rows) {
    if (rows.empty()) return ReportVerdict::Done;
    const auto done = std::count_if(rows.begin(), rows.end(), isDone);
    if (done == std::ssize(rows)) return ReportVerdict::Passed;
    return done + countOf(rows, RunState::NotFinished) == std::ssize(rows)
               ? ReportVerdict::Unfinished
               : ReportVerdict::Failed;
}

/// The one program of all rows; empty where they differ.
std::string programOf(const std::vector<SummaryRow>& rows) {
    const bool isOne = std::all_of(rows.begin(), rows.end(), [&](const SummaryRow& row) {
        return row.program == rows.front().program;
    });
    return isOne && !rows.empty() ? rows.front().program : "";
}

std::string lastDate(const std::vector<SummaryRow>& rows) {
    std::string last;
    for (const SummaryRow& row : rows) last = std::max(last, row.date);
    return last;
}

/// "2026-11-29 01:28:44" of ISO 8601.
std::string dateText(std::string date) {
    if (const std::size_t at = date.find('T'); at != std::string::npos) date[at] = ' ';
    if (date.ends_with('Z')) date.pop_back();
    return date;
}

std::string summaryFacts(const Summary& summary) {
    std::vector<ReportFact> counts, how;
    for (int n = 0; n <= static_cast<int>(RunState::Done); ++n) {
        const auto state = static_cast<RunState>(n);
        const std::int64_t count = countOf(summary.rows, state);
        if (count > 0) counts.emplace_back(stateWords(state).counted, formatCount(count));
    }
    how.emplace_back("Made by", summary.program);
    if (const std::string date = lastDate(summary.rows); !date.empty()) {
        how.emplace_back("Last run", dateText(date) + " UTC");
    }
    if (!summary.command.empty()) how.emplace_back("Made again by", summary.command);
    for (const std::string& note : summary.notes) how.emplace_back("Warning", note);
    return factList("Runs by state", counts) + factList("How", how);
}

// ---- reasons

std::string bannerOf(const std::vector<SummaryReason>& reasons) {
    std::string items;
    for (std::size_t n = 0; n < std::min(reasons.size(), kNamed); ++n) {
        items += "<li><strong>" + counted(std::ssize(reasons[n].names), "run") +
                 (reasons[n].isWarning ? " with the warning" : "") +
                 "</strong>: " + escaped(reasons[n].reason) + "</li>\n";
    }
    return bannerList("Reasons", items, reasons.size(), "reasons");
}

std::string reasonsHtml(const std::vector<SummaryReason>& reasons) {
    if (reasons.empty()) return "";
    constexpr std::size_t kMostNames = 6;
    std::string html =
        "<table>\n<thead><tr><th scope=\"col\">Kind</th><th scope=\"col\">Reason</th><th "
        "scope=\"col\">Runs</th><th scope=\"col\">Which</th></tr></thead>\n<tbody>\n";
    for (const SummaryReason& reason : reasons) {
        std::vector<std::string> names = reason.names;
        const std::size_t count = names.size();
        if (count > kMostNames) names.resize(kMostNames);
        std::string which = joined(names);
        if (count > kMostNames) which += " and " + std::to_string(count - kMostNames) + " more";
        html += std::string("<tr><td class=\"outcome ") +
                (reason.isWarning ? "noted\">▲ warning" : "failed\">✘ not done") +
                "</td><th scope=\"row\">" + escaped(reason.reason) + "</th>" +
                cell("Runs", std::to_string(count)) + cell("Which", which) + "</tr>\n";
    }
    return "<section aria-labelledby=\"reasons\">\n<h2 id=\"reasons\">Reasons</h2>\n" +
           scrollable("Reasons by number", html + "</tbody>\n</table>") + "</section>\n";
}

// ---- charts

/// A figure of the rows that have it.
struct Chart {
    std::string title, unit;
    std::vector<std::size_t> rows{};
    std::vector<std::optional<double>> values{};  ///< finite, of each of these rows
    std::vector<Outlier> outliers{};              ///< indices are those of `values`
    double least = 0, most = 0, median = 0;
    double from = 0, to = 0;   ///< of those that are alike
    double low = 0, high = 0;  ///< of the axis: those alike take a fifth of it at least

    bool isCut() const { return low > least || high < most; }
    std::string text(double value) const { return formatMeasure(value) + " " + unit; }
};

/// Chooses the range of the axis. A value outside of it is drawn at the nearer end.
void chooseAxis(Chart& chart) {
    std::vector<bool> isApart(chart.values.size());
    for (const Outlier& outlier : chart.outliers) isApart[outlier.index] = true;
    chart.from = chart.most;
    chart.to = chart.least;
    for (std::size_t n = 0; n < chart.values.size(); ++n) {
        if (isApart[n]) continue;
        chart.from = std::min(chart.from, *chart.values[n]);
        chart.to = std::max(chart.to, *chart.values[n]);
    }
    chart.low = chart.least;
    chart.high = chart.most;
    if (!(chart.from < chart.to)) return;
    const double room = 2 * (chart.to - chart.from);
    chart.low = std::max(chart.low, chart.from - room);
    chart.high = std::min(chart.high, chart.to + room);
}

std::vector<Chart> chartsOf(const Summary& summary) {
    const std::vector<SummaryRow>& rows = summary.rows;
    const bool isOfOne = !programOf(rows).empty();
    std::vector<Chart> charts;
    std::map<std::string, std::size_t> places;
    const auto add = [&](std::size_t row, std::string title, const char* unit, double value) {
        if (!isOfOne) addPart(title, rows[row].program);
        const auto [place, isNew] = places.emplace(title, charts.size());
        if (isNew) charts.push_back({title, unit});
        if (!std::isfinite(value)) return;
        charts[place->second].rows.push_back(row);
        charts[place->second].values.emplace_back(value);
    };
    for (std::size_t n = 0; n < rows.size(); ++n) {
        for (const auto& [part, mm3] : rows[n].volumesMm3) {
            add(n, part.empty() ? "Volume" : "Volume, " + part, "mm³", mm3);
        }
    }
    for (std::size_t n = 0; n < rows.size(); ++n) {
        if (isDone(rows[n]) && rows[n].seconds > 0) add(n, "Time", "s", rows[n].seconds);
    }
    std::erase_if(charts, [](const Chart& chart) { return chart.values.size() < kFewestCompared; });
    for (Chart& chart : charts) {
        const std::vector<double> values = knownOf(chart.values);
        chart.least = *std::min_element(values.begin(), values.end());
        chart.most = *std::max_element(values.begin(), values.end());
        chart.median = medianOf(values);
        chart.outliers = findOutliers(chart.values, summary.outliers);
        chooseAxis(chart);
    }
    std::erase_if(charts, [](const Chart& chart) {
        return chart.least == chart.most || !std::isfinite(chart.most - chart.least);
    });
    return charts;
}

std::string rowId(std::size_t row) {
    return "run-" + std::to_string(row + 1);
}

/// "sub-04 (+127%)", with a link to its line.
std::string outlierLinks(const Chart& chart, const std::vector<SummaryRow>& rows) {
    constexpr std::size_t kMostNamed = 12;
    std::string html;
    for (std::size_t n = 0; n < std::min(chart.outliers.size(), kMostNamed); ++n) {
        const std::size_t row = chart.rows[chart.outliers[n].index];
        addPart(html, linkHtml("#" + rowId(row), escaped(rows[row].name)) + " (" +
                          chart.outliers[n].percentText() + ")");
    }
    const std::size_t more = chart.outliers.size() - std::min(chart.outliers.size(), kMostNamed);
    return more > 0 ? html + " and " + std::to_string(more) + " more" : html;
}

/// A dot for each run, on those of the same place.
std::string chartSvg(const Chart& chart, const std::vector<SummaryRow>& rows) {
    constexpr double kWidth = 360, kSide = 10, kTop = 20, kBase = 72, kDot = 4;
    constexpr int kBins = 42;
    const auto px = [](double length) { return formatFixed(length, 1); };
    const auto part = [&](double v) {
        return (std::clamp(v, chart.low, chart.high) - chart.low) / (chart.high - chart.low);
    };
    const auto across = [&](double v) { return kSide + (kWidth - 2 * kSide) * part(v); };
    const auto text = [&](double x, double y, const std::string& style, const std::string& words) {
        return "<text class=\"" + style + "\" x=\"" + px(x) + "\" y=\"" + px(y) + "\">" + words +
               "</text>\n";
    };
    std::vector<bool> isApart(chart.values.size());
    for (const Outlier& outlier : chart.outliers) isApart[outlier.index] = true;
    std::vector<int> stacks(kBins + 1);
    std::vector<int> heights;
    for (std::size_t n = 0; n < chart.values.size(); ++n) {
        const double v = *chart.values[n];
        heights.push_back(stacks[static_cast<std::size_t>(std::lround(kBins * part(v)))]++);
    }
    const int highest = *std::max_element(heights.begin(), heights.end());
    const double step = std::min(2 * kDot, (kBase - kTop - 2 * kDot) / std::max(1, highest));
    std::string svg =
        "<svg viewBox=\"0 0 " + px(kWidth) + " 98\" role=\"img\" aria-label=\"" +
        escaped(chart.title + ": " + chart.text(chart.least) + " to " + chart.text(chart.most)) +
        "\">\n";
    if (chart.from <= chart.to) {
        svg += "<rect class=\"alike\" x=\"" + px(across(chart.from) - kDot) + "\" y=\"" + px(kTop) +
               "\" width=\"" + px(across(chart.to) - across(chart.from) + 2 * kDot) +
               "\" height=\"" + px(kBase - kTop + kDot) + "\"/>\n";
    }
    svg += "<path class=\"axis\" d=\"M" + px(kSide) + " 77H" + px(kWidth - kSide) + "M" +
           px(across(chart.median)) + " " + px(kTop) + "V82\"/>\n";
    const int stride = std::max(1, static_cast<int>(1 / step));  // a dot for each unit of height
    for (std::size_t n = 0; n < chart.values.size(); ++n) {
        if (!isApart[n] && heights[n] % stride != 0) continue;
        svg += std::string("<circle class=\"") + (isApart[n] ? "apart" : "dot") + "\" cx=\"" +
               px(across(*chart.values[n])) + "\" cy=\"" + px(kBase - step * heights[n]) +
               "\" r=\"" + px(isApart[n] ? kDot + 1 : kDot) + "\"><title>" +
               escaped(rows[chart.rows[n]].name) + ": " + chart.text(*chart.values[n]) +
               "</title></circle>\n";
    }
    if (!chart.outliers.empty()) {  // the farthest by name; the caption has all
        const auto farthest = std::max_element(chart.outliers.begin(), chart.outliers.end(),
                                               [](const Outlier& a, const Outlier& b) {
                                                   return std::abs(a.score) < std::abs(b.score);
                                               });
        constexpr std::size_t kLongest = 28;
        const std::string& name = rows[chart.rows[farthest->index]].name;
        const double place = part(*chart.values[farthest->index]);
        if (name.size() <= kLongest) {
            svg += text(kSide + (kWidth - 2 * kSide) * place, 14,
                        place > 0.7   ? "name end"
                        : place < 0.3 ? "name"
                                      : "name middle",
                        escaped(name));
        }
    }
    return svg +
           text(kSide, 94, "", (chart.low > chart.least ? "≤ " : "") + formatMeasure(chart.low)) +
           text(kWidth - kSide, 94, "end",
                (chart.high < chart.most ? "≥ " : "") + chart.text(chart.high)) +
           "</svg>";
}

std::string chartsHtml(const Summary& summary) {
    std::vector<Chart> charts = chartsOf(summary);
    if (charts.empty()) return "";
    constexpr std::size_t kMostCharts = 8;
    std::string html =
        "<section aria-labelledby=\"charts-title\">\n<h2 id=\"charts-title\">Volumes and "
        "times</h2>\n<p class=\"hint\">A dot for each run, the median as a line. Marked: what "
        "lies " +
        escaped(summary.outliers.text()) + ". The shaded part holds all others.";
    if (std::ranges::any_of(charts, &Chart::isCut)) {
        html += " Dots at an end with ≤ or ≥ may lie beyond it.";
    }
    if (charts.size() > kMostCharts) {
        html += " Of " + counted(std::ssize(charts), "figure") +
                " those with the most outliers are shown.";
        std::stable_sort(charts.begin(), charts.end(), [](const Chart& a, const Chart& b) {
            return a.outliers.size() > b.outliers.size();
        });
        charts.resize(kMostCharts);
    }
    html += "</p>\n<div class=\"charts\">\n";
    for (const Chart& chart : charts) {
        html += "<figure>" + chartSvg(chart, summary.rows) + "<figcaption><strong>" +
                escaped(chart.title) + "</strong>, " + counted(std::ssize(chart.values), "run") +
                ", median " + chart.text(chart.median) +
                (chart.outliers.empty() ? "" : ". Outliers: ") + outlierLinks(chart, summary.rows) +
                "</figcaption></figure>\n";
    }
    return html + "</div>\n</section>\n";
}

// ---- the table

std::string pictureOf(const SummaryRow& row, const fs::path& page) {
    for (const std::string_view name : {"contours-axial.png", "surface-1.png", "regions.png"}) {
        if (!row.pictures.empty() && fs::exists(row.pictures / name)) {
            return linkTo(row.pictures / name, page);
        }
    }
    return "";
}

std::string thumbnail(const SummaryRow& row, const fs::path& page) {
    const std::string source = pictureOf(row, page);
    if (source.empty()) return {};
    return linkHtml(row.report.empty() ? source : linkTo(row.report, page),
                    "<img src=\"" + source + "\" alt=\"picture of " + escaped(row.name) +
                        "\" loading=\"lazy\">");
}

std::string filesOf(const SummaryRow& row, const fs::path& page) {
    constexpr std::size_t kMostFiles = 12;
    std::string files;
    for (std::size_t n = 0; n < std::min(kMostFiles, row.outputs.size()); ++n) {
        const fs::path& output = row.outputs[n];
        addPart(files, linkHtml(linkTo(output, page), escaped(output.filename().string())), "<br>");
    }
    if (row.outputs.size() > kMostFiles) {
        files += "<br>and " + std::to_string(row.outputs.size() - kMostFiles) + " more";
    }
    return files;
}

/// A column: its heading and the HTML of its cells, with keys to sort by where these are not
/// their text.
struct Column {
    const char *heading, *style;
    std::vector<std::string> cells{}, keys{};

    bool isEmpty() const {
        return std::all_of(cells.begin(), cells.end(),
                           [](const std::string& each) { return each.empty(); });
    }
};

/// The result and, below it, the first warning.
std::string resultOf(const SummaryRow& row) {
    std::string html = escaped(row.says);
    if (row.warnings.empty()) return html;
    addPart(html,
            "▲ " + counted(std::ssize(row.warnings), "warning") + ": " +
                escaped(row.warnings.front().text),
            "<br>");
    return html;
}

std::vector<Column> columnsOf(const Summary& summary, const fs::path& page) {
    const std::vector<SummaryRow>& rows = summary.rows;
    const bool hasProgram = programOf(rows).empty();
    const bool hasInput = std::any_of(rows.begin(), rows.end(), [](const SummaryRow& row) {
        return !row.file.starts_with(row.name);
    });
    const bool hasVolume = std::none_of(
        rows.begin(), rows.end(), [](const SummaryRow& row) { return row.volumesMm3.size() > 1; });
    Column program{"Program", ""}, input{"Input", ""}, result{"Result", "wide"},
        files{"Files", "wide"}, picture{"Picture", ""}, volume{"Volume, mm³", "number"},
        ended{"Ended, UTC", "time"}, seconds{"Seconds", "number"};
    for (const SummaryRow& row : rows) {
        program.cells.push_back(hasProgram ? escaped(row.program) : "");
        input.cells.push_back(hasInput ? escaped(row.file) : "");
        result.cells.push_back(resultOf(row));
        files.cells.push_back(filesOf(row, page));
        picture.cells.push_back(thumbnail(row, page));
        const bool isKnown = hasVolume && !row.volumesMm3.empty();
        const double mm3 = isKnown ? row.volumesMm3.front().second : 0;
        volume.cells.push_back(isKnown ? formatMeasure(mm3) : "");
        volume.keys.push_back(isKnown ? formatNumber(mm3) : "");
        ended.cells.push_back(escaped(dateText(row.date)));
        seconds.cells.push_back(row.seconds > 0 ? formatFixed(row.seconds, 1) : "");
        seconds.keys.push_back(row.seconds > 0 ? formatNumber(row.seconds) : "");
    }
    std::vector<Column> columns;
    for (Column* const column :
         {&program, &input, &result, &files, &picture, &volume, &seconds, &ended}) {
        if (!column->isEmpty()) columns.push_back(std::move(*column));
    }
    return columns;
}

std::string runsHtml(const Summary& summary, const fs::path& page) {
    const std::vector<SummaryRow>& rows = summary.rows;
    const std::vector<Column> columns = columnsOf(summary, page);
    std::string html =
        "<table id=\"runs\">\n<thead><tr><th scope=\"col\">State</th><th scope=\"col\">Name</th>";
    for (const Column& column : columns) {
        html += std::string("<th scope=\"col\" class=\"") + column.style + "\">" + column.heading +
                "</th>";
    }
    html += "</tr></thead>\n<tbody>\n";
    for (std::size_t n = 0; n < rows.size(); ++n) {
        const SummaryRow& row = rows[n];
        const StateWords& words = stateWords(row.state);
        const std::string name = escaped(row.name);
        html += "<tr id=\"" + rowId(n) + "\"><td class=\"outcome " + words.style +
                "\" data-key=\"" + std::to_string(static_cast<int>(row.state)) + "\">" +
                words.word + "</td><th scope=\"row\">" +
                (row.report.empty() ? name : linkHtml(linkTo(row.report, page), name)) + "</th>";
        for (const Column& column : columns) {
            html += std::string("<td class=\"") + column.style + "\" data-label=\"" +
                    column.heading + "\"" +
                    (column.keys.empty() ? "" : " data-key=\"" + column.keys[n] + "\"") + ">" +
                    column.cells[n] + "</td>";
        }
        html += "</tr>\n";
    }
    return "<section id=\"checks\" aria-labelledby=\"runs-title\">\n<h2 "
           "id=\"runs-title\">Runs</h2>\n<p class=\"hint\">Those that need attention come first. A "
           "name leads to the run's own report, where there is one.</p>\n<p id=\"run-tools\" "
           "class=\"tools\" hidden><label>Find <input type=\"search\" id=\"find\" "
           "autocomplete=\"off\"></label> <label>State <select id=\"state\"><option "
           "value=\"\">all</option></select></label> <label class=\"of-cards\">Sort by <select "
           "id=\"sort\"></select></label> <output id=\"run-count\" "
           "aria-live=\"polite\"></output></p>\n" +
           scrollable("Table of runs", html + "</tbody>\n</table>") + "</section>\n";
}

}  // namespace

std::string verdictOf(const std::vector<SummaryRow>& rows) {
    const std::string all = std::to_string(rows.size());
    std::string text;
    for (const RunState state : kBad) {
        const std::int64_t count = countOf(rows, state);
        if (count == 0) continue;
        addPart(text, std::to_string(count) + (text.empty() ? " of " + all : "") + " " +
                          stateWords(state).counted);
    }
    if (text.empty()) text = rows.empty() ? "Nothing was run" : "All " + all + " done";
    for (const RunState state : {RunState::Unusual, RunState::Warned}) {
        const std::int64_t count = countOf(rows, state);
        if (count > 0) addPart(text, std::to_string(count) + " " + stateWords(state).counted);
    }
    return text;
}

void sortByNeed(std::vector<SummaryRow>& rows) {
    std::stable_sort(rows.begin(), rows.end(), [](const SummaryRow& a, const SummaryRow& b) {
        return a.state != b.state ? a.state < b.state : a.warnings.size() > b.warnings.size();
    });
}

std::vector<SummaryReason> reasonsOf(const std::vector<SummaryRow>& rows) {
    std::map<std::pair<bool, std::string>, std::vector<std::string>> byReason;
    for (const SummaryRow& row : rows) {
        const std::string& name = row.file.empty() ? row.name : row.file;
        if (!isDone(row)) byReason[{false, row.reason}].push_back(name);
        std::set<std::string> codes;
        for (const Warning& warning : row.warnings) codes.insert(warning.code);
        for (const std::string& code : codes) byReason[{true, code}].push_back(name);
    }
    std::vector<SummaryReason> reasons;
    for (auto& [of, names] : byReason) reasons.push_back({of.second, std::move(names), of.first});
    std::stable_sort(
        reasons.begin(), reasons.end(), [](const SummaryReason& a, const SummaryReason& b) {
            return std::pair(a.isWarning, b.names.size()) < std::pair(b.isWarning, a.names.size());
        });
    return reasons;
}

std::string summaryPage(const Summary& summary, const fs::path& page) {
    const std::vector<SummaryRow>& rows = summary.rows;
    const std::vector<SummaryReason> reasons = reasonsOf(rows);
    PageFrame frame;
    frame.verdict = verdictWordOf(rows);
    frame.hasWarnings = countOf(rows, RunState::Unusual) > 0 ||
                        std::any_of(reasons.begin(), reasons.end(),
                                    [](const SummaryReason& reason) { return reason.isWarning; });
    frame.generator = summary.program;
    frame.title = summary.title;
    if (frame.title.empty()) {
        const std::string program = programOf(rows);
        frame.title = counted(std::ssize(rows), "run") + (program.empty() ? "" : " of " + program);
    }
    frame.headline = verdictOf(rows);
    frame.banner = bannerOf(reasons);
    frame.facts = summaryFacts(summary);
    frame.body = reasonsHtml(reasons) + chartsHtml(summary) + runsHtml(summary, page);
    const std::string date = lastDate(rows);
    frame.date = date.empty() ? "no run has ended" : dateText(date) + " UTC";
    frame.footnote = "Links and pictures are files beside this page; it sends nothing.";
    frame.sources =
        "img-src 'self' file:; script-src " + scriptHashes({embedded::summaryJsSha256()});
    addScript(embedded::summaryJs(), frame.scripts);
    return framed(frame);
}

}  // namespace adaptiso

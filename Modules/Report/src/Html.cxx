#include "Html.h"

#include <nlohmann/json.hpp>

#include "PageFiles.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

struct VerdictWords {
    const char *style, *sign, *word;
};

VerdictWords verdictWords(ReportVerdict verdict, bool hasWarnings) {
    static constexpr VerdictWords kWords[] = {{"passed", "✔", "PASSED"},
                                              {"failed", "✘", "FAILED"},
                                              {"done", "●", "DONE"},
                                              {"doubtful", "▲", "NOT FINISHED"}};
    const bool isDoubtful = verdict == ReportVerdict::Passed && hasWarnings;
    return isDoubtful ? VerdictWords{"doubtful", "▲", "PASSED WITH WARNINGS"}
                      : kWords[static_cast<std::size_t>(verdict)];
}

}  // namespace

std::string escaped(const std::string& text) {
    using nlohmann::json;
    const std::string valid = json::parse(
        json(withoutControls(text, "\n\t")).dump(-1, ' ', false, json::error_handler_t::replace));
    constexpr std::string_view kSpecial = "&<>\"'";
    constexpr std::string_view kEntities[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
    std::string html;
    for (const char c : valid) {
        const std::size_t special = kSpecial.find(c);
        const bool isControl = static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\t';
        html += special < kSpecial.size() ? kEntities[special]
                : isControl               ? std::string_view("\uFFFD")
                                          : std::string_view(&c, 1);
    }
    return html;
}

std::string scrollable(const std::string& label, const std::string& html) {
    return "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"" + escaped(label) +
           "\">" + html + "</div>\n";
}

std::string cell(const std::string& column, const std::string& text) {
    return "<td data-label=\"" + escaped(column) + "\">" + escaped(text) + "</td>";
}

std::string factList(const std::string& title, const std::vector<ReportFact>& facts) {
    if (facts.empty()) return "";
    std::string html = "<div>\n<h2>" + title + "</h2>\n<dl>\n";
    for (const auto& [name, value] : facts) {
        html += "<dt>" + escaped(name) + "</dt><dd>" + escaped(value) + "</dd>\n";
    }
    return html + "</dl>\n</div>\n";
}

std::string bannerList(const std::string& label, const std::string& items, std::size_t count,
                       const std::string& anchor) {
    if (count == 0) return "";
    std::string html = "<ul class=\"named\" aria-label=\"" + label + "\">\n" + items;
    if (count > kNamed) {
        html += "<li><a href=\"#" + anchor + "\">and " + std::to_string(count - kNamed) +
                " more</a></li>\n";
    }
    return html + "</ul>\n";
}

std::string fill(std::string_view pattern,
                 const std::map<std::string_view, std::string_view>& values) {
    std::string text;
    std::size_t length = pattern.size();
    for (const auto& [name, value] : values) length += value.size();
    text.reserve(length);
    for (std::size_t at = 0; at < pattern.size();) {
        const std::size_t open = pattern.find("{{", at);
        text += pattern.substr(at, open - at);
        if (open == std::string_view::npos) break;
        const std::size_t close = pattern.find("}}", open);
        const auto value = values.find(pattern.substr(open + 2, close - open - 2));
        if (close == std::string_view::npos || value == values.end()) {
            throw InternalError("htmlPage: a name in the page's pattern has no value");
        }
        text += value->second;
        at = close + 2;
    }
    return text;
}

std::string scriptHashes(const std::vector<std::string_view>& checksums) {
    std::string sources;
    for (const std::string_view hex : checksums) {
        std::string bytes;
        for (std::size_t at = 0; at < hex.size(); at += 2) {
            bytes += static_cast<char>(std::stoi(std::string(hex.substr(at, 2)), nullptr, 16));
        }
        sources += (sources.empty() ? "'sha256-" : " 'sha256-") + encodeBase64(bytes) + "'";
    }
    return sources.empty() ? "'none'" : sources;
}

void addScript(std::string_view script, std::string& html) {
    html += "<script>";
    html += script;
    html += "</script>\n";
}

std::string framed(const PageFrame& frame) {
    const VerdictWords words = verdictWords(frame.verdict, frame.hasWarnings);
    const std::string generator = escaped(frame.generator), date = escaped(frame.date),
                      title = escaped(frame.title), headline = escaped(frame.headline),
                      footnote = escaped(frame.footnote);
    return fill(embedded::pageHtml(), {{"SOURCES", frame.sources},
                                       {"GENERATOR", generator},
                                       {"VERDICT_CLASS", words.style},
                                       {"VERDICT_SIGN", words.sign},
                                       {"VERDICT_WORD", words.word},
                                       {"TITLE", title},
                                       {"HEADLINE", headline},
                                       {"BANNER", frame.banner},
                                       {"STYLE", embedded::styleCss()},
                                       {"FACTS", frame.facts},
                                       {"BODY", frame.body},
                                       {"DATE", date},
                                       {"FOOTNOTE", footnote},
                                       {"END", frame.end},
                                       {"SCRIPTS", frame.scripts}});
}

}  // namespace adaptiso

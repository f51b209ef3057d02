#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Report/Report.h"

namespace adaptiso {

// Parts that all pages of the module share.

/// `text` as it can stand in HTML, in an element or a quoted attribute. What is not UTF-8 becomes
/// U+FFFD, and so do control characters.
std::string escaped(const std::string& text);

/// `html`, which may be wider than the page, in a part that scrolls sideways, with keys too.
/// \param label  what it is, for people who hear the page
std::string scrollable(const std::string& label, const std::string& html);

/// A cell of a table. \param column  what phones, which show a row as a card, put before it
std::string cell(const std::string& column, const std::string& text);

/// A list of names and values under a heading; empty without facts.
std::string factList(const std::string& title, const std::vector<ReportFact>& facts);

/// Items that a list in the banner shows.
inline constexpr std::size_t kNamed = 3;

/// A list in the banner of the first kNamed `items` of `count`. The others stand at `anchor`.
std::string bannerList(const std::string& label, const std::string& items, std::size_t count,
                       const std::string& anchor);

/// `pattern` with every {{NAME}} replaced by its value; values are taken as they are.
/// \throws InternalError  a name that has no value
std::string fill(std::string_view pattern,
                 const std::map<std::string_view, std::string_view>& values);

/// Sources for a Content-Security-Policy: scripts of these checksums alone.
std::string scriptHashes(const std::vector<std::string_view>& checksums);

/// Appends a script as the page's policy lets it run: its bytes are all that is in the element.
void addScript(std::string_view script, std::string& html);

/// A whole page: the verdict, facts, then `body`.
struct PageFrame {
    ReportVerdict verdict = ReportVerdict::Done;
    bool hasWarnings = false;
    std::string generator, date, title, headline, footnote;  ///< plain texts
    /// HTML: lists below the headline, factList(), sections, the end of the footer, scripts
    std::string banner, facts, body, end, scripts;
    std::string sources;  ///< that the policy allows, beside the page's own style
};
std::string framed(const PageFrame& frame);

}  // namespace adaptiso

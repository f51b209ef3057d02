#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

namespace adaptiso::testing {

/// Expects `part` in the page from `begin` to before `end`. ADAPTISO_RENEW_PAGES=1 writes it there
/// instead.
inline void expectOnPage(const char* path, const std::string& begin, const std::string& end,
                         const std::string& part) {
    std::ifstream file(path);
    std::string page(std::istreambuf_iterator<char>(file), {});
    const std::size_t from = page.find(begin), to = page.find(end, from);
    ASSERT_LT(from, to) << path;
    ASSERT_NE(to, std::string::npos) << path;
    if (std::getenv("ADAPTISO_RENEW_PAGES") != nullptr) {
        std::ofstream(path) << page.replace(from, to - from, part);
    } else {
        EXPECT_EQ(page.substr(from, to - from), part) << path;
    }
}

/// "`a`, `b`"
template <class Words>
std::string quotedList(const Words& words) {
    std::string text;
    for (const auto& word : words) {
        text.append(text.empty() ? "`" : ", `").append(word).append("`");
    }
    return text;
}

}  // namespace adaptiso::testing

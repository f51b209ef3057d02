#include "Common/UsageWords.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <numeric>
#include <span>
#include <system_error>

#include "Common/Naming.h"
#include "Common/RunApp.h"
#include "adaptiso/Core/Habits.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

/// Letters to change, add, drop or swap with their neighbour (optimal string alignment).
std::size_t editDistance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before, last, row(b.size() + 1);
    std::iota(row.begin(), row.end(), 0);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        before = std::exchange(last, row);
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t change = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            row[j] = std::min({change, last[j] + 1, row[j - 1] + 1});
            const bool isSwap = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (isSwap) row[j] = std::min(row[j], before[j - 2] + 1);
        }
    }
    return row[b.size()];
}

/// As far as a slip of the keyboard goes in a word of that length.
std::size_t farthest(std::size_t length) {
    return length <= 4 ? 1 : length <= 8 ? 2 : 3;
}

bool beginsWithOther(std::string_view a, std::string_view b) {
    constexpr std::size_t kFewest = 3;
    const auto& [shorter, longer] = std::minmax(
        a, b, [](std::string_view l, std::string_view r) { return l.size() < r.size(); });
    return shorter.size() >= kFewest && longer.starts_with(shorter);
}

std::vector<std::string> longNames(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
        const auto& own = option->get_lnames();
        names.insert(names.end(), own.begin(), own.end());
    }
    return names;
}

/// The option that goes by `word` ("--json", "-o"), or null.
const CLI::Option* optionNamed(const CLI::App& app, std::string_view word) {
    const auto& options = app.get_options();
    const auto found = std::find_if(options.begin(), options.end(), [&](const CLI::Option* option) {
        const auto has = [&](const std::vector<std::string>& names, const std::string& dashes) {
            return std::any_of(names.begin(), names.end(),
                               [&](const std::string& name) { return dashes + name == word; });
        };
        return has(option->get_lnames(), "--") || has(option->get_snames(), "-");
    });
    return found == options.end() ? nullptr : *found;
}

std::string_view beforeEquals(std::string_view word) {
    return word.substr(0, word.find('='));
}

bool takesValue(const CLI::Option& option) {
    return option.get_items_expected_max() > 0;
}

/// As --help names the value: "MM"; of INPUT and its like the name itself.
std::string valueName(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    return type.empty() ? option.get_name(true) : type;
}

/// "INPUT", "A and B", "FILE"
std::string positionals(const CLI::App& app) {
    std::string text;
    for (const CLI::Option* option : app.get_options()) {
        if (!option->get_lnames().empty() || !option->get_snames().empty()) continue;
        addPart(text, option->get_name(true), " and ");
    }
    return text;
}

/// For a program without arguments: "options only, such as --t1 IMG".
std::string optionsAlone(const CLI::App& app) {
    for (const CLI::Option* option : app.get_options()) {
        if (option->get_type_name() == "IMG") {
            return "options only, such as " + option->get_name() + " IMG";
        }
    }
    return "options only";
}

/// "; an output is given as -o out.stl", where one word more than expected may be that.
std::string outputHint(const CLI::App& app, const std::vector<std::string>& words) {
    std::error_code error;
    const CLI::Option* const output = optionNamed(app, "-o");
    const bool maybe = words.size() == 1 && output != nullptr && output->count() == 0 &&
                       !std::filesystem::exists(words.front(), error);
    return maybe ? "; an output is given as -o " + shellQuoted(words.front()) : "";
}

std::string ofUnexpected(const CLI::App& app) {
    const std::vector<std::string> words = app.remaining();
    const auto option = std::find_if(words.begin(), words.end(), [](const std::string& word) {
        return word.size() > 1 && word[0] == '-';
    });
    if (option == words.end()) {
        const std::string wanted = positionals(app);
        return shown(words.empty() ? "" : words.front()) + ": is one argument too many; " +
               app.get_name() + " takes " +
               (wanted.empty() ? optionsAlone(app) : wanted + " and options") +
               outputHint(app, words);
    }
    const std::string_view name = beforeEquals(*option);
    const std::string_view letters = name.substr(
        name.find_first_not_of('-') == name.npos ? name.size() : name.find_first_not_of('-'));
    const std::vector<std::string> known = longNames(app);
    auto answer = habitAnswer(app.get_name(), letters, known);
    if (const auto meant = nearestWord(letters, known); !answer && meant) {
        answer = "did you mean --" + *meant + "?";
    }
    return shown(name) + ": there is no such option" + (answer ? "; " + *answer : "");
}

/// "--iso", of hidden options too; "INPUT".
std::string nameOf(const CLI::Option& option) {
    const bool isLong = !option.get_lnames().empty();
    return isLong ? "--" + option.get_lnames().front() : option.get_name(true);
}

/// CLI11 takes "=x" of "-o=x" and of "-qo=x" for the value of -o, and "utput" of "-output".
void refuseMistakenLetters(const CLI::App& app, std::string_view word) {
    if (!word.starts_with('-') || word.starts_with("--")) return;
    const std::string whole = "-" + std::string(beforeEquals(word));
    if (word.size() > 2 && optionNamed(app, whole) != nullptr) {
        throw UsageError(std::string(beforeEquals(word)) +
                         ": there is no such option; did you mean " + whole + "?");
    }
    for (std::size_t n = 1; n < word.size(); ++n) {
        const std::string letter = {'-', word[n]};
        const CLI::Option* const option = optionNamed(app, letter);
        if (option == nullptr) return;
        if (!takesValue(*option)) continue;
        const std::string_view value = word.substr(n + 1);
        if (!value.starts_with('=')) return;
        const std::string name = nameOf(*option),
                          given = value == "=" ? valueName(*option) : shown(value.substr(1));
        throw UsageError(name + ": no = goes between " + letter + " and its value; give " + letter +
                         " " + given + " or " + name + "=" + given);
    }
}

/// Numbers with blanks between, "0.3, 0.006 0.3", after an option that takes one word for all.
/// \param words  after the option's name \throws UsageError
void refuseBlanks(const CLI::Option& option, std::span<const char* const> words) {
    if (valueName(option).find(',') == std::string::npos) return;
    std::string together;
    std::size_t count = 0;
    for (; count < words.size(); ++count) {
        std::string_view number = words[count];
        while (number.ends_with(',')) number.remove_suffix(1);
        if (!parseFiniteNumber(number)) break;
        addPart(together, std::string(number), ",");
    }
    if (count < 2) return;
    throw UsageError(nameOf(option) +
                     ": its numbers have commas and no blanks between them; give " + together);
}

}  // namespace

std::string shown(std::string_view text) {
    constexpr std::size_t kMost = 60;
    std::string cut(text);
    if (text.size() > kMost) {
        std::size_t end = kMost;  // not within a character of UTF-8
        while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
        cut.resize(end);
        cut += "...";
    }
    for (char& c : cut) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    }
    const bool isPlain = !cut.empty() && std::all_of(cut.begin(), cut.end(), [](char c) {
        return static_cast<unsigned char>(c) > ' ';
    });
    return isPlain ? cut : "'" + cut + "'";
}

std::optional<std::string> nearestWord(std::string_view typed,
                                       const std::vector<std::string>& words) {
    const std::string* nearest = nullptr;
    std::size_t least = farthest(typed.size()) + 1;
    for (const std::string& word : words) {
        const std::size_t distance = editDistance(typed, word);
        if (distance >= least || distance >= std::max(typed.size(), word.size())) continue;
        if (distance > 1 && !typed.empty() && typed[0] != word[0]) continue;
        least = distance;
        nearest = &word;
    }
    if (nearest != nullptr) return *nearest;
    const auto begun = std::find_if(words.begin(), words.end(), [&](const std::string& word) {
        return beginsWithOther(typed, word);
    });
    if (begun == words.end()) return std::nullopt;
    return *begun;
}

std::string suggestion(std::string_view typed, const std::vector<std::string>& words) {
    const auto meant = nearestWord(typed, words);
    return meant ? "; did you mean " + *meant + "?" : "";
}

std::string alternatives(const std::vector<std::string>& words) {
    std::string text;
    for (std::size_t n = 0; n < words.size(); ++n) {
        text += (n == 0 ? "" : n + 1 == words.size() ? " or " : ", ") + words[n];
    }
    return text;
}

bool isLetterOption(std::string_view word) {
    return word.size() == 2 && word[0] == '-' &&
           std::isalpha(static_cast<unsigned char>(word[1])) != 0;
}

void refuseMisplacedValues(const CLI::App& app, int argc, const char* const* argv) {
    for (int n = 1; n < argc; ++n) {
        const std::string_view word = argv[n], name = beforeEquals(word);
        if (word == "--") return;
        refuseMistakenLetters(app, word);
        if (word.empty() && !positionals(app).empty()) {
            throw UsageError(positionals(app) + ": its value is empty");
        }
        const CLI::Option* const option = optionNamed(app, name);
        if (option == nullptr) continue;
        const auto refuse = [&](const std::string& fault) {
            throw UsageError(nameOf(*option) + ": " + fault);
        };
        const bool hasOwn = name.size() < word.size();
        if (!takesValue(*option) && hasOwn) refuse("takes no value");
        if (!hasOwn && option->get_items_expected_min() == 0) continue;
        if (!hasOwn && n + 1 == argc) refuse("its value is missing; give " + valueName(*option));
        const std::string_view value = hasOwn ? word.substr(name.size() + 1) : argv[++n];
        if (value.empty()) refuse("its value is empty; give " + valueName(*option));
        const bool isShort = !hasOwn && isLetterOption(value);
        if ((isShort || value.starts_with("--")) &&
            optionNamed(app, beforeEquals(value)) != nullptr) {
            refuse("its value is missing; " + std::string(value) + " is an option");
        }
        if (!hasOwn && (isShort || value.starts_with("--")) && value != "--") {
            refuse("its value is missing; one that begins with dashes is given as " +
                   nameOf(*option) + "=" + shellQuoted(std::string(value)));
        }
        if (!hasOwn) refuseBlanks(*option, {argv + n, static_cast<std::size_t>(argc - n)});
        for (int more = 1; !hasOwn && more < option->get_items_expected_max() && n + 1 < argc &&
                           argv[n + 1][0] != '-';
             ++more) {
            if (argv[++n][0] == '\0') refuse("its value is empty; give " + valueName(*option));
        }
    }
}

void requirePlaceholders(const std::string& option, const std::filesystem::path& output,
                         const std::vector<std::string>& known) {
    const std::string name = output.string();
    for (std::size_t begin = name.find('{'); begin != std::string::npos;
         begin = name.find('{', begin + 1)) {
        const std::size_t end = name.find('}', begin);
        if (end == std::string::npos) return;
        const std::string place = name.substr(begin, end + 1 - begin);
        if (std::find(known.begin(), known.end(), place) != known.end()) continue;
        throw UsageError(option + " " + shown(name) + ": " + place + " stands for nothing here" +
                         (known.empty() ? "" : "; there is " + alternatives(known)));
    }
}

std::string inWords(const CLI::App& app, const CLI::ParseError& error) {
    if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) return ofUnexpected(app);
    const bool isMissing = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr,
               isAlone = dynamic_cast<const CLI::RequiresError*>(&error) != nullptr,
               isTooMuch = dynamic_cast<const CLI::ExcludesError*>(&error) != nullptr,
               isCount = dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr;
    for (const CLI::Option* option : app.get_options()) {
        const std::string name = nameOf(*option);
        if (option->count() == 0) {
            if (!isMissing || !option->get_required()) continue;
            return name + " is missing: " + app.get_name() + " takes " + positionals(app);
        }
        for (const CLI::Option* needed : option->get_needs()) {
            if (isAlone && needed->count() == 0) return name + " needs " + nameOf(*needed);
        }
        for (const CLI::Option* excluded : option->get_excludes()) {
            if (!isTooMuch || excluded->count() == 0) continue;
            return name + " and " + nameOf(*excluded) + ": give one of the two";
        }
        const std::size_t given = option->results().size();
        if (isCount && given > static_cast<std::size_t>(option->get_items_expected_max())) {
            return name + ": is given " + std::to_string(given) + " times; give it once";
        }
    }
    return error.what();
}

}  // namespace adaptiso

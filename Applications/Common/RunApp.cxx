#include "Common/RunApp.h"

#include <fcntl.h>
#include <unistd.h>
#ifndef __EMSCRIPTEN__
#include <sys/prctl.h>
#include <sys/resource.h>
#endif

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <exception>
#include <iostream>
#include <memory>
#include <set>
#include <sstream>
#include <streambuf>
#include <string_view>

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/Log.h"
#include "Common/OptionValues.h"
#include "Common/UsageWords.h"
#include "Common/Verdict.h"
#include "adaptiso/Core/Habits.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Files/AtomicOutput.h"
#include "adaptiso/Json/OptionsJson.h"

namespace adaptiso {
namespace {

Json namesOf(const CLI::Option& option) {
    Json names = Json::array();
    for (const std::string& name : option.get_snames()) names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
    return names;
}

/// By name: the set is in the order of addresses, which differs from run to run.
Json namesOf(const std::set<CLI::Option*>& options) {
    std::set<std::string> names;
    for (const CLI::Option* option : options) names.insert(option->get_name());
    return names;
}

Json optionJson(const CLI::Option& option) {
    const bool takesValue = option.get_items_expected_max() > 0;
    const Json names = namesOf(option);
    const auto& lnames = option.get_lnames();
    const auto row = lnames.empty() ? declaredRows().end() : declaredRows().find(lnames.front());
    const bool isRow = row != declaredRows().end();
    return {{"names", names},
            {"value", names.empty() ? Json(option.get_name(true))
                      : takesValue  ? Json(option.get_type_name())
                                    : Json("")},
            {"repeats", option.get_items_expected_max() > 1},
            {"required", option.get_required()},
            {"group", option.get_group()},
            {"description", option.get_description()},
            {"needs", namesOf(option.get_needs())},
            {"excludes", namesOf(option.get_excludes())},
            {"row", isRow ? factsJson(*row->second.facts, row->second.kind, row->second.standard)
                          : Json(nullptr)}};
}

/// All that --help says, for machines (`adaptiso-mesh --help-json`): manual pages and completions
/// of shells are made from it when building (Applications/manual), so that they say what --help
/// says.
///
/// One JSON object: `schema` ("adaptiso-options/1"), `program`, `version`, `description`, `footer`
/// and `options`, a list in the order of --help of `names` (empty: positional), `value` (as --help
/// names it; empty: a flag), `repeats`, `required`, `group`, `description`, `needs`, `excludes` and
/// `row` (factsJson(), of a row of the library's tables; else null), from which the types of the
/// npm package are made.
std::string optionsJson(const CLI::App& app) {
    Json options = Json::array();
    for (const CLI::Option* option : app.get_options()) {
        if (!option->get_group().empty()) options.push_back(optionJson(*option));  // not hidden
    }
    const Json json{{"schema", "adaptiso-options/1"},
                    {"program", app.get_name()},
                    {"version", programVersion()},
                    {"description", app.get_description()},
                    {"options", options},
                    {"footer", app.get_footer()}};
    return json.dump(2) + "\n";
}

}  // namespace

std::string oneLine(std::string_view text) {
    std::string line = withoutControls(text);
    while (!line.empty() && line.back() == ' ') line.pop_back();
    return line;
}

void printError(std::string_view programName, std::string_view message) {
    std::cerr << programName << ": " << oneLine(message) << '\n';
    addToLog(withoutFolders(std::string(message)));
}

}  // namespace adaptiso

namespace adaptiso::detail {
namespace {

std::string terminatedProgram;

constexpr std::size_t kColumns = 80;

/// Passes what is written to a standard stream on withoutControls(), as long as it lives: names of
/// files, regions and patients must not steer the terminal.
class PlainStream : public std::streambuf {
public:
    explicit PlainStream(std::ostream& stream) : stream_(stream), target_(stream.rdbuf(this)) {}
    ~PlainStream() override {
        sync();
        stream_.rdbuf(target_);
    }
    PlainStream(const PlainStream&) = delete;
    PlainStream& operator=(const PlainStream&) = delete;

protected:
    int_type overflow(int_type c) override {
        if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
        const char byte = traits_type::to_char_type(c);
        return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
    }
    std::streamsize xsputn(const char* text, std::streamsize count) override {
        constexpr std::size_t kMostHeld = 1 << 16;
        held_.append(text, static_cast<std::size_t>(count));
        // a line ends with a whole character
        const std::size_t lines = held_.size() < kMostHeld ? 0 : held_.rfind('\n') + 1;
        return pass(lines) ? count : 0;
    }
    int sync() override { return pass(held_.size()) ? target_->pubsync() : -1; }

private:
    bool pass(std::size_t bytes) {
        const std::string text = withoutControls(std::string_view(held_).substr(0, bytes), "\n\t");
        held_.erase(0, bytes);
        return target_->sputn(text.data(), std::ssize(text)) == std::ssize(text);
    }

    std::ostream& stream_;
    std::streambuf* target_;
    std::string held_;
};

/// Neither a core file nor a crash reporter gets the image that a program has in memory.
void leaveNoCore() {
#if !defined(__EMSCRIPTEN__) && !defined(__SANITIZE_ADDRESS__)  // LeakSanitizer attaches to it
    const rlimit none{0, 0};
    setrlimit(RLIMIT_CORE, &none);
    prctl(PR_SET_DUMPABLE, 0);
#endif
}

/// Words of `text` on lines of at most `width` characters.
std::string folded(const std::string& text, std::size_t width, const std::string& indent = "") {
    std::istringstream words(text);
    std::string result;
    std::size_t used = 0;
    for (std::string word; words >> word; used += word.size()) {
        if (used > 0) {
            const bool isFull = used + 1 + word.size() > width;
            result += isFull ? '\n' + indent : " ";
            used = isFull ? 0 : used + 1;
        }
        result += word;
    }
    return result;
}

/// Help texts folded to 80 columns; CLI11 2.1 leaves that to the terminal.
class FoldedHelp : public CLI::Formatter {
public:
    std::string make_option_desc(const CLI::Option* option) const override {
        return folded(option->get_description(), kColumns - get_column_width());
    }
};

/// One screen, for -h alone: usage, the options' names by group, the first example.
std::string shortHelp(const CLI::App& app) {
    std::string text = FoldedHelp().make_usage(&app, app.get_name());
    text.insert(0, folded(app.get_description(), kColumns) + "\n");
    for (const std::string& group : app.get_groups()) {
        if (group.empty()) continue;  // hidden options
        std::string names;
        for (const CLI::Option* option : app.get_options()) {
            if (option->get_group() != group || !option->nonpositional()) continue;
            const bool takesValue = option->get_items_expected_max() > 0;
            const std::string value = takesValue ? "=" + option->get_type_name() : "";
            const auto& letters = option->get_snames();
            names += (letters.empty() ? "" : "-" + letters.front() + ",") + "--" +
                     option->get_lnames().front() + value + " ";
        }
        if (names.empty()) continue;
        text += group + ":\n  " + folded(names, kColumns - 2, "  ") + "\n";
    }
    const std::string& footer = app.get_footer();
    const std::size_t begin = footer.find("  " + app.get_name());
    if (begin != std::string::npos) {
        text += "\nExample:\n" + footer.substr(begin, footer.find('\n', begin) - begin) + "\n";
    }
    return text + "\nAll of it: " + app.get_name() + " --help, or man " + app.get_name() +
           "\nOf one option: " + app.get_name() + " --help OPTION\n";
}

/// A word of the text begins with `word`; hyphens count for nothing: "leadfield" is "lead-field".
bool holdsBeginning(const std::string& text, std::string word) {
    std::erase(word, '-');
    std::string plain;
    std::vector<std::size_t> begins;
    char before = ' ';
    for (const char c : text) {
        const bool isWithin = std::isalnum(static_cast<unsigned char>(before)) != 0;
        before = c;
        if (c == '-') continue;
        if (!isWithin) begins.push_back(plain.size());
        plain += c;
    }
    return std::ranges::any_of(
        begins, [&](std::size_t begin) { return plain.compare(begin, word.size(), word) == 0; });
}

/// Of --help the options that go by `word` or, where none does, that hold a word that begins so in
/// name or text; and what other programs' users mean by it. \throws UsageError  there is nothing
std::string helpOn(const CLI::App& app, const std::string& word) {
    const std::string name =
        lowerCase(word.substr(std::min(word.find_first_not_of('-'), word.size())));
    std::string exact, holding;
    std::vector<std::string> known;
    for (const CLI::Option* option : app.get_options()) {
        if (option->get_group().empty()) continue;  // hidden
        const std::string names = lowerCase("," + option->get_name(true, true) + ",");
        const std::string text = FoldedHelp().make_option(option, !option->nonpositional());
        for (const char* const dashes : {",", ",-", ",--"}) {
            if (names.find(dashes + name + ",") != std::string::npos) exact += text;
        }
        if (name.size() > 1 && holdsBeginning(lowerCase(names + option->get_description()), name)) {
            holding += text;
        }
        for (const std::string& own : option->get_lnames()) known.push_back(own);
    }
    if (!exact.empty()) return exact;
    const auto answer = habitAnswer(app.get_name(), name, known);
    if (!answer && holding.empty()) {
        throw UsageError("--help " + shown(word) + ": no option is named so" +
                         suggestion(name, known));
    }
    return answer ? word + ": " + *answer + "\n" : holding;
}

/// Tells why a run has failed, on stderr and to whom --json was asked for.
int fail(const Program& program, Verdict verdict) {
    const bool isUsage = verdict.exitCode == kExitUsage;
    printError(program.name, verdict.error + (isUsage ? " (see " + program.name + " --help)" : ""));
    writeFailureReport(program.name, verdict);
    return verdict.exitCode;
}

/// Where threads can't be started any more, oneTBB throws where nothing can catch it.
void endForWantOfThreads() {
    const std::exception_ptr error = std::current_exception();
    const Verdict verdict =
        error ? verdictOf(error) : Verdict{kExitInternalError, "internal error (please report it)"};
    removeTemporaries();
    printError(terminatedProgram, verdict.error);
    _exit(verdict.exitCode);
}

/// A program that is started without one of the standard streams must not take a file that it
/// opens for it: in the place of a missing stream stands one that can't be written, or has no end.
void keepStandardStreams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (fcntl(stream, F_GETFD) >= 0) continue;
        // the lowest number that is free
        (void)!open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    }
}

int runParsed(const Program& program, const std::function<int()>& run) {
    int code = kExitOk;
    try {
        code = run();
    } catch (...) {
        code = fail(program, verdictOf(std::current_exception()));
    }
    addToLog("ended with exit code " + std::to_string(code));
    return code;
}

}  // namespace

int runApp(int argc, const char* const* argv, const Program& program,
           const std::function<void(CLI::App&)>& declare, const std::function<int()>& run) {
    keepStandardStreams();
    leaveNoCore();
    const PlainStream out(std::cout), errors(std::cerr);
    removeOutputsOnSignals();
    terminatedProgram = program.name;
    std::set_terminate(endForWantOfThreads);
    rememberReport(argc, argv);
    CLI::App app(program.description, program.name);
    app.formatter(std::make_shared<FoldedHelp>());
    app.footer(program.footer);
    try {
        declare(app);
        if (argc == 2 && std::string_view(argv[1]) == "--help-json") {
            std::cout << optionsJson(app);
            return runParsed(program, [] { return flushResults(), kExitOk; });
        }
        if (argc == 2 && std::string_view(argv[1]) == "-h") {
            std::cout << shortHelp(app);
            return runParsed(program, [] { return flushResults(), kExitOk; });
        }
        const std::string_view first = argc == 3 ? argv[1] : "";
        if (first == "--help" || first == "-h") {
            std::cout << helpOn(app, argv[2]);
            return runParsed(program, [] { return flushResults(), kExitOk; });
        }
        refuseMisplacedValues(app, argc, argv);
        app.parse(argc, argv);
    } catch (const CLI::Success& asked) {
        const int code = app.exit(asked);  // --help, --version
        return runParsed(program, [code] { return flushResults(), code; });
    } catch (const CLI::ParseError& error) {
        return fail(program, {kExitUsage, inWords(app, error)});
    } catch (...) {
        return fail(program, verdictOf(std::current_exception()));
    }
    return runParsed(program, run);
}

}  // namespace adaptiso::detail

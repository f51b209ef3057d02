#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <ostream>
#include <thread>

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/RunApp.h"
#include "SelfTest.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::checker::selftest {
namespace {

/// The value of the first line "<name><separator>VALUE" of a file; "not said" without one.
std::string lineOf(const char* file, const std::string& name, char separator) {
    std::ifstream lines(file);
    for (std::string line; std::getline(lines, line);) {
        const auto at = line.find(separator);
        if (!line.starts_with(name) || at == std::string::npos) continue;
        std::string value = line.substr(at + 1);
        std::erase(value, '"');
        const auto start = value.find_first_not_of(" \t");
        return start == std::string::npos ? "not said" : oneLine(value.substr(start));
    }
    return "not said";
}

std::string memoryText() {
    const auto bytes =
        static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    return formatRounded(bytes / 1e6) + " MB";
}

std::string shown(const Measurement& m, double value) {
    if (m.isYesNo) return value == 1 ? "yes" : "no";
    if (m.unit.empty()) return formatNumber(value);
    return formatFixed(value, m.digits);
}

std::string quantityText(const Measurement& m) {
    return m.unit.empty() ? m.quantity : m.quantity + ", " + m.unit;
}

/// Expected, measured, tolerance, verdict.
std::vector<std::string> cells(const Measurement& m) {
    if (!m.error.empty()) return {"yes", m.error, "", "FAILED"};
    return {shown(m, m.expected), shown(m, m.measured),
            m.tolerance > 0 ? "± " + shown(m, m.tolerance) : "", m.hasPassed() ? "ok" : "FAILED"};
}

std::string verdictText(const SelfTest& test) {
    const auto count = formatCount(std::ssize(test.measurements));
    return test.hasPassed() ? "All " + count + " answers are right."
                            : formatCount(static_cast<long long>(test.failures())) + " of " +
                                  count + " answers are wrong.";
}

std::string padded(const std::string& text, std::size_t width) {
    // "±" takes two bytes and one column
    const auto columns =
        static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
            return (static_cast<unsigned char>(c) >> 6) != 2;
        }));
    return text + std::string(columns < width ? width - columns : 1, ' ');
}

}  // namespace

Machine thisMachine() {
    utsname system{};
    uname(&system);
    std::string versions = versionText(kProgram);
    std::replace(versions.begin(), versions.end(), '\n', ',');
    versions.insert(versions.find(',') + 1, " ");
    return {{"Program", versions},
            {"Host", oneLine(system.nodename)},
            {"Processor", lineOf("/proc/cpuinfo", "model name", ':') + ", " +
                              formatCount(std::thread::hardware_concurrency()) + " threads, " +
                              system.machine},
            {"Memory", memoryText()},
            {"System", lineOf("/etc/os-release", "PRETTY_NAME", '=') + ", " + system.sysname + " " +
                           system.release}};
}

void printText(std::ostream& out, const SelfTest& test, const Machine& machine,
               const std::string& date, const StageTimer& timer) {
    out << "Self-test of adaptiso: phantoms whose answers are known\n\n";
    for (const auto& [name, value] : machine) out << padded(name, 12) << value << '\n';
    out << padded("Date", 12) << date << "\n\n"
        << padded("Phantom", 50) << padded("Quantity", 34) << padded("Expected", 12)
        << padded("Measured", 12) << "Tolerance\n";
    std::string subject;
    for (const Measurement& m : test.measurements) {
        const std::vector<std::string> row = cells(m);
        out << padded(m.subject == subject ? "" : m.subject, 50) << padded(quantityText(m), 34)
            << padded(row[0], 12) << padded(row[1], 12) << padded(row[2], 12) << row[3] << '\n';
        subject = m.subject;
    }
    out << "\n=> " << (test.hasPassed() ? "passed" : "FAILED") << ": " << verdictText(test) << '\n'
        << formatFixed(timer.total(), 2) << " s, peak memory " << formatRounded(peakMemoryMb())
        << " MB\n\n"
        << "Name ____________________   Date ____________   Signature ____________________\n";
}

std::string jsonText(const SelfTest& test, const Verdict& verdict, const Machine& machine,
                     const std::string& date, const StageTimer& timer) {
    Json ran = Json::object();
    for (const auto& [name, value] : machine) {
        std::string key = name;
        key.front() = static_cast<char>(key.front() - 'A' + 'a');
        if (key != "program") ran[key] = value;
    }
    Json measurements = Json::array();
    for (const Measurement& m : test.measurements) {
        measurements.push_back({{"phantom", m.subject},
                                {"quantity", m.quantity},
                                {"unit", m.unit.empty() ? Json(nullptr) : Json(m.unit)},
                                {"expected", number(m.expected)},
                                {"tolerance", number(m.tolerance)},
                                {"measured", m.error.empty() ? number(m.measured) : Json(nullptr)},
                                {"error", m.error.empty() ? Json(nullptr) : Json(m.error)},
                                {"passed", m.hasPassed()}});
    }
    Json report = reportHead("adaptiso-check-self-test/1", kProgram, verdict, {});
    report.update(Json{{"date", date},
                       {"machine", ran},
                       {"measurements", measurements},
                       {"failures", test.failures()},
                       {"seconds", secondsJson(timer)},
                       {"peakMemoryMb", peakMemoryMb()}});
    return adaptiso::jsonText(report) + "\n";
}

Report reportPage(SelfTest& test, const Machine& machine) {
    Report report;
    report.title = "Self-test of adaptiso";
    report.verdict = test.hasPassed() ? ReportVerdict::Passed : ReportVerdict::Failed;
    report.headline = verdictText(test);
    report.inputs.assign(machine.begin(), machine.end());
    for (const Measurement& m : test.measurements) {
        const std::vector<std::string> row = cells(m);
        report.checks.push_back({m.subject, quantityText(m),
                                 m.hasPassed() ? ReportOutcome::Passed : ReportOutcome::Failed,
                                 m.error.empty() ? row[1] + " (expected " + row[0] +
                                                       (m.tolerance > 0 ? " " + row[2] : "") + ")"
                                                 : m.error});
    }
    report.tables.push_back({"Signed by the person who installed or accepted this program",
                             {"Name", "Date", "Signature"},
                             {{"____________________", "____________", "____________________"}}});
    report.notes = {
        "Phantoms are made by formula, written as image files, read, made into surfaces, written "
        "as "
        "mesh files, read and measured. Expected values are those of the formula."};
    for (SelfTest::Shown& surface : test.shown) {
        report.surfaces.push_back({surface.name, std::move(surface.mesh), {}});
    }
    return report;
}

}  // namespace adaptiso::checker::selftest

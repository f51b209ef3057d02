#include "Common/OptionsJson.h"

#include <CLI/CLI.hpp>
#include <set>

#include "Common/CommonOptions.h"
#include "Common/Json.h"

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
    return {{"names", names},
            {"value", names.empty() ? Json(option.get_name(true))
                      : takesValue  ? Json(option.get_type_name())
                                    : Json("")},
            {"repeats", option.get_items_expected_max() > 1},
            {"required", option.get_required()},
            {"group", option.get_group()},
            {"description", option.get_description()},
            {"needs", namesOf(option.get_needs())},
            {"excludes", namesOf(option.get_excludes())}};
}

}  // namespace

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

}  // namespace adaptiso

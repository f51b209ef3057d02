#pragma once

#include "adaptiso/Files/StageTimer.h"
#include "adaptiso/Json/Json.h"

namespace adaptiso {

/// `seconds` of a report: every stage, and their total.
inline Json secondsJson(const StageTimer& timer) {
    Json seconds = Json::object();
    for (const auto& [stage, time] : timer.stages()) seconds[stage] = time;
    seconds["total"] = timer.total();
    return seconds;
}

}  // namespace adaptiso

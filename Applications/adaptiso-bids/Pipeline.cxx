#include "Pipeline.h"

#include "Common/Verdict.h"
#include "Common/Warnings.h"
#include "Dataset.h"
#include "Levels.h"

namespace adaptiso {

int runBids(const BidsOptions& options) {
    const ChosenSubjects chosen = chooseSubjects(options);
    printWarnings("adaptiso-bids", options.common, chosen.warnings);
    Verdict verdict{options.level == BidsLevel::Participant ? runParticipants(options, chosen)
                                                            : runGroup(options, chosen)};
    if (verdict.exitCode == kExitOk) verdict.failStrict(options.common, chosen.warnings, "");
    return printVerdict("adaptiso-bids", verdict, "");
}

}  // namespace adaptiso

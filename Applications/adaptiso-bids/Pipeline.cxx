#include "Pipeline.h"

#include "Dataset.h"
#include "Levels.h"

namespace adaptiso {

int runBids(const BidsOptions& options) {
    const std::vector<std::filesystem::path> subjects = chosenSubjects(options);
    return options.level == BidsLevel::Participant ? runParticipants(options, subjects)
                                                   : runGroup(options, subjects);
}

}  // namespace adaptiso

#include "CommandLine.h"
#include "Common/RunApp.h"
#include "Pipeline.h"

int main(int argc, char** argv) {
    return adaptiso::runApp(argc, argv, adaptiso::compare::compareProgram(),
                            adaptiso::compare::declareCompareOptions,
                            adaptiso::compare::runCompare);
}

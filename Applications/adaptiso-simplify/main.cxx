#include "CommandLine.h"
#include "Common/RunApp.h"
#include "Pipeline.h"
#include "adaptiso/Core/ReturnMemory.h"

int main(int argc, char** argv) {
    adaptiso::keepFreedMemory();
    return adaptiso::runApp(argc, argv, adaptiso::simplifier::simplifyProgram(),
                            adaptiso::simplifier::declareSimplifyOptions,
                            adaptiso::simplifier::runSimplify);
}

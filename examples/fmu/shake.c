/* Shakes a block through the C interface of its FMU: a fifth of a second of ground acceleration each way, then rest.
 *
 * README.md beside this file has the commands. GUID, A_GX and THETA come from modelDescription.xml. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "fmi2Functions.h"

static void log_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                        fmi2String message, ...) {
    (void)environment, (void)status, (void)category;
    fprintf(stderr, "%s: %s\n", instance, message);
}

static const fmi2ValueReference a_gx = A_GX, theta = THETA;

int main(void) {
    fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL};
    fmi2Real rotation = 0, largest = 0;
    fmi2Component block = fmi2Instantiate("block", fmi2CoSimulation, GUID, "", &callbacks, fmi2False, fmi2False);
    if (block == NULL) {
        return EXIT_FAILURE;
    }
    fmi2SetupExperiment(block, fmi2False, 0, 0, fmi2False, 0);
    fmi2EnterInitializationMode(block);
    fmi2ExitInitializationMode(block);
    for (int step = 0; step < 1000; step++) {
        fmi2Real a = step < 20 ? 4 : step < 40 ? -4 : 0;
        fmi2SetReal(block, &a_gx, 1, &a);
        fmi2DoStep(block, 0.01 * step, 0.01, fmi2True);
        fmi2GetReal(block, &theta, 1, &rotation);
        if (rotation * rotation > largest * largest) {
            largest = rotation;
        }
    }
    fmi2Terminate(block);
    fmi2FreeInstance(block);
    printf("largest rotation %.4f rad\n", largest);
    return EXIT_SUCCESS;
}

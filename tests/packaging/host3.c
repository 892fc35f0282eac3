/* A small importer of FMI 3.0: LIBRARY and a file of commands (made by cases.py) -> all values as bits, line by line, in the
   words of host.c, so that both versions can be compared byte by byte. */

#include "host.h"

#include <stdbool.h>

/* The types and functions of the standard's headers that are used here. */
typedef void *Component;
typedef void Logger(void *environment, int status, const char *category, const char *message);

#define FUNCTIONS(X)                                                                                                   \
    X(Component, InstantiateCoSimulation,                                                                              \
      (const char *, const char *, const char *, bool, bool, bool, bool, const Reference *, size_t, void *, Logger *,  \
       void *))                                                                                                        \
    X(int, EnterInitializationMode, (Component, bool, double, double, bool, double))                                   \
    X(int, ExitInitializationMode, (Component))                                                                        \
    X(int, SetFloat64, (Component, const Reference *, size_t, const double *, size_t))                                 \
    X(int, SetInt32, (Component, const Reference *, size_t, const int32_t *, size_t))                                  \
    X(int, SetInt64, (Component, const Reference *, size_t, const int64_t *, size_t))                                  \
    X(int, SetBoolean, (Component, const Reference *, size_t, const bool *, size_t))                                   \
    X(int, GetFloat64, (Component, const Reference *, size_t, double *, size_t))                                       \
    X(int, GetInt32, (Component, const Reference *, size_t, int32_t *, size_t))                                        \
    X(int, GetInt64, (Component, const Reference *, size_t, int64_t *, size_t))                                        \
    X(int, GetBoolean, (Component, const Reference *, size_t, bool *, size_t))                                         \
    X(int, GetOutputDerivatives, (Component, const Reference *, size_t, const int32_t *, double *, size_t))            \
    X(int, GetDirectionalDerivative,                                                                                   \
      (Component, const Reference *, size_t, const Reference *, size_t, const double *, size_t, double *, size_t))     \
    X(int, DoStep, (Component, double, double, bool, bool *, bool *, bool *, double *))                                \
    X(int, Terminate, (Component))                                                                                     \
    X(void, FreeInstance, (Component))

#define POINTER(result, name, arguments) static result(*name) arguments;
FUNCTIONS(POINTER)

static void logger(void *environment, int status, const char *category, const char *message)
{
    (void)environment;
    printf("log %d %s: %s\n", status, category, message);
}

/* The variables read after each step; those of `outputs` have derivatives with respect to time and to `inputs`. Integers are in the
   order of FMI 2.0, those of which are choices are of another type here. */
static List reals, integers, booleans, outputs, inputs;
static bool is_choice[MOST];

static void print_all(Component fmu, const char *what)
{
    double values[MOST];
    bool flags[MOST];
    size_t i;
    printf("%s", what);
    expect_ok(GetFloat64(fmu, reals.references, reals.count, values, reals.count), "fmi3GetFloat64");
    print_values(values, reals.count);
    for (i = 0; i < integers.count; i++) {
        int32_t integer = 0;
        int64_t choice = 0;
        if (is_choice[i])
            expect_ok(GetInt64(fmu, &integers.references[i], 1, &choice, 1), "fmi3GetInt64");
        else
            expect_ok(GetInt32(fmu, &integers.references[i], 1, &integer, 1), "fmi3GetInt32");
        printf(" %d", is_choice[i] ? (int)choice : (int)integer);
    }
    expect_ok(GetBoolean(fmu, booleans.references, booleans.count, flags, booleans.count), "fmi3GetBoolean");
    for (i = 0; i < booleans.count; i++)
        printf(" %d", flags[i] ? 1 : 0);
    printf("\n");
}

static void print_derivatives(Component fmu)
{
    double values[MOST], one = 1.0;
    int32_t orders[MOST];
    size_t i;
    for (i = 0; i < MOST; i++)
        orders[i] = 1;
    printf("rates");
    expect_ok(GetOutputDerivatives(fmu, outputs.references, outputs.count, orders, values, outputs.count),
              "fmi3GetOutputDerivatives");
    print_values(values, outputs.count);
    printf("\n");
    for (i = 0; i < inputs.count; i++) {
        expect_ok(GetDirectionalDerivative(fmu, outputs.references, outputs.count, &inputs.references[i], 1, &one, 1,
                                           values, outputs.count),
                  "fmi3GetDirectionalDerivative");
        printf("directional %u", (unsigned)inputs.references[i]);
        print_values(values, outputs.count);
        printf("\n");
    }
}

int main(int count, char **arguments)
{
    char line[512], token[128] = "";
    Component fmu = NULL;
    FILE *commands;
    void *loaded;
    /* As fmi2DoStep has it: 2 once the run has ended by itself. */
    int status = 0;
    double reached = 0.0;
    if (count != 3) {
        fprintf(stderr, "expected: LIBRARY COMMANDS\n");
        return 2;
    }
    commands = fopen(arguments[2], "rb");
    if (!commands) {
        fprintf(stderr, "error: %s cannot be read\n", arguments[2]);
        return 1;
    }
#ifdef _WIN32
    _setmode(_fileno(stdout), _O_BINARY);
#endif
    loaded = load(arguments[1]);
#define LOAD(result, name, types) *(void **)&name = function(loaded, "fmi3" #name);
    FUNCTIONS(LOAD)

    while (fgets(line, sizeof line, commands)) {
        char command[32], words[2][128];
        int given;
        line_number++;
        words[0][0] = words[1][0] = 0;
        given = sscanf(line, "%31s %127s %127s", command, words[0], words[1]);
        if (given < 1)
            continue;
        if (!strcmp(command, "guid")) {
            strcpy(token, words[0]);
        } else if (!strcmp(command, "list")) {
            bool choice = !strcmp(words[0], "choice");
            List *list = !strcmp(words[0], "real")                ? &reals
                         : choice || !strcmp(words[0], "integer") ? &integers
                         : !strcmp(words[0], "boolean")           ? &booleans
                         : !strcmp(words[0], "output")            ? &outputs
                                                                  : &inputs;
            append(list, words[1]);
            if (list == &integers)
                is_choice[integers.count - 1] = choice;
        } else if (!strcmp(command, "case")) {
            printf("case %s\n", words[0]);
            fmu = InstantiateCoSimulation(words[0], token, NULL, false, true, false, false, NULL, 0, NULL, logger, NULL);
            if (!fmu)
                fail("fmi3InstantiateCoSimulation gives no instance for", words[0]);
            status = 0;
            reached = 0.0;
        } else if (!strcmp(command, "end")) {
            printf("end %d", status);
            print_values(&reached, 1);
            printf("\n");
            expect_ok(Terminate(fmu), "fmi3Terminate");
            FreeInstance(fmu);
            fmu = NULL;
        } else if (status != 0) {
            /* The run has ended: the rest of its commands is left out. */
        } else if (!strcmp(command, "real")) {
            Reference reference = (Reference)strtoul(words[0], NULL, 10);
            double value = number(words[1]);
            expect_ok(SetFloat64(fmu, &reference, 1, &value, 1), "fmi3SetFloat64");
        } else if (!strcmp(command, "integer")) {
            Reference reference = (Reference)strtoul(words[0], NULL, 10);
            int32_t value = atoi(words[1]);
            expect_ok(SetInt32(fmu, &reference, 1, &value, 1), "fmi3SetInt32");
        } else if (!strcmp(command, "choice")) {
            Reference reference = (Reference)strtoul(words[0], NULL, 10);
            int64_t value = atoi(words[1]);
            expect_ok(SetInt64(fmu, &reference, 1, &value, 1), "fmi3SetInt64");
        } else if (!strcmp(command, "boolean")) {
            Reference reference = (Reference)strtoul(words[0], NULL, 10);
            bool value = atoi(words[1]) != 0;
            expect_ok(SetBoolean(fmu, &reference, 1, &value, 1), "fmi3SetBoolean");
        } else if (!strcmp(command, "start")) {
            expect_ok(EnterInitializationMode(fmu, true, number(words[0]), 0.0, false, 0.0),
                      "fmi3EnterInitializationMode");
            expect_ok(ExitInitializationMode(fmu), "fmi3ExitInitializationMode");
            print_all(fmu, "start");
        } else if (!strcmp(command, "step")) {
            bool event, terminates, early;
            expect_ok(DoStep(fmu, number(words[0]), number(words[1]), true, &event, &terminates, &early, &reached),
                      "fmi3DoStep");
            status = terminates ? 2 : 0;
            print_all(fmu, "step");
        } else if (!strcmp(command, "derivatives")) {
            print_derivatives(fmu);
        } else if (strcmp(command, "state")) {
            fail("unknown command", command);
        }
    }
    fclose(commands);
    return 0;
}

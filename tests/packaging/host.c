/* A small importer: LIBRARY and a file of commands (made by cases.py) -> all values as bits, line by line.
   The same source is compiled for every target, so that what it prints can be compared byte by byte. */

#include "host.h"

#include <stdarg.h>

/* The types and functions of the standard's headers that are used here. */
typedef void *Component;
typedef void *State;
typedef void Logger(void *environment, const char *instance, int status, const char *category, const char *format, ...);
typedef struct {
    Logger *logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, int);
    void *environment;
} Callbacks;

#define FUNCTIONS(X)                                                                                                   \
    X(Component, Instantiate, (const char *, int, const char *, const char *, const Callbacks *, int, int))            \
    X(int, SetupExperiment, (Component, int, double, double, int, double))                                             \
    X(int, EnterInitializationMode, (Component))                                                                       \
    X(int, ExitInitializationMode, (Component))                                                                        \
    X(int, SetReal, (Component, const Reference *, size_t, const double *))                                            \
    X(int, SetInteger, (Component, const Reference *, size_t, const int *))                                            \
    X(int, SetBoolean, (Component, const Reference *, size_t, const int *))                                            \
    X(int, GetReal, (Component, const Reference *, size_t, double *))                                                  \
    X(int, GetInteger, (Component, const Reference *, size_t, int *))                                                  \
    X(int, GetBoolean, (Component, const Reference *, size_t, int *))                                                  \
    X(int, SetRealInputDerivatives, (Component, const Reference *, size_t, const int *, const double *))               \
    X(int, GetRealOutputDerivatives, (Component, const Reference *, size_t, const int *, double *))                    \
    X(int, GetDirectionalDerivative,                                                                                   \
      (Component, const Reference *, size_t, const Reference *, size_t, const double *, double *))                     \
    X(int, DoStep, (Component, double, double, int))                                                                   \
    X(int, GetRealStatus, (Component, int, double *))                                                                  \
    X(int, GetFMUstate, (Component, State *))                                                                          \
    X(int, SetFMUstate, (Component, State))                                                                            \
    X(int, FreeFMUstate, (Component, State *))                                                                         \
    X(int, SerializedFMUstateSize, (Component, State, size_t *))                                                       \
    X(int, SerializeFMUstate, (Component, State, unsigned char *, size_t))                                             \
    X(int, DeSerializeFMUstate, (Component, const unsigned char *, size_t, State *))                                   \
    X(int, Terminate, (Component))                                                                                     \
    X(void, FreeInstance, (Component))

#define POINTER(result, name, arguments) static result(*name) arguments;
FUNCTIONS(POINTER)

static void logger(void *environment, const char *instance, int status, const char *category, const char *format, ...)
{
    va_list arguments;
    (void)environment;
    printf("log %s %d %s: ", instance, status, category);
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    printf("\n");
}

/* The variables read after each step; those of `outputs` have derivatives with respect to time and to `inputs`. */
static List reals, integers, booleans, outputs, inputs;

static void print_all(Component fmu, const char *what)
{
    double values[MOST];
    int numbers[MOST];
    size_t i;
    printf("%s", what);
    expect_ok(GetReal(fmu, reals.references, reals.count, values), "fmi2GetReal");
    print_values(values, reals.count);
    expect_ok(GetInteger(fmu, integers.references, integers.count, numbers), "fmi2GetInteger");
    for (i = 0; i < integers.count; i++)
        printf(" %d", numbers[i]);
    expect_ok(GetBoolean(fmu, booleans.references, booleans.count, numbers), "fmi2GetBoolean");
    for (i = 0; i < booleans.count; i++)
        printf(" %d", numbers[i]);
    printf("\n");
}

static void print_derivatives(Component fmu)
{
    double values[MOST], one = 1.0;
    int orders[MOST];
    size_t i;
    for (i = 0; i < MOST; i++)
        orders[i] = 1;
    printf("rates");
    expect_ok(GetRealOutputDerivatives(fmu, outputs.references, outputs.count, orders, values),
              "fmi2GetRealOutputDerivatives");
    print_values(values, outputs.count);
    printf("\n");
    for (i = 0; i < inputs.count; i++) {
        expect_ok(GetDirectionalDerivative(fmu, outputs.references, outputs.count, &inputs.references[i], 1, &one,
                                           values),
                  "fmi2GetDirectionalDerivative");
        printf("directional %u", inputs.references[i]);
        print_values(values, outputs.count);
        printf("\n");
    }
}

/* Prints a saved state's bytes, and continues from a copy made of them. */
static void save_and_restore(Component fmu)
{
    State state = NULL, copy = NULL;
    unsigned char *bytes;
    size_t size, i;
    expect_ok(GetFMUstate(fmu, &state), "fmi2GetFMUstate");
    expect_ok(SerializedFMUstateSize(fmu, state, &size), "fmi2SerializedFMUstateSize");
    bytes = malloc(size);
    if (!bytes)
        fail("no memory for", "a state");
    expect_ok(SerializeFMUstate(fmu, state, bytes, size), "fmi2SerializeFMUstate");
    printf("state ");
    for (i = 0; i < size; i++)
        printf("%02x", bytes[i]);
    printf("\n");
    expect_ok(DeSerializeFMUstate(fmu, bytes, size, &copy), "fmi2DeSerializeFMUstate");
    expect_ok(SetFMUstate(fmu, copy), "fmi2SetFMUstate");
    expect_ok(FreeFMUstate(fmu, &state), "fmi2FreeFMUstate");
    expect_ok(FreeFMUstate(fmu, &copy), "fmi2FreeFMUstate");
    free(bytes);
}

int main(int count, char **arguments)
{
    static const Callbacks callbacks = {logger, NULL, NULL, NULL, NULL};
    char line[512], guid[128] = "";
    Component fmu = NULL;
    FILE *commands;
    void *loaded;
    int status = 0;
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
#define LOAD(result, name, types) *(void **)&name = function(loaded, "fmi2" #name);
    FUNCTIONS(LOAD)

    while (fgets(line, sizeof line, commands)) {
        char command[32], words[3][128];
        int given;
        line_number++;
        words[0][0] = words[1][0] = words[2][0] = 0;
        given = sscanf(line, "%31s %127s %127s %127s", command, words[0], words[1], words[2]);
        if (given < 1)
            continue;
        if (!strcmp(command, "guid")) {
            strcpy(guid, words[0]);
        } else if (!strcmp(command, "list")) {
            List *list = !strcmp(words[0], "real")      ? &reals
                         : !strcmp(words[0], "integer") ? &integers
                         : !strcmp(words[0], "boolean") ? &booleans
                         : !strcmp(words[0], "output")  ? &outputs
                                                        : &inputs;
            append(list, words[1]);
        } else if (!strcmp(command, "case")) {
            printf("case %s\n", words[0]);
            fmu = Instantiate(words[0], 1, guid, "", &callbacks, 0, 1);
            if (!fmu)
                fail("fmi2Instantiate gives no instance for", words[0]);
            status = 0;
        } else if (!strcmp(command, "end")) {
            double time;
            expect_ok(GetRealStatus(fmu, 2, &time), "fmi2GetRealStatus");
            printf("end %d", status);
            print_values(&time, 1);
            printf("\n");
            if (status == 0)
                expect_ok(Terminate(fmu), "fmi2Terminate");
            FreeInstance(fmu);
            fmu = NULL;
        } else if (status != 0) {
            /* The run has ended: the rest of its commands is left out. */
        } else if (!strcmp(command, "real")) {
            Reference reference = (Reference)strtoul(words[0], NULL, 10);
            double value = number(words[1]);
            expect_ok(SetReal(fmu, &reference, 1, &value), "fmi2SetReal");
        } else if (!strcmp(command, "integer") || !strcmp(command, "boolean")) {
            Reference reference = (Reference)strtoul(words[0], NULL, 10);
            int value = atoi(words[1]);
            expect_ok((command[0] == 'i' ? SetInteger : SetBoolean)(fmu, &reference, 1, &value), command);
        } else if (!strcmp(command, "ramp")) {
            Reference reference = (Reference)strtoul(words[0], NULL, 10);
            double value = number(words[1]), rate = number(words[2]);
            int order = 1;
            expect_ok(SetReal(fmu, &reference, 1, &value), "fmi2SetReal");
            expect_ok(SetRealInputDerivatives(fmu, &reference, 1, &order, &rate), "fmi2SetRealInputDerivatives");
        } else if (!strcmp(command, "start")) {
            expect_ok(SetupExperiment(fmu, 1, number(words[0]), 0.0, 0, 0.0), "fmi2SetupExperiment");
            expect_ok(EnterInitializationMode(fmu), "fmi2EnterInitializationMode");
            expect_ok(ExitInitializationMode(fmu), "fmi2ExitInitializationMode");
            print_all(fmu, "start");
        } else if (!strcmp(command, "step")) {
            status = DoStep(fmu, number(words[0]), number(words[1]), 1);
            if (status > 2)
                fail("fmi2DoStep gives an error at", words[0]);
            print_all(fmu, "step");
        } else if (!strcmp(command, "derivatives")) {
            print_derivatives(fmu);
        } else if (!strcmp(command, "state")) {
            save_and_restore(fmu);
        } else {
            fail("unknown command", command);
        }
    }
    fclose(commands);
    return 0;
}

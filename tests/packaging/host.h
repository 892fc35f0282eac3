/* The parts that host.c and host3.c have in common: the library's functions, numbers as bits, lists of variables. */

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <fcntl.h>
#include <io.h>
#include <windows.h>
#else
#include <dlfcn.h>
#endif

static unsigned long line_number;

static void fail(const char *what, const char *found)
{
    fflush(stdout);
    fprintf(stderr, "error: line %lu of the commands: %s: %s\n", line_number, what, found);
    exit(1);
}

static void *load(const char *library)
{
#ifdef _WIN32
    void *loaded = (void *)LoadLibraryA(library);
    if (!loaded) {
        fprintf(stderr, "error: %s does not load: Windows error %lu\n", library, GetLastError());
        exit(1);
    }
#else
    void *loaded = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    if (!loaded) {
        fprintf(stderr, "error: %s does not load: %s\n", library, dlerror());
        exit(1);
    }
#endif
    return loaded;
}

static void *function(void *loaded, const char *name)
{
#ifdef _WIN32
    void *found = (void *)GetProcAddress((HMODULE)loaded, name);
#else
    void *found = dlsym(loaded, name);
#endif
    if (!found)
        fail("the library does not export", name);
    return found;
}

static double number(const char *bits)
{
    uint64_t integer = strtoull(bits, NULL, 16);
    double value;
    memcpy(&value, &integer, sizeof value);
    return value;
}

static void print_values(const double *values, size_t count)
{
    size_t i;
    for (i = 0; i < count; i++) {
        uint64_t integer;
        memcpy(&integer, &values[i], sizeof integer);
        printf(" %016" PRIx64, integer);
    }
}

static void expect_ok(int status, const char *call)
{
    if (status != 0) {
        char text[16];
        sprintf(text, "status %d", status);
        fail(call, text);
    }
}

typedef uint32_t Reference;

#define MOST 256
typedef struct {
    Reference references[MOST];
    size_t count;
} List;

static void append(List *list, const char *reference)
{
    if (list->count == MOST)
        fail("too many variables, expected at most 256, the last one is", reference);
    list->references[list->count++] = (Reference)strtoul(reference, NULL, 10);
}

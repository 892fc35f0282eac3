/* Replaces a system DLL that wine lacks before 9.0. Rust takes the seeds of hash maps from it; any bytes will do. */
#include <string.h>

__declspec(dllexport) int ProcessPrng(unsigned char *data, size_t count) { return memset(data, 7, count) != NULL; }

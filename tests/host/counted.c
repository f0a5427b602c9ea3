#include "counted.h"

#include <stdint.h>
#include <string.h>

#include <sys/mman.h>

#include "gl.h"

enum { FUNCTIONS = 1024, CODE_BYTES = 32 };

static struct {
  char name[64];
  int64_t calls;
} functions[FUNCTIONS];
static int function_count;
static unsigned char *code;

int counted_available(void) {
#if defined(__x86_64__)
  if (!code) {
    void *memory =
        mmap(NULL, FUNCTIONS * CODE_BYTES, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory != MAP_FAILED) code = memory;
  }
#endif
  return code != NULL;
}

/* mov rax, counter; inc qword [rax]; mov rax, function; jmp rax. No argument travels in rax, and all others stay. */
static void write_code(unsigned char *out, const int64_t *counter, const void *function) {
  static const unsigned char load[2] = {0x48, 0xb8}, increment[3] = {0x48, 0xff, 0x00}, jump[2] = {0xff, 0xe0};
  memcpy(out, load, 2);
  memcpy(out + 2, &counter, 8);
  memcpy(out + 10, increment, 3);
  memcpy(out + 13, load, 2);
  memcpy(out + 15, &function, 8);
  memcpy(out + 23, jump, 2);
}

/* A function is counted in one place, however many contexts ask for it. */
void *counted_address(void *user, const char *name) {
  void *function = gl_address(user, name);
  for (int i = 0; i < function_count; i++)
    if (strcmp(functions[i].name, name) == 0) return code + i * CODE_BYTES;
  if (!function || function_count == FUNCTIONS || strlen(name) >= sizeof functions[0].name) return function;
  int i = function_count++;
  strcpy(functions[i].name, name);
  functions[i].calls = 0;
  write_code(code + i * CODE_BYTES, &functions[i].calls, function);
  return code + i * CODE_BYTES;
}

long counted_calls(const char *prefix) {
  long sum = 0;
  for (int i = 0; i < function_count; i++) {
    if (strncmp(functions[i].name, prefix, strlen(prefix)) == 0) sum += (long)functions[i].calls;
  }
  return sum;
}

void counted_reset(void) {
  for (int i = 0; i < function_count; i++) functions[i].calls = 0;
}

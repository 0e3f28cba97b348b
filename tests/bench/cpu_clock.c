// Preloaded into any build of voxcast: its one clock, CLOCK_MONOTONIC, tells the CPU time of the
// process, all threads together, so that statistics of frames and passes are in CPU time, whatever
// else the machine does. Calls of libraries, such as the driver's, get what they ask for.
#define _GNU_SOURCE
#include <link.h>
#include <stdint.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static uintptr_t program_begin, program_end;

// The first object is the program itself.
static int take_program(struct dl_phdr_info *info, size_t size, void *unused)
{
    (void)size, (void)unused;
    program_begin = UINTPTR_MAX;
    for (int i = 0; i < info->dlpi_phnum; i++) {
        const ElfW(Phdr) *segment = &info->dlpi_phdr[i];
        uintptr_t begin = info->dlpi_addr + segment->p_vaddr;
        if (segment->p_type != PT_LOAD)
            continue;
        program_begin = begin < program_begin ? begin : program_begin;
        program_end = begin + segment->p_memsz;
    }
    return 1;
}

__attribute__((constructor)) static void find_program(void)
{
    dl_iterate_phdr(take_program, NULL);
}

int clock_gettime(clockid_t clock, struct timespec *out_now)
{
    uintptr_t caller = (uintptr_t)__builtin_return_address(0);
    if (clock == CLOCK_MONOTONIC && caller >= program_begin && caller < program_end)
        clock = CLOCK_PROCESS_CPUTIME_ID;
    return (int)syscall(SYS_clock_gettime, clock, out_now);
}

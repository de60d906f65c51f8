/* Let the n-th write to a file, and every one after it, fail as on a full disk: LD_PRELOAD, SOAK_FULL_AFTER=n.
   Standard streams, pipes and devices are left alone. SOAK_COUNT names a file that is told how many writes there were. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

static long seen;

static int full(int fd) {
    struct stat status;
    const char *after = getenv("SOAK_FULL_AFTER");
    if (fd < 3 || !after || fstat(fd, &status) || !S_ISREG(status.st_mode)) return 0;
    if (++seen <= atol(after)) return 0;
    errno = ENOSPC;
    return 1;
}

__attribute__((destructor)) static void tell(void) {
    const char *name = getenv("SOAK_COUNT");
    FILE *file = name ? fopen(name, "w") : 0;
    if (!file) return;
    fprintf(file, "%ld\n", seen);
    fclose(file);
}

ssize_t write(int fd, const void *data, size_t size) {
    static ssize_t (*next)(int, const void *, size_t);
    if (!next) next = (ssize_t (*)(int, const void *, size_t))dlsym(RTLD_NEXT, "write");
    return full(fd) ? -1 : next(fd, data, size);
}

ssize_t pwrite64(int fd, const void *data, size_t size, off64_t at) {
    static ssize_t (*next)(int, const void *, size_t, off64_t);
    if (!next) next = (ssize_t (*)(int, const void *, size_t, off64_t))dlsym(RTLD_NEXT, "pwrite64");
    return full(fd) ? -1 : next(fd, data, size, at);
}

ssize_t writev(int fd, const struct iovec *parts, int count) {
    static ssize_t (*next)(int, const struct iovec *, int);
    if (!next) next = (ssize_t (*)(int, const struct iovec *, int))dlsym(RTLD_NEXT, "writev");
    return full(fd) ? -1 : next(fd, parts, count);
}

int ftruncate64(int fd, off64_t size) {
    static int (*next)(int, off64_t);
    if (!next) next = (int (*)(int, off64_t))dlsym(RTLD_NEXT, "ftruncate64");
    return full(fd) ? -1 : next(fd, size);
}

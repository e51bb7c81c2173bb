/* Counts the calls that change the disk, and disturbs one of them or all from one on.
 *
 * Loaded with LD_PRELOAD. A call counts if it creates, writes, renames, syncs or removes something:
 * open with O_CREAT, write to a regular file other than stdin, stdout and stderr, rename, fsync,
 * fdatasync, mkdir, unlink, ftruncate and their variants. Its letter is c, w, r, s, m, u or t. An open
 * of an existing file is o.
 *
 * TORTURE_LOG    file of 64 KiB: a count (8 bytes), then one letter per call: its kind
 * TORTURE_MODE   count | before | half | from | once | short
 * TORTURE_AT     number of the call, from 1
 * TORTURE_ERRNO  the error that "from" and "once" give
 * TORTURE_KINDS  letters of the calls that count; empty for all but o
 *
 * before: SIGKILL before the call. half: a write stores half of its bytes, then SIGKILL; another call
 * is made, then SIGKILL. from: every call from that one on fails. once: that call alone fails.
 * short: from that call on every second write is interrupted (EINTR) and the others store one byte
 * less, or half.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

#define LOG_BYTES 65536

static struct { uint64_t count; char kinds[LOG_BYTES - 8]; } *calls;
static const char *mode = "count";
static const char *counted = "";
static uint64_t at;
static int error_number;

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

__attribute__((constructor)) static void begin(void)
{
    const char *path = getenv("TORTURE_LOG"), *value;
    if (!path)
        return;
    int file = REAL(open64)(path, O_RDWR | O_CREAT, 0600);
    if (file < 0 || REAL(ftruncate64)(file, LOG_BYTES))
        return;
    calls = mmap(NULL, LOG_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    if (calls == MAP_FAILED)
        calls = NULL;
    if ((value = getenv("TORTURE_MODE")))
        mode = value;
    if ((value = getenv("TORTURE_KINDS")))
        counted = value;
    at = (value = getenv("TORTURE_AT")) ? strtoull(value, NULL, 10) : 0;
    error_number = (value = getenv("TORTURE_ERRNO")) ? atoi(value) : EIO;
}

static void end_here(void)
{
    kill(getpid(), SIGKILL);
    for (;;)
        pause();
}

/* What to do with this call. */
enum action { PASS, FAIL, HALF, INTERRUPT, SHORT };

static enum action enter(char kind)
{
    if (!calls || !strchr(*counted ? counted : "cwmrsut", kind))
        return PASS;
    uint64_t number = __atomic_add_fetch(&calls->count, 1, __ATOMIC_SEQ_CST);
    if (number <= sizeof calls->kinds)
        calls->kinds[number - 1] = kind;
    if (number < at || !strcmp(mode, "count"))
        return PASS;
    if (!strcmp(mode, "short"))
        return kind != 'w' ? PASS : number % 2 ? INTERRUPT : SHORT;
    if (number > at && strcmp(mode, "from"))
        return PASS;
    if (!strcmp(mode, "before"))
        end_here();
    if (!strcmp(mode, "half"))
        return HALF;
    errno = error_number;
    return FAIL;
}

/* Makes a call that is not a write. */
#define AROUND(kind, call)          \
    enum action action = enter(kind); \
    if (action == FAIL)             \
        return -1;                  \
    int result = (call);            \
    if (action == HALF)             \
        end_here();                 \
    return result

static int is_file(int file)
{
    struct stat status;
    return file > 2 && !fstat(file, &status) && S_ISREG(status.st_mode);
}

static ssize_t disturbed_write(int file, const void *bytes, size_t size, off64_t place, int placed)
{
    enum action action = is_file(file) ? enter('w') : PASS;
    if (action == FAIL)
        return -1;
    if (action == INTERRUPT) {
        errno = EINTR;
        return -1;
    }
    size_t part = action == HALF ? size / 2 : action == SHORT && size > 1 ? (size % 3 ? size / 2 : size - 1) : size;
    ssize_t written = placed ? REAL(pwrite64)(file, bytes, part, place) : REAL(write)(file, bytes, part);
    if (action == HALF)
        end_here();
    return written;
}

ssize_t write(int file, const void *bytes, size_t size)
{
    return disturbed_write(file, bytes, size, 0, 0);
}

ssize_t pwrite(int file, const void *bytes, size_t size, off_t place)
{
    return disturbed_write(file, bytes, size, place, 1);
}

ssize_t pwrite64(int file, const void *bytes, size_t size, off64_t place)
{
    return disturbed_write(file, bytes, size, place, 1);
}

ssize_t writev(int file, const struct iovec *parts, int number)
{
    if (!is_file(file))
        return REAL(writev)(file, parts, number);
    return number > 0 ? disturbed_write(file, parts[0].iov_base, parts[0].iov_len, 0, 0) : 0;
}

static mode_t mode_of(int flags, va_list list)
{
    return flags & (O_CREAT | __O_TMPFILE) ? va_arg(list, mode_t) : 0;
}

#define OPEN(name)                                        \
    int name(const char *path, int flags, ...)            \
    {                                                     \
        va_list list;                                     \
        va_start(list, flags);                            \
        mode_t rights = mode_of(flags, list);             \
        va_end(list);                                     \
        AROUND(flags & O_CREAT ? 'c' : 'o', REAL(name)(path, flags, rights)); \
    }

#define OPENAT(name)                                              \
    int name(int folder, const char *path, int flags, ...)        \
    {                                                             \
        va_list list;                                             \
        va_start(list, flags);                                    \
        mode_t rights = mode_of(flags, list);                     \
        va_end(list);                                             \
        AROUND(flags & O_CREAT ? 'c' : 'o', REAL(name)(folder, path, flags, rights)); \
    }

OPEN(open)
OPEN(open64)
OPENAT(openat)
OPENAT(openat64)

int mkdir(const char *path, mode_t rights) { AROUND('m', REAL(mkdir)(path, rights)); }
int mkdirat(int folder, const char *path, mode_t rights) { AROUND('m', REAL(mkdirat)(folder, path, rights)); }
int rename(const char *from, const char *to) { AROUND('r', REAL(rename)(from, to)); }
int renameat(int a, const char *from, int b, const char *to) { AROUND('r', REAL(renameat)(a, from, b, to)); }
int renameat2(int a, const char *from, int b, const char *to, unsigned flags)
{
    AROUND('r', REAL(renameat2)(a, from, b, to, flags));
}
int fsync(int file) { AROUND('s', REAL(fsync)(file)); }
int fdatasync(int file) { AROUND('s', REAL(fdatasync)(file)); }
int unlink(const char *path) { AROUND('u', REAL(unlink)(path)); }
int unlinkat(int folder, const char *path, int flags) { AROUND('u', REAL(unlinkat)(folder, path, flags)); }
int rmdir(const char *path) { AROUND('u', REAL(rmdir)(path)); }
int ftruncate(int file, off_t size) { AROUND('t', REAL(ftruncate)(file, size)); }
int ftruncate64(int file, off64_t size) { AROUND('t', REAL(ftruncate64)(file, size)); }

#include "renderer/cache/scene_cache.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "renderer/log.h"

#define FOLDER     "voxcast/scenes"
#define EXTENSION  ".entry"
#define TEMPORARY  ".tmp"
#define NAME_BYTES (32u + sizeof(EXTENSION))
// A temporary file so old is of a process that has died.
#define ABANDONED_S 3600
// Other processes write, too: what is there is counted again after so many bytes of our own.
#define RECOUNT_BYTES (64ull << 20)
// What a file takes is rounded up to that.
#define BLOCK_BYTES 4096u

static const char magic[8] = "voxcast1";

struct entry_header {
    char magic[8];
    struct cache_key key;
    uint64_t size;
    struct cache_key checksum; // of the content
    uint64_t unused[2];        // 0
};

_Static_assert(sizeof(struct entry_header) == SCENE_CACHE_HEADER_BYTES, "as files have it");

static struct {
    pthread_mutex_t mutex; // guards the rest; held neither while reading nor while writing
    int folder;            // -1: off
    uint64_t max_bytes;
    uint64_t present_bytes;   // of all entries, when they were last counted and ours since
    uint64_t uncounted_bytes; // of those, ours since
    bool counted;
    uint32_t next_temporary;
    struct scene_cache_statistics statistics;
} cache = {.mutex = PTHREAD_MUTEX_INITIALIZER, .folder = -1};

static uint64_t rotate(uint64_t word, int bits)
{
    return word << bits | word >> (64 - bits);
}

// Murmur3's finalizer: each bit of the input changes half of the output's.
static uint64_t mix(uint64_t word)
{
    word = (word ^ word >> 33) * 0xff51afd7ed558ccdull;
    word = (word ^ word >> 33) * 0xc4ceb9fe1a85ec53ull;
    return word ^ word >> 33;
}

// One lane's step; for a given lane no two words give the same result.
static uint64_t step(uint64_t lane, uint64_t word)
{
    return rotate(lane ^ word * 0x9fb21c651e98df25ull, 29) * 0xd6e8feb86659fd93ull;
}

void cache_key_add(struct cache_key *key, const void *bytes, size_t size)
{
    const uint8_t *at = bytes;
    uint64_t lanes[4] = {key->words[0], key->words[1], ~key->words[0], ~key->words[1]};
    uint64_t words[4];
    size_t left = size;
    // Four independent lanes keep the multipliers busy.
    for (; left >= sizeof(words); left -= sizeof(words), at += sizeof(words)) {
        memcpy(words, at, sizeof(words));
        for (int i = 0; i < 4; i++)
            lanes[i] = step(lanes[i], words[i]);
    }
    memset(words, 0, sizeof(words));
    if (left > 0)
        memcpy(words, at, left);
    for (int i = 0; i < 4; i++)
        lanes[i] = mix(step(lanes[i], words[i] ^ size));
    key->words[0] = mix(lanes[0] + rotate(lanes[1], 17) + rotate(lanes[2], 31) + lanes[3]);
    key->words[1] = mix(lanes[3] + rotate(lanes[2], 13) + rotate(lanes[1], 43) + ~lanes[0]);
}

struct cache_key cache_key_start(const char *kind, uint32_t version)
{
    struct cache_key key = {{0x243f6a8885a308d3ull, 0x13198a2e03707344ull}};
    cache_key_add(&key, kind, strlen(kind));
    cache_key_add(&key, &version, sizeof(version));
    return key;
}

static struct cache_key checksum_start(const struct cache_key *key)
{
    struct cache_key sum = cache_key_start("checksum", 1);
    cache_key_add(&sum, key, sizeof(*key));
    return sum;
}

static void name_of(const struct cache_key *key, char out_name[NAME_BYTES])
{
    snprintf(out_name, NAME_BYTES, "%016" PRIx64 "%016" PRIx64 EXTENSION, key->words[0],
             key->words[1]);
}

// Makes a folder and those above it. -1 with errno on failure.
static int open_folder(char *path)
{
    for (char *at = strchr(path + 1, '/'); at; at = strchr(at + 1, '/')) {
        *at = '\0';
        int made = mkdir(path, 0700);
        *at = '/';
        if (made != 0 && errno != EEXIST)
            return -1;
    }
    if (mkdir(path, 0700) != 0 && errno != EEXIST)
        return -1;
    return open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

// A relative XDG_CACHE_HOME counts as unset, as its specification says.
static int open_default_folder(char path[PATH_MAX])
{
    const char *given = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    int length = -1;
    if (given && given[0] == '/')
        length = snprintf(path, PATH_MAX, "%s/" FOLDER, given);
    else if (home && home[0] == '/')
        length = snprintf(path, PATH_MAX, "%s/.cache/" FOLDER, home);
    else
        snprintf(path, PATH_MAX, "neither XDG_CACHE_HOME nor HOME");
    if (length < 0 || length >= PATH_MAX) {
        errno = ENOENT;
        return -1;
    }
    return open_folder(path);
}

void scene_cache_open(uint32_t mib)
{
    char path[PATH_MAX];
    int folder = -1;
    if (mib > 0) {
        folder = open_default_folder(path);
        if (folder < 0)
            log_write(LOG_WARN, "scene_cache_off folder=\"%s\" reason=\"%s\"", path,
                      strerror(errno));
    }
    pthread_mutex_lock(&cache.mutex);
    if (cache.folder >= 0)
        close(cache.folder);
    cache.folder = folder;
    cache.max_bytes = (uint64_t)mib << 20;
    cache.counted = false;
    pthread_mutex_unlock(&cache.mutex);
}

// A descriptor of the folder for one call; -1 while the cache is off.
static int borrow_folder(void)
{
    pthread_mutex_lock(&cache.mutex);
    int folder = cache.folder >= 0 ? fcntl(cache.folder, F_DUPFD_CLOEXEC, 0) : -1;
    pthread_mutex_unlock(&cache.mutex);
    return folder;
}

bool scene_cache_is_open(void)
{
    pthread_mutex_lock(&cache.mutex);
    bool open = cache.folder >= 0;
    pthread_mutex_unlock(&cache.mutex);
    return open;
}

static bool read_all(int file, void *bytes, size_t size)
{
    for (uint8_t *at = bytes; size > 0;) {
        ssize_t count = read(file, at, size);
        if (count < 0 && errno == EINTR)
            continue;
        if (count <= 0)
            return false;
        at += count;
        size -= (size_t)count;
    }
    return true;
}

static bool write_all(int file, const void *bytes, size_t size)
{
    for (const uint8_t *at = bytes; size > 0;) {
        ssize_t count = write(file, at, size);
        if (count < 0 && errno == EINTR)
            continue;
        if (count <= 0)
            return false;
        at += count;
        size -= (size_t)count;
    }
    return true;
}

// The content of an open entry; NULL if anything is wrong with it. Sets *out_unread where nothing
// may be wrong, but it is larger than asked for, or memory was short.
static void *read_entry(int file, const struct cache_key *key, size_t max_bytes, size_t *out_size,
                        bool *out_unread)
{
    struct stat status;
    struct entry_header header;
    if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode) ||
        !read_all(file, &header, sizeof(header)) ||
        memcmp(header.magic, magic, sizeof(magic)) != 0 ||
        memcmp(&header.key, key, sizeof(*key)) != 0 || header.unused[0] != 0 ||
        header.unused[1] != 0 || (uint64_t)status.st_size != sizeof(header) + header.size)
        return NULL;
    void *bytes = header.size <= max_bytes ? malloc(header.size ? header.size : 1) : NULL;
    *out_unread = !bytes;
    struct cache_key sum = checksum_start(key);
    if (bytes && read_all(file, bytes, header.size)) {
        cache_key_add(&sum, bytes, header.size);
        if (memcmp(&sum, &header.checksum, sizeof(sum)) == 0) {
            *out_size = header.size;
            return bytes;
        }
    }
    free(bytes);
    return NULL;
}

static void count_read(bool hit, bool invalid)
{
    pthread_mutex_lock(&cache.mutex);
    cache.statistics.hits += hit;
    cache.statistics.misses += !hit;
    cache.statistics.invalid += invalid;
    pthread_mutex_unlock(&cache.mutex);
}

void *scene_cache_read(const struct cache_key *key, size_t max_bytes, size_t *out_size)
{
    int folder = borrow_folder();
    if (folder < 0)
        return NULL;
    char name[NAME_BYTES];
    name_of(key, name);
    void *bytes = NULL;
    bool unread = false;
    // Whatever lies there under the name, opening it must not block.
    int file = openat(folder, name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (file >= 0) {
        bytes = read_entry(file, key, max_bytes, out_size, &unread);
        if (bytes)
            futimens(file, NULL); // its newest use
        close(file);
    }
    bool invalid = !bytes && !unread && (file >= 0 || errno == ELOOP);
    if (invalid)
        unlinkat(folder, name, 0);
    count_read(bytes != NULL, invalid);
    close(folder);
    return bytes;
}

struct found_entry {
    char name[NAME_BYTES];
    struct timespec used;
    uint64_t bytes;
};

static int compare_uses(const void *a, const void *b)
{
    const struct timespec *x = &((const struct found_entry *)a)->used;
    const struct timespec *y = &((const struct found_entry *)b)->used;
    if (x->tv_sec != y->tv_sec)
        return x->tv_sec < y->tv_sec ? -1 : 1;
    return (x->tv_nsec > y->tv_nsec) - (x->tv_nsec < y->tv_nsec);
}

static bool ends_with(const char *text, const char *end)
{
    size_t length = strlen(text), count = strlen(end);
    return length >= count && strcmp(text + length - count, end) == 0;
}

static uint64_t bytes_on_disk(uint64_t size)
{
    return (size + BLOCK_BYTES - 1) / BLOCK_BYTES * BLOCK_BYTES;
}

// What the folder's file of this name is. False if it is no entry. Removes temporary files that
// nobody will rename any more.
static bool inspect_file(int folder, const char *name, struct found_entry *out_entry)
{
    struct stat status;
    bool temporary = ends_with(name, TEMPORARY);
    if ((!temporary && !ends_with(name, EXTENSION)) || strlen(name) >= NAME_BYTES ||
        fstatat(folder, name, &status, AT_SYMLINK_NOFOLLOW) != 0)
        return false;
    if (temporary && time(NULL) - status.st_mtim.tv_sec > ABANDONED_S)
        unlinkat(folder, name, 0);
    *out_entry = (struct found_entry){.used = status.st_mtim,
                                      .bytes = bytes_on_disk((uint64_t)status.st_size)};
    strcpy(out_entry->name, name);
    return !temporary;
}

// The entries, from malloc().
static struct found_entry *list_entries(int folder, size_t *out_count)
{
    // Of its own, since descriptors that are duplicates share a position.
    int listed = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *stream = listed >= 0 ? fdopendir(listed) : NULL;
    if (!stream && listed >= 0)
        close(listed);
    struct found_entry *entries = NULL;
    size_t count = 0, capacity = 0;
    for (struct dirent *it; stream && (it = readdir(stream));) {
        struct found_entry found;
        if (!inspect_file(folder, it->d_name, &found))
            continue;
        if (count == capacity) {
            capacity = capacity ? 2 * capacity : 256;
            struct found_entry *larger = realloc(entries, capacity * sizeof(*larger));
            if (!larger)
                break;
            entries = larger;
        }
        entries[count++] = found;
    }
    if (stream)
        closedir(stream);
    *out_count = count;
    return entries;
}

// Removes the entries that were used least recently until `max_bytes` are enough. Returns what is
// left.
static uint64_t evict(int folder, uint64_t max_bytes)
{
    size_t count;
    struct found_entry *entries = list_entries(folder, &count);
    uint64_t bytes = 0;
    for (size_t i = 0; i < count; i++)
        bytes += entries[i].bytes;
    if (count > 0)
        qsort(entries, count, sizeof(*entries), compare_uses);
    for (size_t i = 0; i < count && bytes > max_bytes; i++)
        if (unlinkat(folder, entries[i].name, 0) == 0 || errno == ENOENT)
            bytes -= entries[i].bytes;
    free(entries);
    return bytes;
}

// Writes an entry's file. False if it could not be.
static bool write_entry(int folder, const char *name, const struct cache_key *key,
                        const void *bytes, size_t size)
{
    struct entry_header header = {.key = *key, .size = size, .checksum = checksum_start(key)};
    memcpy(header.magic, magic, sizeof(magic));
    cache_key_add(&header.checksum, bytes, size);
    int file = openat(folder, name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    bool done =
        file >= 0 && write_all(file, &header, sizeof(header)) && write_all(file, bytes, size);
    if (file >= 0)
        done = close(file) == 0 && done;
    return done;
}

// Keeps count of what has been written; evicts when it is too much or long not counted.
static void count_written(int folder, size_t size)
{
    uint64_t bytes = bytes_on_disk(SCENE_CACHE_HEADER_BYTES + size);
    pthread_mutex_lock(&cache.mutex);
    cache.statistics.written_bytes += size;
    cache.present_bytes += bytes;
    cache.uncounted_bytes += bytes;
    uint64_t max_bytes = cache.max_bytes;
    bool recount =
        !cache.counted || cache.present_bytes > max_bytes || cache.uncounted_bytes >= RECOUNT_BYTES;
    pthread_mutex_unlock(&cache.mutex);
    if (!recount)
        return;
    uint64_t present = evict(folder, max_bytes);
    pthread_mutex_lock(&cache.mutex);
    cache.counted = true;
    cache.present_bytes = present;
    cache.uncounted_bytes = 0;
    pthread_mutex_unlock(&cache.mutex);
}

void scene_cache_write(const struct cache_key *key, const void *bytes, size_t size)
{
    int folder = borrow_folder();
    if (folder < 0)
        return;
    pthread_mutex_lock(&cache.mutex);
    bool fits = bytes_on_disk(SCENE_CACHE_HEADER_BYTES + size) <= cache.max_bytes;
    uint32_t number = cache.next_temporary++;
    pthread_mutex_unlock(&cache.mutex);
    char name[NAME_BYTES], temporary[NAME_BYTES];
    name_of(key, name);
    snprintf(temporary, sizeof(temporary), "%ld-%u" TEMPORARY, (long)getpid(), number);
    if (fits && write_entry(folder, temporary, key, bytes, size) &&
        renameat(folder, temporary, folder, name) == 0)
        count_written(folder, size);
    else if (fits)
        unlinkat(folder, temporary, 0);
    close(folder);
}

struct scene_cache_statistics scene_cache_get_statistics(void)
{
    pthread_mutex_lock(&cache.mutex);
    struct scene_cache_statistics statistics = cache.statistics;
    pthread_mutex_unlock(&cache.mutex);
    return statistics;
}

#include "renderer/image/file_access.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool has_scheme(const char *reference)
{
    if (!isalpha((unsigned char)reference[0])) {
        return false;
    }
    const char *at = reference;
    while (isalnum((unsigned char)*at) || *at == '+' || *at == '-' || *at == '.') {
        at++;
    }
    return *at == ':';
}

static bool check_reference(const char *reference, struct error *out_error)
{
    if (reference[0] == '\0' || strlen(reference) >= PATH_MAX) {
        return error_set(out_error, "the file name is empty or longer than %d bytes", PATH_MAX - 1);
    }
    if (reference[0] == '/' || has_scheme(reference)) {
        return error_set(out_error,
                         "'%.200s' is an absolute path or has a scheme; only files in the scene's "
                         "folder are read",
                         reference);
    }
    for (const char *at = reference; *at; at++) {
        if (*at == '\\' || (unsigned char)*at < 0x20) {
            return error_set(out_error, "a file name has a backslash or a control character");
        }
    }
    return true;
}

char *asset_path_resolve(const char *folder, const char *reference, struct error *out_error)
{
    if (!check_reference(reference, out_error)) {
        return NULL;
    }
    size_t folder_length = strlen(folder);
    size_t size = folder_length + strlen(reference) + 2;
    char *joined = malloc(size);
    if (!joined) {
        error_set(out_error, "out of memory");
        return NULL;
    }
    memcpy(joined, folder, folder_length);
    joined[folder_length] = '/';
    memcpy(joined + folder_length + 1, reference, size - folder_length - 1);
    char *canonical = realpath(joined, NULL);
    free(joined);
    if (!canonical) {
        error_set(out_error, "'%.200s': %s", reference, strerror(errno));
        return NULL;
    }
    bool at_root = folder_length == 1 && folder[0] == '/';
    bool below = at_root || (strncmp(canonical, folder, folder_length) == 0 &&
                             canonical[folder_length] == '/');
    if (!below) {
        error_set(out_error, "'%.200s' leads out of the scene's folder", reference);
        free(canonical);
        return NULL;
    }
    return canonical;
}

static int hex_digit(char digit)
{
    if (digit >= '0' && digit <= '9') {
        return digit - '0';
    }
    digit = (char)tolower((unsigned char)digit);
    return digit >= 'a' && digit <= 'f' ? digit - 'a' + 10 : -1;
}

bool asset_path_decode_percent(char *uri)
{
    char *to = uri;
    for (const char *from = uri; *from; from++, to++) {
        if (*from != '%') {
            *to = *from;
            continue;
        }
        int high = hex_digit(from[1]);
        int low = high < 0 ? -1 : hex_digit(from[2]);
        if (low < 0 || (high == 0 && low == 0)) {
            return false;
        }
        *to = (char)(high * 16 + low);
        from += 2;
    }
    *to = '\0';
    return true;
}

char *asset_path_folder(const char *path)
{
    const char *slash = strrchr(path, '/');
    if (!slash) {
        return strdup(".");
    }
    return slash == path ? strdup("/") : strndup(path, (size_t)(slash - path));
}

static struct asset_stamp stamp_of(const struct stat *status)
{
    return (struct asset_stamp){
        .size_bytes = (uint64_t)status->st_size,
        .modified_ns = (int64_t)status->st_mtim.tv_sec * 1000000000 + status->st_mtim.tv_nsec,
    };
}

static bool read_all(int file, uint8_t *bytes, size_t size)
{
    for (size_t done = 0; done < size;) {
        ssize_t got = read(file, bytes + done, size - done);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got <= 0) {
            return false;
        }
        done += (size_t)got;
    }
    return true;
}

bool asset_read_file(const char *path, uint64_t max_bytes, uint8_t **out_bytes, size_t *out_size,
                     struct asset_stamp *out_stamp, struct error *out_error)
{
    // Non-blocking, so that opening a pipe cannot block before the check below.
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) {
        return error_set(out_error, "cannot open '%.200s': %s", path, strerror(errno));
    }
    struct stat status;
    uint8_t *bytes = NULL;
    if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) {
        error_set(out_error, "'%.200s' is not a regular file", path);
        goto fail;
    }
    if ((uint64_t)status.st_size > max_bytes) {
        error_set(out_error, "'%.200s' has %llu bytes; the limit is %llu", path,
                  (unsigned long long)status.st_size, (unsigned long long)max_bytes);
        goto fail;
    }
    bytes = malloc((size_t)status.st_size + 1);
    if (!bytes) {
        error_set(out_error, "out of memory for the %llu bytes of '%.200s'",
                  (unsigned long long)status.st_size, path);
        goto fail;
    }
    if (!read_all(file, bytes, (size_t)status.st_size)) {
        error_set(out_error, "cannot read '%.200s'", path);
        goto fail;
    }
    close(file);
    bytes[status.st_size] = 0;
    *out_bytes = bytes;
    *out_size = (size_t)status.st_size;
    if (out_stamp) {
        *out_stamp = stamp_of(&status);
    }
    return true;

fail:
    free(bytes);
    close(file);
    return false;
}

bool asset_read_stamp(const char *path, struct asset_stamp *out_stamp)
{
    struct stat status;
    if (stat(path, &status) != 0 || !S_ISREG(status.st_mode)) {
        return false;
    }
    *out_stamp = stamp_of(&status);
    return true;
}

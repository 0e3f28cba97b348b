#include "renderer/metrics/picture.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HEADER_WORD_SIZE 32

bool picture_init(struct picture *picture, uint32_t width, uint32_t height)
{
    *picture = (struct picture){.width = width, .height = height};
    picture->rgb = calloc((size_t)width * height * 3, sizeof(float));
    return picture->rgb != NULL;
}

void picture_finish(struct picture *picture)
{
    free(picture->rgb);
    *picture = (struct picture){0};
}

// Reads a word of the header and the one white-space character after it.
static bool read_word(FILE *file, char out_word[HEADER_WORD_SIZE])
{
    size_t length = 0;
    int c = fgetc(file);
    while (c != EOF && isspace(c))
        c = fgetc(file);
    for (; c != EOF && !isspace(c); c = fgetc(file)) {
        if (length + 1 == HEADER_WORD_SIZE)
            return false;
        out_word[length++] = (char)c;
    }
    out_word[length] = '\0';
    return length > 0 && c != EOF;
}

static bool read_edge(FILE *file, uint32_t *out_edge)
{
    char word[HEADER_WORD_SIZE], *end;
    if (!read_word(file, word) || !isdigit((unsigned char)word[0]))
        return false;
    unsigned long edge = strtoul(word, &end, 10);
    *out_edge = (uint32_t)edge;
    return *end == '\0' && edge > 0 && edge <= PICTURE_MAX_EDGE;
}

static void swap_bytes(float *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof(bits));
        bits = __builtin_bswap32(bits);
        memcpy(&values[i], &bits, sizeof(bits));
    }
}

static bool read_file(FILE *file, const char *path, struct picture *picture,
                      struct error *out_error)
{
    char word[HEADER_WORD_SIZE], *end = word;
    uint32_t width, height;
    if (!read_word(file, word) || strcmp(word, "PF") != 0)
        return error_set(out_error, "\"%s\" is no RGB .pfm: it does not begin with \"PF\"", path);
    if (!read_edge(file, &width) || !read_edge(file, &height))
        return error_set(out_error, "\"%s\" has a bad size; allowed: edges of 1 to %u", path,
                         PICTURE_MAX_EDGE);
    float scale = read_word(file, word) ? strtof(word, &end) : 0.0f;
    if (scale == 0.0f || !isfinite(scale) || *end != '\0')
        return error_set(out_error, "\"%s\" has no scale, such as -1.0, behind its size", path);
    if (!picture_init(picture, width, height))
        return error_set(out_error, "out of memory for \"%s\" of %ux%u", path, width, height);
    for (uint32_t y = height; y-- > 0;) {
        float *row = picture->rgb + (size_t)y * width * 3;
        if (fread(row, 3 * sizeof(float), width, file) != width)
            return error_set(out_error, "\"%s\" of %ux%u ends in row %u of %u", path, width, height,
                             height - y, height);
        if (scale > 0.0f)
            swap_bytes(row, (size_t)width * 3);
    }
    return true;
}

bool picture_read_pfm(const char *path, struct picture *out_picture, struct error *out_error)
{
    struct picture picture = {0};
    FILE *file = fopen(path, "rb");
    if (!file)
        return error_set(out_error, "cannot read \"%s\": %s", path, strerror(errno));
    bool done = read_file(file, path, &picture, out_error);
    fclose(file);
    if (done)
        *out_picture = picture;
    else
        picture_finish(&picture);
    return done;
}

bool picture_write_pfm(const char *path, const struct picture *picture, struct error *out_error)
{
    FILE *file = fopen(path, "wb");
    if (!file)
        return error_set(out_error, "cannot write \"%s\": %s", path, strerror(errno));
    bool done = fprintf(file, "PF\n%u %u\n-1.0\n", picture->width, picture->height) > 0;
    for (uint32_t y = picture->height; y-- > 0 && done;)
        done = fwrite(picture->rgb + (size_t)y * picture->width * 3, 3 * sizeof(float),
                      picture->width, file) == picture->width;
    done = fclose(file) == 0 && done;
    if (done)
        return true;
    remove(path);
    return error_set(out_error, "cannot write all of \"%s\" (disk full?)", path);
}

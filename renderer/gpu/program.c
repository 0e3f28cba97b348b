#include "renderer/gpu/program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <unistd.h>

#include "renderer/gpu/internal.h"
#include "renderer/gpu/shader_source.h"
#include "renderer/hash.h"
#include "renderer/log.h"

// Beyond, the one that has not been asked for longest makes room. A frame uses about 40.
#define MAX_PROGRAMS        512
#define MAX_DEFINES         512
#define MAX_WATCHED_FOLDERS 32
#define LOG_BYTES           8192

struct gpu_program {
    GLuint name;
    char path[SHADER_MAX_PATH];
    char defines[MAX_DEFINES];
    uint64_t source_hash; // of all stages
    bool stale;
    uint64_t used; // the library's clock when it was last asked for
    struct gpu_program_bindings bindings;
    bool seen; // gpu_program_take_new() has been asked since it was built
    uint32_t file_count;
    char (*files)[SHADER_MAX_PATH];
};

struct gpu_program_library {
    uint32_t count;
    struct gpu_program *programs[MAX_PROGRAMS]; // the first `count` are valid
    uint64_t clock;
    int watch_fd;
    uint32_t folder_count;
    struct {
        int descriptor;
        char path[64]; // relative to the shader folder, "" or "gi/"
    } folders[MAX_WATCHED_FOLDERS];
};

static struct gpu_program_library *library_get(struct gpu *gpu)
{
    if (!gpu->programs) {
        gpu->programs = calloc(1, sizeof(*gpu->programs));
        if (gpu->programs)
            gpu->programs->watch_fd = -1;
    }
    return gpu->programs;
}

static GLuint compile_stage(GLenum stage, const struct shader_source *source, const char *path,
                            struct error *out_error)
{
    GLuint shader = glCreateShader(stage);
    const char *text = source->text;
    glShaderSource(shader, 1, &text, NULL);
    glCompileShader(shader);
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled)
        return shader;
    char log[LOG_BYTES] = "", mapped[LOG_BYTES];
    glGetShaderInfoLog(shader, sizeof(log), NULL, log);
    shader_source_map_log(source, log, mapped, sizeof(mapped));
    error_set(out_error, "shader \"%s\" does not compile: %.400s", path, mapped);
    glDeleteShader(shader);
    return 0;
}

// Records a program's source files, for hot reload.
static void record_files(struct gpu_program *program, const struct shader_source *source)
{
    size_t total = program->file_count + source->file_count;
    char(*grown)[SHADER_MAX_PATH] = realloc(program->files, total * SHADER_MAX_PATH);
    if (!grown)
        return;
    program->files = grown;
    memcpy(grown + program->file_count, source->files, source->file_count * SHADER_MAX_PATH);
    program->file_count = (uint32_t)total;
}

bool gpu_program_read_stage(const struct gpu *gpu, const char *path, const char *defines,
                            struct shader_source *source, struct error *out_error)
{
    const char *const texts[] = {gpu->shader_defines ? gpu->shader_defines : "", defines};
    return shader_source_read(source, gpu->shader_dir, path, texts, 2, out_error);
}

static GLuint build_stage(struct gpu *gpu, struct gpu_program *program, GLenum stage,
                          const char *extension, struct error *out_error)
{
    char path[SHADER_MAX_PATH + 8];
    snprintf(path, sizeof(path), "%s%s", program->path, extension);
    struct shader_source source;
    bool read = gpu_program_read_stage(gpu, path, program->defines, &source, out_error);
    record_files(program, &source);
    if (!read)
        return 0;
    GLuint shader = compile_stage(stage, &source, path, out_error);
    program->source_hash = hash_bytes(program->source_hash, source.text, strlen(source.text));
    shader_source_finish(&source);
    return shader;
}

// Samplers and images name their units in the shader.
static void find_units(GLuint name, struct gpu_program_bindings *bindings)
{
    GLint count = 0;
    glGetProgramInterfaceiv(name, GL_UNIFORM, GL_ACTIVE_RESOURCES, &count);
    for (GLint i = 0; i < count; i++) {
        static const GLenum properties[] = {GL_TYPE, GL_LOCATION, GL_ARRAY_SIZE};
        GLint values[3] = {0, -1, 0};
        glGetProgramResourceiv(name, GL_UNIFORM, (GLuint)i, 3, properties, 3, NULL, values);
        bool image =
            values[0] >= GL_IMAGE_1D && values[0] <= GL_UNSIGNED_INT_IMAGE_2D_MULTISAMPLE_ARRAY;
        for (GLint j = 0; values[1] >= 0 && j < values[2]; j++) {
            GLint unit = -1;
            glGetUniformiv(name, values[1] + j, &unit);
            if (image && unit >= 0 && unit < 32)
                bindings->images |= 1u << unit;
            else if (!image && unit >= 0 && unit < 64)
                bindings->units |= (uint64_t)1 << unit;
        }
    }
}

static void find_bindings(GLuint name, struct gpu_program_bindings *bindings)
{
    GLint count = 0;
    *bindings = (struct gpu_program_bindings){0};
    glGetProgramInterfaceiv(name, GL_SHADER_STORAGE_BLOCK, GL_ACTIVE_RESOURCES, &count);
    for (GLint i = 0; i < count; i++) {
        static const GLenum property = GL_BUFFER_BINDING;
        GLint binding = -1;
        glGetProgramResourceiv(name, GL_SHADER_STORAGE_BLOCK, (GLuint)i, 1, &property, 1, NULL,
                               &binding);
        if (binding >= 0 && binding < 32)
            bindings->storage |= 1u << binding;
    }
    find_units(name, bindings);
}

const struct gpu_program_bindings *gpu_program_get_bindings(const struct gpu_program *program)
{
    return &program->bindings;
}

bool gpu_program_take_new(const struct gpu_program *program)
{
    struct gpu_program *own = (struct gpu_program *)program; // all of them are this module's
    bool seen = own->seen;
    own->seen = true;
    return !seen;
}

bool gpu_set_shader_defines(struct gpu *gpu, const char *defines)
{
    free(gpu->shader_defines);
    gpu->shader_defines = strdup(defines);
    return gpu->shader_defines != NULL;
}

// Builds a GL program object; 0 on failure, and then the hash of the source stays that of the last
// one. Replaces the program's list of files in either case.
static GLuint build(struct gpu *gpu, struct gpu_program *program, struct error *out_error)
{
    program->file_count = 0;
    gpu->programs_built++;
    if (gpu_fault_strikes(gpu, RENDERER_FAULT_PROGRAM)) {
        error_set(out_error, "shader \"%s\" does not compile: it was told not to", program->path);
        return 0;
    }
    size_t length = strlen(program->path);
    bool compute = length > 5 && strcmp(program->path + length - 5, ".comp") == 0;
    GLuint shaders[2] = {0, 0};
    uint32_t count = compute ? 1 : 2;
    uint64_t last_hash = program->source_hash;
    program->source_hash = HASH_START;
    if (compute) {
        shaders[0] = build_stage(gpu, program, GL_COMPUTE_SHADER, "", out_error);
    } else {
        shaders[0] = build_stage(gpu, program, GL_VERTEX_SHADER, ".vert", out_error);
        if (shaders[0])
            shaders[1] = build_stage(gpu, program, GL_FRAGMENT_SHADER, ".frag", out_error);
    }
    GLuint name = 0;
    if (shaders[count - 1]) {
        name = glCreateProgram();
        for (uint32_t i = 0; i < count; i++)
            glAttachShader(name, shaders[i]);
        glLinkProgram(name);
        GLint linked = GL_FALSE;
        glGetProgramiv(name, GL_LINK_STATUS, &linked);
        if (!linked) {
            char log[LOG_BYTES] = "";
            glGetProgramInfoLog(name, sizeof(log), NULL, log);
            error_set(out_error, "shader \"%s\" does not link: %.400s", program->path, log);
            glDeleteProgram(name);
            name = 0;
        } else {
            glObjectLabel(GL_PROGRAM, name, -1, program->path);
            find_bindings(name, &program->bindings);
            program->seen = false;
        }
    }
    for (uint32_t i = 0; i < count; i++)
        if (shaders[i])
            glDeleteShader(shaders[i]);
    if (!name)
        program->source_hash = last_hash;
    return name;
}

static void destroy(struct gpu *gpu, struct gpu_program *program)
{
    if (program->name) {
        glDeleteProgram(program->name);
        gpu->current_program = 0;
    }
    free(program->files);
    free(program);
}

// The index for one more program.
static uint32_t make_room(struct gpu *gpu, struct gpu_program_library *library)
{
    if (library->count < MAX_PROGRAMS)
        return library->count++;
    uint32_t oldest = 0;
    for (uint32_t i = 1; i < library->count; i++)
        if (library->programs[i]->used < library->programs[oldest]->used)
            oldest = i;
    destroy(gpu, library->programs[oldest]);
    return oldest;
}

const struct gpu_program *gpu_program_get(struct gpu *gpu, const char *path, const char *defines,
                                          struct error *out_error)
{
    struct gpu_program_library *library = library_get(gpu);
    if (!library) {
        error_set(out_error, "out of memory");
        return NULL;
    }
    library->clock++;
    for (uint32_t i = 0; i < library->count; i++) {
        struct gpu_program *known = library->programs[i];
        if (strcmp(known->path, path) == 0 && strcmp(known->defines, defines) == 0) {
            known->used = library->clock;
            return known;
        }
    }
    if (strlen(defines) >= MAX_DEFINES) {
        error_set(out_error, "shader \"%s\": its defines take more than %d bytes", path,
                  MAX_DEFINES);
        return NULL;
    }
    struct gpu_program *program = calloc(1, sizeof(*program));
    if (!program) {
        error_set(out_error, "out of memory");
        return NULL;
    }
    snprintf(program->path, sizeof(program->path), "%s", path);
    snprintf(program->defines, sizeof(program->defines), "%s", defines);
    program->used = library->clock;
    program->name = build(gpu, program, out_error);
    if (!program->name) {
        destroy(gpu, program);
        return NULL;
    }
    library->programs[make_room(gpu, library)] = program;
    return program;
}

static void watch_folder(struct gpu *gpu, const char *relative)
{
    struct gpu_program_library *library = gpu->programs;
    if (library->folder_count == MAX_WATCHED_FOLDERS)
        return;
    char full[1200];
    snprintf(full, sizeof(full), "%s/%s", gpu->shader_dir, relative);
    int descriptor =
        inotify_add_watch(library->watch_fd, full, IN_CLOSE_WRITE | IN_MOVED_TO | IN_DELETE);
    if (descriptor < 0)
        return;
    library->folders[library->folder_count].descriptor = descriptor;
    snprintf(library->folders[library->folder_count].path, sizeof(library->folders[0].path), "%s",
             relative);
    library->folder_count++;
}

void gpu_programs_watch(struct gpu *gpu)
{
    static const char *const folders[] = {"",    "shared/", "lib/",  "visibility/", "voxel/",
                                          "gi/", "light/",  "post/", "debug/"};
    struct gpu_program_library *library = library_get(gpu);
    if (!library || library->watch_fd >= 0)
        return;
    library->watch_fd = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    if (library->watch_fd < 0)
        return;
    for (size_t i = 0; i < sizeof(folders) / sizeof(folders[0]); i++)
        watch_folder(gpu, folders[i]);
}

static void mark_stale(struct gpu_program_library *library, const struct inotify_event *event)
{
    const char *folder = "";
    for (uint32_t i = 0; i < library->folder_count; i++)
        if (library->folders[i].descriptor == event->wd)
            folder = library->folders[i].path;
    char path[SHADER_MAX_PATH];
    snprintf(path, sizeof(path), "%s%s", folder, event->len ? event->name : "");
    for (uint32_t i = 0; i < library->count; i++)
        for (uint32_t j = 0; j < library->programs[i]->file_count; j++)
            if (strcmp(library->programs[i]->files[j], path) == 0)
                library->programs[i]->stale = true;
}

uint32_t gpu_programs_reload_changed(struct gpu *gpu, struct error *out_error)
{
    struct gpu_program_library *library = gpu->programs;
    if (!library || library->watch_fd < 0)
        return 0;
    _Alignas(struct inotify_event) char bytes[4096];
    for (ssize_t size; (size = read(library->watch_fd, bytes, sizeof(bytes))) > 0;) {
        for (ssize_t at = 0; at < size;) {
            const struct inotify_event *event = (const struct inotify_event *)(bytes + at);
            mark_stale(library, event);
            at += (ssize_t)sizeof(*event) + event->len;
        }
    }
    uint32_t rebuilt = 0;
    for (uint32_t i = 0; i < library->count; i++) {
        struct gpu_program *program = library->programs[i];
        if (!program->stale)
            continue;
        program->stale = false;
        struct error error = {""};
        GLuint name = build(gpu, program, &error);
        if (!name) {
            log_write(LOG_ERROR, "shader_reload_failed message=\"%s\"", error.message);
            if (out_error)
                *out_error = error;
            continue;
        }
        glDeleteProgram(program->name);
        program->name = name;
        gpu->current_program = 0;
        rebuilt++;
    }
    return rebuilt;
}

bool gpu_program_find_member(const struct gpu_program *program, const char *name,
                             uint32_t *out_offset)
{
    static const GLenum interfaces[] = {GL_UNIFORM, GL_BUFFER_VARIABLE}, property = GL_OFFSET;
    for (size_t i = 0; i < sizeof(interfaces) / sizeof(interfaces[0]); i++) {
        GLuint index = glGetProgramResourceIndex(program->name, interfaces[i], name);
        GLint offset = -1;
        if (index == GL_INVALID_INDEX)
            continue;
        glGetProgramResourceiv(program->name, interfaces[i], index, 1, &property, 1, NULL, &offset);
        *out_offset = (uint32_t)offset;
        return offset >= 0;
    }
    return false;
}

uint64_t gpu_programs_built(const struct gpu *gpu)
{
    return gpu->programs_built;
}

uint64_t gpu_program_source_hash(const struct gpu_program *program)
{
    return program->source_hash;
}

uint32_t gpu_program_name(const struct gpu_program *program)
{
    return program->name;
}

void gpu_programs_destroy(struct gpu *gpu)
{
    struct gpu_program_library *library = gpu->programs;
    gpu->programs = NULL;
    if (!library)
        return;
    for (uint32_t i = 0; i < library->count; i++)
        destroy(gpu, library->programs[i]);
    if (library->watch_fd >= 0)
        close(library->watch_fd);
    free(library);
}

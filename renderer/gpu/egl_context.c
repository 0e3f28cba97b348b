// Opens a headless EGL context: a device-platform display (NVIDIA, Mesa) or a surfaceless one.
//
// A device has one display per process, and eglTerminate() ends it for all users. So users are
// counted, and the last renderer on a display terminates it.
#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/auxv.h>
#include <unistd.h>

#include "renderer/gpu/internal.h"

#define MAX_EGL_DEVICES 16

static const char *const install_hint =
    "install libegl1 and a GL driver (Debian: apt install libegl1 libgl1-mesa-dri)";

static pthread_mutex_t display_mutex = PTHREAD_MUTEX_INITIALIZER;
static struct {
    EGLDisplay display;
    uint32_t users;
} displays[MAX_EGL_DEVICES + 1];

// Initialises a display for one more user. False on failure.
static bool display_retain(EGLDisplay display)
{
    bool done = false;
    pthread_mutex_lock(&display_mutex);
    size_t slot = 0, count = sizeof(displays) / sizeof(displays[0]);
    for (size_t i = count; i-- > 0;)
        if (displays[i].users == 0)
            slot = i;
    for (size_t i = 0; i < count; i++)
        if (displays[i].users > 0 && displays[i].display == display)
            slot = i;
    EGLint major, minor;
    if (displays[slot].users > 0)
        done = displays[slot].display == display;
    else
        done = eglInitialize(display, &major, &minor);
    if (done) {
        displays[slot].display = display;
        displays[slot].users++;
    }
    pthread_mutex_unlock(&display_mutex);
    return done;
}

static void display_release(EGLDisplay display)
{
    pthread_mutex_lock(&display_mutex);
    for (size_t i = 0; i < sizeof(displays) / sizeof(displays[0]); i++)
        if (displays[i].users > 0 && displays[i].display == display && --displays[i].users == 0)
            eglTerminate(display);
    pthread_mutex_unlock(&display_mutex);
}

static bool display_open_context(struct gpu *gpu, EGLDisplay display)
{
    if (display == EGL_NO_DISPLAY || !display_retain(display))
        return false;
    static const EGLint config_attributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                               EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_NONE};
    // Where supported, the driver reports a lost context instead of ending the process.
    bool robust = epoxy_has_egl_extension(display, "EGL_EXT_create_context_robustness");
    const EGLint context_attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION,
        4,
        EGL_CONTEXT_MINOR_VERSION,
        5,
        EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
        EGL_CONTEXT_OPENGL_DEBUG,
        EGL_TRUE,
        robust ? EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY : EGL_NONE,
        EGL_LOSE_CONTEXT_ON_RESET,
        EGL_NONE,
    };
    EGLConfig config = EGL_NO_CONFIG_KHR;
    EGLint config_count = 0;
    if (!epoxy_has_egl_extension(display, "EGL_KHR_no_config_context") &&
        (!eglChooseConfig(display, config_attributes, &config, 1, &config_count) ||
         config_count == 0))
        goto fail;
    if (!eglBindAPI(EGL_OPENGL_API))
        goto fail;
    gpu->context = eglCreateContext(display, config, EGL_NO_CONTEXT, context_attributes);
    if (gpu->context == EGL_NO_CONTEXT)
        goto fail;
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, gpu->context)) {
        eglDestroyContext(display, gpu->context);
        gpu->context = EGL_NO_CONTEXT;
        goto fail;
    }
    gpu->display = display;
    return true;
fail:
    display_release(display);
    return false;
}

static bool device_is_software(EGLDeviceEXT device)
{
    const char *extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
    return extensions && strstr(extensions, "EGL_MESA_device_software");
}

static bool open_device(struct gpu *gpu, EGLDeviceEXT device, int index)
{
    EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, NULL);
    if (!display_open_context(gpu, display))
        return false;
    const char *path = NULL;
    const char *extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
    if (extensions && strstr(extensions, "EGL_EXT_device_drm"))
        path = eglQueryDeviceStringEXT(device, EGL_DRM_DEVICE_FILE_EXT);
    snprintf(gpu->info.egl_device, sizeof(gpu->info.egl_device), "device %d%s%s", index,
             path ? " " : "", path ? path : "");
    return true;
}

static bool open_surfaceless(struct gpu *gpu, const char *client_extensions)
{
    if (!client_extensions || !strstr(client_extensions, "EGL_MESA_platform_surfaceless"))
        return false;
    EGLDisplay display =
        eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    if (!display_open_context(gpu, display))
        return false;
    snprintf(gpu->info.egl_device, sizeof(gpu->info.egl_device), "surfaceless");
    return true;
}

// Tries devices in the order of preference for "auto" (hardware first), or those of the wanted
// kind.
static bool open_by_kind(struct gpu *gpu, const EGLDeviceEXT *devices, int count, bool hardware,
                         bool software)
{
    for (int i = 0; hardware && i < count; i++)
        if (!device_is_software(devices[i]) && open_device(gpu, devices[i], i))
            return true;
    for (int i = 0; software && i < count; i++)
        if (device_is_software(devices[i]) && open_device(gpu, devices[i], i))
            return true;
    return false;
}

// Processors that this process may use.
static int count_processors(void)
{
    cpu_set_t set;
    int count = sched_getaffinity(0, sizeof(set), &set) == 0 ? CPU_COUNT(&set) : 1;
    FILE *limit = fopen("/sys/fs/cgroup/cpu.max", "r");
    long quota_us, period_us;
    if (limit && fscanf(limit, "%ld %ld", &quota_us, &period_us) == 2 && quota_us > 0 &&
        period_us > 0 && quota_us / period_us < count)
        count = (int)((quota_us + period_us - 1) / period_us);
    if (limit)
        fclose(limit);
    return count;
}

// Whether the kernel gives huge pages to who asks for them, and only then.
static bool huge_pages_on_demand(void)
{
    char text[64] = "";
    FILE *file = fopen("/sys/kernel/mm/transparent_hugepage/enabled", "r");
    if (!file)
        return false;
    bool read = fgets(text, sizeof(text), file) != NULL;
    fclose(file);
    return read && strstr(text, "[madvise]");
}

// Whether this program can start itself anew with a further variable in its environment.
static bool can_start_anew(void)
{
#ifdef VOXCAST_SANITIZED
    return false; // and has a malloc() of its own
#else
    // A privileged program's loader drops the variable, so that it would start again and again.
    // Where the loader was called as a program, it is what would be started.
    return !getauxval(AT_SECURE) && getauxval(AT_BASE) != 0;
#endif
}

// Has malloc() ask for huge pages, which it reads from the environment when the program starts: so
// the program starts once more. A CPU driver keeps its textures there, and writes all of each when
// it is made: 0.1 s of the 1.1 s that the Cornell box takes to its first frame, and a fifth of
// Sponza's.
static void use_huge_pages(char *const arguments[])
{
    char path[1024], tunables[1024];
    const char *given = getenv("GLIBC_TUNABLES");
    if ((given && strstr(given, "glibc.malloc.hugetlb")) || !huge_pages_on_demand() ||
        !can_start_anew())
        return;
    ssize_t length = readlink("/proc/self/exe", path, sizeof(path));
    int used = snprintf(tunables, sizeof(tunables), "%s%sglibc.malloc.hugetlb=1",
                        given ? given : "", given && *given ? ":" : "");
    if (length <= 0 || length >= (ssize_t)sizeof(path) || used >= (int)sizeof(tunables))
        return;
    path[length] = '\0';
    if (setenv("GLIBC_TUNABLES", tunables, 1) == 0)
        execv(path, arguments); // returns only where it fails, which costs speed alone
}

// llvmpipe splits a dispatch into one run of groups a thread, once, however dear its groups are.
// With two threads a processor the dearest run is half as long. It has 32 threads at most, and
// reads the variable when its display is opened.
void gpu_prepare_process(char *const arguments[])
{
    use_huge_pages(arguments);
    int count = count_processors();
    char text[16];
    snprintf(text, sizeof(text), "%d", count < 16 ? 2 * count : 32);
    if (count > 1)
        setenv("LP_NUM_THREADS", text, 0);
}

bool gpu_egl_open(struct gpu *gpu, const char *choice, struct error *out_error)
{
    gpu->display = EGL_NO_DISPLAY;
    gpu->context = EGL_NO_CONTEXT;
    const char *client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    EGLDeviceEXT devices[MAX_EGL_DEVICES];
    EGLint count = 0;
    if (client && strstr(client, "EGL_EXT_platform_device") &&
        (strstr(client, "EGL_EXT_device_enumeration") || strstr(client, "EGL_EXT_device_base")))
        eglQueryDevicesEXT(MAX_EGL_DEVICES, devices, &count);

    if (!choice || strcmp(choice, "auto") == 0) {
        if (open_by_kind(gpu, devices, count, true, true) || open_surfaceless(gpu, client))
            return true;
        return error_set(out_error,
                         "no EGL device or surfaceless display gives an OpenGL 4.5 core context "
                         "(%d EGL devices found); %s",
                         count, install_hint);
    }
    if (strcmp(choice, "software") == 0) {
        if (open_by_kind(gpu, devices, count, false, true))
            return true;
        setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
        if (open_surfaceless(gpu, client))
            return true;
        return error_set(out_error, "no software OpenGL 4.5 renderer was found; %s", install_hint);
    }
    char *end;
    long index = strtol(choice, &end, 10);
    if (*choice == '\0' || *end != '\0' || index < 0 || index >= count)
        return error_set(out_error, "gpu is \"%s\"; allowed: auto, software, or 0 to %d", choice,
                         count - 1);
    if (open_device(gpu, devices[index], (int)index))
        return true;
    return error_set(out_error, "EGL device %ld gives no OpenGL 4.5 core context; %s", index,
                     install_hint);
}

void gpu_egl_close(struct gpu *gpu)
{
    if (gpu->display == EGL_NO_DISPLAY)
        return;
    eglMakeCurrent(gpu->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (gpu->context != EGL_NO_CONTEXT)
        eglDestroyContext(gpu->display, gpu->context);
    display_release(gpu->display);
}

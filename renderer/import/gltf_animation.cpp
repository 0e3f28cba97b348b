#include <cmath>
#include <cstdlib>
#include <new>

#include "renderer/import/gltf_import.hpp"

// Limit of floats over all channels: channels may share accessors, but must not fill memory.
#define GLTF_MAX_ANIMATION_FLOATS (32u << 20)

static enum scene_interpolation interpolation_of(const std::string &name, size_t animation)
{
    if (name == "STEP") {
        return SCENE_STEP;
    }
    if (name == "CUBICSPLINE") {
        return SCENE_CUBIC_SPLINE;
    }
    if (name != "LINEAR" && !name.empty()) {
        import_fail("animations[%zu]: interpolation '%s' is unknown; allowed are STEP, LINEAR and "
                    "CUBICSPLINE",
                    animation, import_short_name(name, 40).c_str());
    }
    return SCENE_LINEAR;
}

// Converts an animation path; false for one that is not imported.
static bool find_path(gltf_import &import, const std::string &name, enum scene_animation_path &out)
{
    if (name == "translation") {
        out = SCENE_PATH_TRANSLATION;
    } else if (name == "rotation") {
        out = SCENE_PATH_ROTATION;
    } else if (name == "scale") {
        out = SCENE_PATH_SCALE;
    } else {
        import_warn_once(import, "animations of '%s' are ignored",
                         import_short_name(name, 40).c_str());
        return false;
    }
    return true;
}

static void read_times(gltf_import &import, size_t animation, int accessor,
                       scene_animation_channel &channel)
{
    gltf_elements times = gltf_get_elements(import, accessor);
    if (times.components != 1 || times.component_type != TINYGLTF_COMPONENT_TYPE_FLOAT) {
        import_fail("animations[%zu]: key times must be single floats", animation);
    }
    channel.key_count = times.count;
    channel.times_s = (float *)calloc(times.count, sizeof(float));
    if (!channel.times_s) {
        throw std::bad_alloc();
    }
    for (uint32_t i = 0; i < times.count; i++) {
        gltf_read_element(times, i, &channel.times_s[i], 1);
        bool increases = i == 0 || channel.times_s[i] > channel.times_s[i - 1];
        if (!std::isfinite(channel.times_s[i]) || channel.times_s[i] < 0 || !increases) {
            import_fail("animations[%zu]: key time %u is %g; key times must be finite, at least 0 "
                        "and increase",
                        animation, i, (double)channel.times_s[i]);
        }
    }
}

static void read_values(gltf_import &import, size_t animation, int accessor,
                        scene_animation_channel &channel)
{
    gltf_elements values = gltf_get_elements(import, accessor);
    uint32_t width = channel.path == SCENE_PATH_ROTATION ? 4 : 3;
    uint64_t per_key = channel.interpolation == SCENE_CUBIC_SPLINE ? 3 : 1;
    uint64_t needed = channel.key_count * per_key;
    if (values.components != width || values.count < needed) {
        import_fail("animations[%zu]: %u values of %u numbers for %u keys; needed are %llu of %u",
                    animation, values.count, values.components, channel.key_count,
                    (unsigned long long)needed, width);
    }
    channel.values = (float *)calloc(needed, width * sizeof(float));
    if (!channel.values) {
        throw std::bad_alloc();
    }
    for (uint32_t i = 0; i < needed; i++) {
        float *value = channel.values + (size_t)i * width;
        gltf_read_element(values, i, value, width);
        for (uint32_t part = 0; part < width; part++) {
            if (!(std::fabs(value[part]) <= 1e15f)) {
                import_fail("animations[%zu]: a value is not finite or beyond 1e15", animation);
            }
        }
    }
}

static void read_channel(gltf_import &import, size_t index,
                         const tinygltf::AnimationChannel &source, scene_animation &animation)
{
    const tinygltf::Animation &owner = import.model.animations[index];
    if (source.sampler < 0 || (size_t)source.sampler >= owner.samplers.size()) {
        import_fail("animations[%zu]: sampler %d of %zu", index, source.sampler,
                    owner.samplers.size());
    }
    const tinygltf::AnimationSampler &sampler = owner.samplers[(size_t)source.sampler];
    scene_animation_channel &channel = animation.channels[animation.channel_count];
    uint32_t node = import.node_ids[(size_t)source.target_node];
    if (!find_path(import, source.target_path, channel.path) || node == SCENE_NONE) {
        return;
    }
    channel.node = node;
    channel.interpolation = interpolation_of(sampler.interpolation, index);
    animation.channel_count++; // from here on freed with the scene
    import.animation_floats += 13ull * import.model.accessors[(size_t)sampler.input].count;
    if (import.animation_floats > GLTF_MAX_ANIMATION_FLOATS) {
        import_fail("the animations have more than about %u keys", GLTF_MAX_ANIMATION_FLOATS / 13);
    }
    read_times(import, index, sampler.input, channel);
    read_values(import, index, sampler.output, channel);
    float end_s = channel.times_s[channel.key_count - 1];
    if (end_s > animation.duration_s) {
        animation.duration_s = end_s;
    }
}

void gltf_import_animations(gltf_import &import)
{
    const std::vector<tinygltf::Animation> &sources = import.model.animations;
    if (sources.empty()) {
        return;
    }
    scene *target = import.scene;
    target->animations = (scene_animation *)calloc(sources.size(), sizeof(scene_animation));
    if (!target->animations) {
        throw std::bad_alloc();
    }
    target->animation_capacity = (uint32_t)sources.size();
    for (size_t i = 0; i < sources.size(); i++) {
        scene_animation &animation = target->animations[target->animation_count];
        snprintf(animation.name, sizeof(animation.name), "%s",
                 import_short_name(sources[i].name, 64).c_str());
        animation.channels = (scene_animation_channel *)calloc(sources[i].channels.size() + 1,
                                                               sizeof(scene_animation_channel));
        if (!animation.channels) {
            throw std::bad_alloc();
        }
        target->animation_count++;
        for (const tinygltf::AnimationChannel &channel : sources[i].channels) {
            read_channel(import, i, channel, animation);
        }
    }
}

// What takes long to make of a scene, kept on disk between runs: one file an entry, in
// $XDG_CACHE_HOME/voxcast/scenes or ~/.cache/voxcast/scenes.
//
// An entry's key is a hash of everything that it was made from, so entries never become wrong: they
// are only used less and less, and those used least recently are removed. A file counts only if its
// length, key and checksum are right; any other is removed, and its content made anew. Files appear
// under their names whole, so that processes share the folder without locks.
//
// All functions are thread-safe. The cache is off until scene_cache_open().
#ifndef VOXCAST_RENDERER_CACHE_SCENE_CACHE_H
#define VOXCAST_RENDERER_CACHE_SCENE_CACHE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SCENE_CACHE_DEFAULT_MIB 2048u
#define SCENE_CACHE_MAX_MIB     (1024u << 10)

// Before the content of an entry's file: as many bytes.
#define SCENE_CACHE_HEADER_BYTES 64u

// 128 bits, well mixed but not cryptographic: whoever can write the folder can change what is in it
// anyway.
struct cache_key {
    uint64_t words[2];
};

// Starts a key. `kind` says what the entry is; `version` is of its layout and of the code that
// makes it.
struct cache_key cache_key_start(const char *kind, uint32_t version);

// Adds bytes, and their number. About 5 GB/s.
void cache_key_add(struct cache_key *key, const void *bytes, size_t size);

// Allows entries of `mib` mebibytes in total, 0: none and the cache is off. If the folder cannot be
// made, that is logged and the cache stays off: it only saves time.
void scene_cache_open(uint32_t mib);

// Whether anything can be read or written.
bool scene_cache_is_open(void);

// The entry's content, from malloc(); the caller frees it. NULL, with an untouched size, if there
// is no valid entry or memory is short. Never more than `max_bytes`. Blocks on disk.
void *scene_cache_read(const struct cache_key *key, size_t max_bytes, size_t *out_size);

// Writes an entry and evicts what is beyond the limit. Writes nothing where the disk is full or the
// folder read-only. Blocks on disk.
void scene_cache_write(const struct cache_key *key, const void *bytes, size_t size);

struct scene_cache_statistics {
    uint64_t hits;
    uint64_t misses;
    uint64_t invalid; // of the misses: there was a file, but no valid one
    uint64_t written_bytes;
};

// Since the process began.
struct scene_cache_statistics scene_cache_get_statistics(void);

#endif

// Reports when one of a set of files was written, after 200 ms without further writing.
#ifndef VOXCAST_SERVER_RENDER_FILE_WATCH_H
#define VOXCAST_SERVER_RENDER_FILE_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#define FILE_WATCH_MAX_FOLDERS 256u

struct file_watch;

// The watching thread calls `changed`. NULL, with a line in the log, if the system provides no
// watches.
struct file_watch *file_watch_create(void (*changed)(void *user), void *user);
void file_watch_destroy(struct file_watch **watch);

// Watches these files from now on, and no others. Copies the names.
void file_watch_set_files(struct file_watch *watch, char *const *paths, uint32_t count);

// Whether a file has changed since the last call.
bool file_watch_take_changed(struct file_watch *watch);

#endif

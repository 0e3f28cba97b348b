// Log lines: one per event, `key=value` fields, to stderr. Any thread may log.
#ifndef VOXCAST_RENDERER_LOG_H
#define VOXCAST_RENDERER_LOG_H

enum log_level { LOG_ERROR, LOG_WARN, LOG_INFO, LOG_DEBUG };

// Messages above this level are dropped. Default LOG_INFO.
void log_set_level(enum log_level level);

// Writes one line such as "level=info event=scene_loaded triangles=36". `format` begins with the
// event's name: log_write(LOG_INFO, "scene_loaded triangles=%u", count).
void log_write(enum log_level level, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif

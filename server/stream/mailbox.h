// Commands from the network loop to the render thread: bounded, in order; the newest of a key wins.
#ifndef VOXCAST_SERVER_STREAM_MAILBOX_H
#define VOXCAST_SERVER_STREAM_MAILBOX_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/command.h"

#define MAILBOX_CAPACITY       512u
#define MAILBOX_MAX_PER_CLIENT 64u
#define MAILBOX_NO_DEADLINE    UINT64_MAX

struct mailbox;

enum mailbox_result {
    MAILBOX_POSTED,
    MAILBOX_SUPERSEDED, // posted; it replaced an older command of the same key
    MAILBOX_FULL,
};

// NULL when out of memory.
struct mailbox *mailbox_create(void);

// Also frees the commands that wait.
void mailbox_destroy(struct mailbox **mailbox);

// Appends a command from malloc and takes it over, except with MAILBOX_FULL. It replaces a waiting
// command that it supersedes: that is freed, its edit ids pass on to `command`, and
// `out_superseded` is its request's id. A command never moves past one that does not merge (such as
// an undo). Any thread.
enum mailbox_result mailbox_post(struct mailbox *mailbox, struct command *command,
                                 struct rpc_id *out_superseded);

// The oldest command, which the caller frees; NULL if none waits.
struct command *mailbox_take(struct mailbox *mailbox);

// Sleeps until a command waits, mailbox_wake() was called since the last return, or clock_now_us()
// reaches the deadline.
void mailbox_wait(struct mailbox *mailbox, uint64_t deadline_us);

// Ends the current or the next mailbox_wait(). Any thread.
void mailbox_wake(struct mailbox *mailbox);

#endif

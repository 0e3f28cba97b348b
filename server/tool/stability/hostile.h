// Cases of the hostile family that have a file of their own.
#ifndef VOXCAST_SERVER_TOOL_STABILITY_HOSTILE_H
#define VOXCAST_SERVER_TOOL_STABILITY_HOSTILE_H

#include "server/tool/stability/stability.h"

void hostile_run_edits(struct stability_run *run);
void hostile_run_drawn(struct stability_run *run);

#endif

// Values of the document given as text, as on the command line.
#ifndef VOXCAST_SERVER_DOCUMENT_DOCUMENT_TEXT_H
#define VOXCAST_SERVER_DOCUMENT_DOCUMENT_TEXT_H

#include "server/document/document.h"

// Sets one value given as text. Keys: "lights.0.intensity", "materials.NAME.roughness",
// "nodes.3.translation", "environment.type", "settings.exposure_ev", "view.quality", "camera.eye",
// or a bare name of the groups settings, view and camera, such as "exposure_ev". Names of lights,
// materials and nodes may hold dots. False with a message naming key, value and range.
bool document_set_text(struct scene *scene, struct render_settings *settings,
                       struct view_options *view, const char *key, const char *value,
                       struct error *out_error);

#endif
